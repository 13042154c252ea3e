// The optimiser of pose networks.
#include "network/optimizer.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace nmc::network {
namespace {

constexpr float keep_mean = 0.9f;
constexpr float keep_square = 0.97f;
constexpr float keep_covariance = 0.98f;
constexpr float smallest_root = 1e-8f;
constexpr int steps_between_axes = 20;

}  // namespace

Optimizer::Tensor Optimizer::matrix(const Eigen::MatrixXf& value) {
  const Eigen::MatrixXf zero = Eigen::MatrixXf::Zero(value.rows(), value.cols());
  const Eigen::MatrixXf square = Eigen::MatrixXf::Zero(value.cols(), value.cols());
  return {zero, zero, square, square, zero, square};
}

Optimizer::Tensor Optimizer::vector(const Eigen::VectorXf& value) {
  const Eigen::MatrixXf zero = Eigen::MatrixXf::Zero(value.rows(), 1);
  return {zero, zero, {}, {}, {}, {}};
}

Optimizer::Optimizer(const PoseNetwork& network)
    : W0_(matrix(network.W0)),
      b0_(vector(network.b0)),
      W1_(matrix(network.W1)),
      b1_(vector(network.b1)),
      W2_(matrix(network.W2)),
      b2_(vector(network.b2)),
      S_(matrix(network.S)) {}

void Optimizer::step(PoseNetwork& network, const PoseNetwork& gradient, double learning_rate) {
  ++steps_;
  correction_ = std::sqrt(1 - std::pow(double{keep_square}, steps_)) / (1 - std::pow(double{keep_mean}, steps_));
  step_matrix(W0_, network.W0, gradient.W0, learning_rate);
  step_vector(b0_, network.b0, gradient.b0, learning_rate);
  step_matrix(W1_, network.W1, gradient.W1, learning_rate);
  step_vector(b1_, network.b1, gradient.b1, learning_rate);
  step_matrix(W2_, network.W2, gradient.W2, learning_rate);
  step_vector(b2_, network.b2, gradient.b2, learning_rate);
  step_matrix(S_, network.S, gradient.S, learning_rate);
}

void Optimizer::step_matrix(Tensor& tensor, Eigen::MatrixXf& value, const Eigen::MatrixXf& gradient,
                            double learning_rate) const {
  if (value.size() == 0) return;
  tensor.outer.noalias() = gradient.transpose() * gradient;
  tensor.covariance += (1 - keep_covariance) * (tensor.outer - tensor.covariance);
  if (steps_ % steps_between_axes == 1) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXf> solver(tensor.covariance);
    if (solver.info() == Eigen::Success) tensor.axes = solver.eigenvectors();
  }
  tensor.mean += (1 - keep_mean) * (gradient - tensor.mean);
  tensor.rotated.noalias() = gradient * tensor.axes;
  tensor.mean_square.array() += (1 - keep_square) * (tensor.rotated.array().square() - tensor.mean_square.array());
  tensor.rotated.noalias() = tensor.mean * tensor.axes;
  tensor.rotated.array() *=
      static_cast<float>(learning_rate * correction_) / (tensor.mean_square.array().sqrt() + smallest_root);
  value.noalias() -= tensor.rotated * tensor.axes.transpose();
}

void Optimizer::step_vector(Tensor& tensor, Eigen::VectorXf& value, const Eigen::VectorXf& gradient,
                            double learning_rate) const {
  tensor.mean += (1 - keep_mean) * (gradient - tensor.mean);
  tensor.mean_square.array() += (1 - keep_square) * (gradient.array().square() - tensor.mean_square.array());
  value.array() -= static_cast<float>(learning_rate * correction_) * tensor.mean.array() /
                   (tensor.mean_square.array().sqrt() + smallest_root);
}

}  // namespace nmc::network
