// Principal component analysis of the columns of a matrix.
#pragma once

#include <Eigen/Core>

namespace nmc::baselines {

/// Columns are mean + axes * coefficients, up to what the axes left out hold.
struct PrincipalComponents {
  Eigen::VectorXd mean;
  Eigen::MatrixXd axes;       ///< rows x axes, orthonormal, by falling variance; no more axes than needed or rows
  Eigen::VectorXd variances;  ///< mean squared coefficient of each axis over the columns, falling
};

PrincipalComponents principal_components(const Eigen::MatrixXd& columns);

/// The fewest axes that leave out at most this sum of variances.
Eigen::Index axes_for_residual(const PrincipalComponents& pca, double variance);

/// The fewest axes that cover this share of the variance.
Eigen::Index axes_for_share(const PrincipalComponents& pca, double share);

}  // namespace nmc::baselines
