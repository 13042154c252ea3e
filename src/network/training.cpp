// Fits the weights of a pose network to a clip: gradient descent in normalised coordinates.
#include "network/training.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "network/fourier_features.h"
#include "network/loss.h"
#include "network/optimizer.h"

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
  Optimizer optimizer(network);
  double best_loss = std::numeric_limits<double>::infinity();
  for (int iteration = 0;; ++iteration) {
    const double current = loss.value_and_gradient(network, gradient);
    if (current < best_loss) {
      best_loss = current;
      best = network;
    }
    if (iteration == options.iterations || (options.stop_requested && options.stop_requested())) break;
    const double phase = static_cast<double>(iteration) / options.iterations;
    optimizer.step(network, gradient, options.learning_rate * 0.5 * (1 + std::cos(std::numbers::pi * phase)));
  }
  to_poses(best, normalisation);
  network = std::move(best);
  return weighted_error(network, clip, features);
}

}  // namespace nmc::network
