// Fits the weights of a pose network to a clip: Adam in normalised coordinates.
#include "network/training.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "network/fourier_features.h"
#include "network/loss.h"

namespace nmc::network {
namespace {

/// The affine map of pose vectors to targets of zero mean and, over all parameters together, unit variance: target = (y
/// - mean) * scale. The squared error of targets is equation 3 divided by loss_unit.
struct Normalisation {
  Eigen::VectorXf mean;
  Eigen::VectorXf scale;  ///< zero where the weight is
};

Normalisation normalise(const TrainingClip& clip) {
  const Eigen::MatrixXd poses = clip.poses.cast<double>();
  const Eigen::RowVectorXd mean = poses.colwise().mean();
  const Eigen::MatrixXd weighted = (poses.rowwise() - mean) * clip.weights.cast<double>().asDiagonal();
  const double variance = weighted.squaredNorm() / static_cast<double>(weighted.size());
  const double deviation = variance > 0 ? std::sqrt(variance) : 1.0;
  return {mean.transpose().cast<float>(), (clip.weights.cast<double>() / deviation).cast<float>()};
}

/// What the network computes becomes (y - mean) * scale.
void to_targets(PoseNetwork& network, const Normalisation& normalisation) {
  network.W2 = normalisation.scale.asDiagonal() * network.W2;
  network.b2 = normalisation.scale.cwiseProduct(network.b2 - normalisation.mean);
  if (network.has_skip()) network.S = normalisation.scale.asDiagonal() * network.S;
}

/// The inverse; a parameter of no weight becomes its mean.
void to_poses(PoseNetwork& network, const Normalisation& normalisation) {
  const Eigen::VectorXf inverse = (normalisation.scale.array() > 0).select(normalisation.scale.cwiseInverse(), 0.0f);
  network.W2 = inverse.asDiagonal() * network.W2;
  network.b2 = inverse.cwiseProduct(network.b2) + normalisation.mean;
  if (network.has_skip()) network.S = inverse.asDiagonal() * network.S;
}

/// Adam (Kingma, Ba 2015) over all tensors of a network.
class Adam {
 public:
  explicit Adam(PoseNetwork& network) {
    for (const auto tensor : network.tensors()) {
      const auto size = static_cast<Eigen::Index>(tensor.size());
      first_.emplace_back(Eigen::ArrayXf::Zero(size));
      second_.emplace_back(Eigen::ArrayXf::Zero(size));
    }
  }

  void step(PoseNetwork& network, PoseNetwork& gradient, double learning_rate) {
    decay_first_ *= beta_first;
    decay_second_ *= beta_second;
    const auto rate = static_cast<float>(learning_rate * std::sqrt(1 - decay_second_) / (1 - decay_first_));
    const auto tensors = network.tensors();
    const auto gradients = gradient.tensors();
    for (std::size_t i = 0; i < tensors.size(); ++i) {
      if (tensors[i].empty()) continue;
      const auto size = static_cast<Eigen::Index>(tensors[i].size());
      Eigen::Map<Eigen::ArrayXf> value(tensors[i].data(), size);
      const Eigen::Map<const Eigen::ArrayXf> slope(gradients[i].data(), size);
      first_[i] += (1 - beta_first) * (slope - first_[i]);
      second_[i] += (1 - beta_second) * (slope.square() - second_[i]);
      value -= rate * first_[i] / (second_[i].sqrt() + 1e-8f);
    }
  }

 private:
  static constexpr float beta_first = 0.9f;
  static constexpr float beta_second = 0.99f;
  double decay_first_ = 1;
  double decay_second_ = 1;
  std::vector<Eigen::ArrayXf> first_;
  std::vector<Eigen::ArrayXf> second_;
};

/// Equation 3 in the units of the poses.
double weighted_error(const PoseNetwork& network, const TrainingClip& clip, const Eigen::MatrixXf& features) {
  const Eigen::MatrixXd residual = (clip.poses - evaluate(network, features)).cast<double>();
  return (residual * clip.weights.cast<double>().asDiagonal()).squaredNorm();
}

}  // namespace

double train(PoseNetwork& network, const TrainingClip& clip, const TrainOptions& options) {
  const Eigen::MatrixXf features = fourier_features(network.half_cycles, frame_times(clip.poses.rows()));
  // The best b2 for the rest of the network; without it a new network would spend its first iterations on the mean
  // pose.
  network.b2 += (clip.poses - evaluate(network, features)).colwise().mean().transpose();

  const Normalisation normalisation = normalise(clip);
  Eigen::MatrixXf targets = (clip.poses.rowwise() - normalisation.mean.transpose()) * normalisation.scale.asDiagonal();
  Loss<float> loss(features, std::move(targets), Eigen::VectorXf::Ones(clip.poses.cols()));
  to_targets(network, normalisation);
  PoseNetwork best = network;
  PoseNetwork gradient = network;
  Adam adam(network);
  double best_loss = std::numeric_limits<double>::infinity();
  for (int iteration = 0;; ++iteration) {
    const double current = loss.value_and_gradient(network, gradient);
    if (current < best_loss) {
      best_loss = current;
      best = network;
    }
    if (iteration == options.iterations || (options.stop_requested && options.stop_requested())) break;
    const double phase = static_cast<double>(iteration) / options.iterations;
    adam.step(network, gradient, options.learning_rate * 0.5 * (1 + std::cos(std::numbers::pi * phase)));
  }
  to_poses(best, normalisation);
  network = std::move(best);
  return weighted_error(network, clip, features);
}

}  // namespace nmc::network
