// Fourier features of normalised time (Tojo et al. 2022, equation 1): the input of the pose network.
#pragma once

#include <Eigen/Core>
#include <span>

namespace nmc::network {

/// Normalised times t = n / (count - 1) of `count` evenly spaced frames, from 0 to 1; {0} for one frame.
Eigen::VectorXd frame_times(Eigen::Index count);

/// x(t) = (t, sin w_1 t, cos w_1 t, ..., sin w_K t, cos w_K t), one frame per row: times.size() x (2K + 1).
/// The angular velocities are w_k = pi * half_cycles[k]: half_cycles counts half periods over the clip, as the index of
/// a DCT-II does.
Eigen::MatrixXf fourier_features(std::span<const int> half_cycles, const Eigen::VectorXd& times);

}  // namespace nmc::network
