// The features of one window as a matrix, as the decoder computes them.
#pragma once

#include <Eigen/Core>

#include "codec/clip_set.h"

namespace nmc::codec {

/// count x samples: row j - 1 is feature j at samples begin .. begin + samples - 1 of the window.
Eigen::MatrixXd window_features(Basis basis, std::uint32_t window_length, Eigen::Index count, Eigen::Index samples);

/// The largest feature index that adds to what anchors give.
Eigen::Index feature_limit(Basis basis, std::uint32_t window_length);

/// The shares of a window's first and second anchor pose at its samples: 2 x samples (cosine: the first is one, the
/// second zero).
Eigen::MatrixXd anchor_shares(Basis basis, std::uint32_t window_length, Eigen::Index samples);

/// The scale of a window's weights, in slot steps: 2^(-step_exponent / 4) sqrt(2 / length).
double weight_scale(int step_exponent, std::uint32_t window_length);

/// The share of an atom of half-width 2^width that a sample gets which is `away` (not negative) from its middle.
double atom_share(Eigen::Index away, int width);

}  // namespace nmc::codec
