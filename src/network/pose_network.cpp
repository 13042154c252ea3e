// The pose network: construction, evaluation and growth.
#include "network/pose_network.h"

#include <cmath>

#include "base/error.h"
#include "network/fourier_features.h"
#include "network/random.h"

namespace nmc::network {
namespace {

template <typename Tensor>
void fill_random(Tensor&& tensor, double range, Random& random) {
  for (Eigen::Index j = 0; j < tensor.cols(); ++j) {
    for (Eigen::Index i = 0; i < tensor.rows(); ++i) tensor(i, j) = static_cast<float>(range * random.uniform());
  }
}

double initial_range(Eigen::Index fan_in) { return fan_in > 0 ? 1.0 / std::sqrt(static_cast<double>(fan_in)) : 0.0; }

}  // namespace

std::size_t parameter_count(const PoseNetwork& network) {
  const auto count = network.W0.size() + network.b0.size() + network.W1.size() + network.b1.size() + network.W2.size() +
                     network.b2.size() + network.S.size();
  return static_cast<std::size_t>(count);
}

PoseNetwork make_network(std::vector<int> half_cycles, Eigen::Index hidden_size, Eigen::Index pose_size, bool skip,
                         std::uint64_t seed) {
  PoseNetwork network;
  network.half_cycles = std::move(half_cycles);
  const Eigen::Index inputs = network.feature_count();
  Random random(seed);
  network.W0.resize(hidden_size, inputs);
  fill_random(network.W0, initial_range(inputs), random);
  network.b0.resize(hidden_size);
  fill_random(network.b0, initial_range(inputs), random);
  network.W1.resize(hidden_size, hidden_size);
  fill_random(network.W1, initial_range(hidden_size), random);
  network.b1.resize(hidden_size);
  fill_random(network.b1, initial_range(hidden_size), random);
  network.W2.setZero(pose_size, hidden_size);
  network.b2.setZero(pose_size);
  if (skip) network.S.setZero(pose_size, inputs);
  return network;
}

Eigen::MatrixXf evaluate(const PoseNetwork& network, const Eigen::MatrixXf& features) {
  if (features.cols() != network.feature_count()) {
    throw Error(ErrorCode::internal, "Evaluating a network: the features do not belong to its frequencies.");
  }
  Eigen::MatrixXf poses = network.b2.transpose().replicate(features.rows(), 1);
  if (network.has_skip()) poses.noalias() += features * network.S.transpose();
  if (network.hidden_size() == 0) return poses;
  Eigen::MatrixXf first = (features * network.W0.transpose()).rowwise() + network.b0.transpose();
  first.array() = elu(first.array());
  Eigen::MatrixXf second = (first * network.W1.transpose()).rowwise() + network.b1.transpose();
  second.array() = elu(second.array());
  poses.noalias() += second * network.W2.transpose();
  return poses;
}

Eigen::MatrixXf evaluate(const PoseNetwork& network, const Eigen::VectorXd& times) {
  return evaluate(network, fourier_features(network.half_cycles, times));
}

PoseNetwork grow(const PoseNetwork& network, int new_half_cycles, Eigen::Index hidden_size, std::uint64_t seed) {
  const Eigen::Index old_hidden = network.hidden_size();
  if (hidden_size < old_hidden) {
    throw Error(ErrorCode::internal, "Growing a network: the new hidden size is smaller than the old one.");
  }
  std::vector<int> half_cycles = network.half_cycles;
  half_cycles.push_back(new_half_cycles);
  PoseNetwork grown = make_network(std::move(half_cycles), hidden_size, network.pose_size(), network.has_skip(), seed);
  grown.W0.topRows(old_hidden).setZero();
  grown.W0.topLeftCorner(old_hidden, network.feature_count()) = network.W0;
  grown.b0.head(old_hidden) = network.b0;
  grown.W1.topRows(old_hidden).setZero();
  grown.W1.topLeftCorner(old_hidden, old_hidden) = network.W1;
  grown.b1.head(old_hidden) = network.b1;
  grown.W2.leftCols(old_hidden) = network.W2;
  grown.b2 = network.b2;
  if (network.has_skip()) grown.S.leftCols(network.feature_count()) = network.S;
  return grown;
}

}  // namespace nmc::network
