// The training loss and its gradient.
#include "network/loss.h"

#include "base/error.h"

namespace nmc::network {

template <typename Scalar>
Loss<Scalar>::Loss(Matrix<Scalar> features, Matrix<Scalar> targets, const Vector<Scalar>& weights)
    : features_(std::move(features)), targets_(std::move(targets)), weights_(weights.transpose()) {
  if (features_.rows() != targets_.rows() || targets_.cols() != weights.size()) {
    throw Error(ErrorCode::internal, "Training a network: features, poses and weights have different sizes.");
  }
}

template <typename Scalar>
void Loss<Scalar>::forward(const BasicPoseNetwork<Scalar>& network) {
  residual_ = -targets_;
  if (network.has_skip()) residual_.noalias() += features_ * network.S.transpose();
  if (network.hidden_size() > 0) {
    first_.noalias() = features_ * network.W0.transpose();
    first_.rowwise() += network.b0.transpose();
    first_.array() = elu(first_.array());
    second_.noalias() = first_ * network.W1.transpose();
    second_.rowwise() += network.b1.transpose();
    second_.array() = elu(second_.array());
    residual_.noalias() += second_ * network.W2.transpose();
  }
  residual_.rowwise() += network.b2.transpose();
  residual_.array().rowwise() *= weights_.array();
}

template <typename Scalar>
double Loss<Scalar>::value(const BasicPoseNetwork<Scalar>& network) {
  forward(network);
  return static_cast<double>(residual_.squaredNorm());
}

template <typename Scalar>
double Loss<Scalar>::value_and_gradient(const BasicPoseNetwork<Scalar>& network, BasicPoseNetwork<Scalar>& gradient) {
  const double loss = value(network);
  residual_.array().rowwise() *= Scalar(2) * weights_.array();
  gradient.half_cycles = network.half_cycles;
  gradient.b2 = residual_.colwise().sum();
  if (network.has_skip()) gradient.S.noalias() = residual_.transpose() * features_;
  if (network.hidden_size() == 0) {
    gradient.W0.resizeLike(network.W0);
    gradient.b0.resize(0);
    gradient.W1.resize(0, 0);
    gradient.b1.resize(0);
    gradient.W2.resizeLike(network.W2);
    return loss;
  }
  gradient.W2.noalias() = residual_.transpose() * second_;
  second_delta_.noalias() = residual_ * network.W2;
  second_delta_.array() *= elu_derivative(second_.array());
  gradient.b1 = second_delta_.colwise().sum();
  gradient.W1.noalias() = second_delta_.transpose() * first_;
  first_delta_.noalias() = second_delta_ * network.W1;
  first_delta_.array() *= elu_derivative(first_.array());
  gradient.b0 = first_delta_.colwise().sum();
  gradient.W0.noalias() = first_delta_.transpose() * features_;
  return loss;
}

template class Loss<float>;
template class Loss<double>;

}  // namespace nmc::network
