#include "baselines/principal_components.h"

#include "base/symmetric_eigen.h"

namespace nmc::baselines {

PrincipalComponents principal_components(const Eigen::MatrixXd& columns) {
  PrincipalComponents pca;
  pca.mean = columns.rowwise().mean();
  const Eigen::MatrixXd centered = columns.colwise() - pca.mean;
  if (columns.cols() < columns.rows()) {  // the other product has the same eigenvalues and is smaller
    const Eigen::MatrixXd gram = centered.transpose() * centered / static_cast<double>(columns.cols());
    const SymmetricEigen small = symmetric_eigen(gram);
    pca.variances = small.values.reverse().cwiseMax(0.0);
    pca.axes = centered * small.vectors.rowwise().reverse();
    Eigen::Index count = 0;
    const double least = 1e-14 * pca.variances.sum();
    while (count < pca.variances.size() && pca.variances(count) > least) pca.axes.col(count++).normalize();
    pca.axes.conservativeResize(Eigen::NoChange, count);
    pca.variances.conservativeResize(count);
    return pca;
  }
  const Eigen::MatrixXd covariance = centered * centered.transpose() / static_cast<double>(columns.cols());
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  pca.axes = eigen.vectors.rowwise().reverse();
  pca.variances = eigen.values.reverse().cwiseMax(0.0);
  return pca;
}

Eigen::Index axes_for_residual(const PrincipalComponents& pca, double variance) {
  Eigen::Index count = pca.variances.size();
  for (double left = 0; count > 0; --count) {
    left += pca.variances(count - 1);
    if (left > variance) break;
  }
  return count;
}

Eigen::Index axes_for_share(const PrincipalComponents& pca, double share) {
  return axes_for_residual(pca, (1 - share) * pca.variances.sum());
}

}  // namespace nmc::baselines
