// Finds the next frequency of the network in what it does not yet represent (Tojo et al. 2022, section 3.2).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace nmc::network {

/// DCT-II without scaling: c_k = sum over n of x_n cos(pi k (n + 1/2) / N), k = 0 .. N - 1. Takes N^2 multiplications.
Eigen::VectorXd dct(const Eigen::VectorXd& signal);

/// The unit vector p along which the rows of `residual` (N x m) vary most about their mean, with the sign that makes
/// its largest entry positive; the first coordinate where they do not vary.
Eigen::VectorXd first_principal_component(const Eigen::MatrixXd& residual);

/// Lines 8 and 9 of Algorithm 1: weights the residual Y - F(X) (N x m) by `weights` (m), projects it on its first
/// principal component and returns the index in 1 .. N - 1 of the largest DCT-II coefficient of that time history that
/// is not in `taken`; 0 when all are taken.
int dominant_half_cycles(const Eigen::MatrixXf& residual, const Eigen::VectorXf& weights, std::span<const int> taken);

}  // namespace nmc::network
