// The training loss (Tojo et al. 2022, equation 3) and its exact gradient by back-propagation.
#pragma once

#include "network/pose_network.h"

namespace nmc::network {

/// L = sum over frames of || (y - F(x)) o w ||^2 for one clip. Holds the work buffers: after the first call with a
/// shape of network nothing is allocated. Instantiated for float and double.
template <typename Scalar>
class Loss {
 public:
  /// features N x d, targets N x m, weights m. Throws Error (internal) when the sizes disagree.
  Loss(Matrix<Scalar> features, Matrix<Scalar> targets, const Vector<Scalar>& weights);

  /// The loss of a network.
  double value(const BasicPoseNetwork<Scalar>& network);

  /// The loss, and its derivative by every parameter in `gradient`, which takes the network's shape.
  double value_and_gradient(const BasicPoseNetwork<Scalar>& network, BasicPoseNetwork<Scalar>& gradient);

 private:
  void forward(const BasicPoseNetwork<Scalar>& network);

  Matrix<Scalar> features_;
  Matrix<Scalar> targets_;
  Eigen::Matrix<Scalar, 1, Eigen::Dynamic> weights_;
  Matrix<Scalar> first_;         // N x h: activations of the first layer
  Matrix<Scalar> second_;        // N x h: activations of the second layer
  Matrix<Scalar> residual_;      // N x m: (F - Y) o w, later the derivative by F
  Matrix<Scalar> first_delta_;   // N x h: derivative by the input of the first ELU
  Matrix<Scalar> second_delta_;  // N x h: the same of the second
};

extern template class Loss<float>;
extern template class Loss<double>;

}  // namespace nmc::network
