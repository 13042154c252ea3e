// Finds the next frequency of the network: PCA of the residual, then its DCT.
#include "network/frequency_search.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/symmetric_eigen.h"

namespace nmc::network {

Eigen::VectorXd dct(const Eigen::VectorXd& signal) {
  const Eigen::Index count = signal.size();
  // cos(pi j / (2 N)) has period 4 N in j, and j = k (2 n + 1) steps by 2 k.
  Eigen::VectorXd cosine(4 * count);
  for (Eigen::Index j = 0; j < 4 * count; ++j) {
    cosine[j] = std::cos(std::numbers::pi * static_cast<double>(j) / static_cast<double>(2 * count));
  }
  Eigen::VectorXd coefficients(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    double sum = 0;
    Eigen::Index j = k;
    for (Eigen::Index n = 0; n < count; ++n) {
      sum += signal[n] * cosine[j];
      j += 2 * k;
      if (j >= 4 * count) j -= 4 * count;
    }
    coefficients[k] = sum;
  }
  return coefficients;
}

Eigen::VectorXd first_principal_component(const Eigen::MatrixXd& residual) {
  const Eigen::MatrixXd centred = residual.rowwise() - residual.colwise().mean();
  const Eigen::MatrixXd covariance = centred.transpose() * centred;
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  if (eigen.values.size() == 0 || !(eigen.values.tail<1>()[0] > 0)) return Eigen::VectorXd::Unit(residual.cols(), 0);
  Eigen::VectorXd component = eigen.vectors.rightCols<1>();
  Eigen::Index largest = 0;
  component.cwiseAbs().maxCoeff(&largest);
  return component[largest] < 0 ? Eigen::VectorXd(-component) : component;
}

int dominant_half_cycles(const Eigen::MatrixXf& residual, const Eigen::VectorXf& weights, std::span<const int> taken) {
  if (residual.rows() < 2 || residual.cols() < 1) return 0;
  const Eigen::MatrixXd weighted = residual.cast<double>() * weights.cast<double>().asDiagonal();
  const Eigen::VectorXd history = weighted * first_principal_component(weighted);
  const Eigen::VectorXd spectrum = dct(history);
  int best = 0;
  for (int k = 1; k < spectrum.size(); ++k) {
    if (std::find(taken.begin(), taken.end(), k) != taken.end()) continue;
    if (best == 0 || std::abs(spectrum[k]) > std::abs(spectrum[best])) best = k;
  }
  return best;
}

}  // namespace nmc::network
