// The pose network (Tojo et al. 2022, equation 2): from Fourier features of time to a pose vector.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace nmc::network {

template <typename Scalar>
using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
template <typename Scalar>
using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

/// y = W2 ELU(W1 ELU(W0 x + b0) + b1) + b2 + S x. In the paper h = 2 (2K + 1) and there is no S; h = 0 leaves y = b2 +
/// S x. d = 2K + 1 features, h hidden units, m pose parameters. Equation 2's W2 is h x m in the paper's list of
/// parameters; here it is m x h, as it acts.
template <typename Scalar>
struct BasicPoseNetwork {
  std::vector<int> half_cycles;  ///< Omega in units of pi: K half-cycle counts, in the order of the features
  Matrix<Scalar> W0;             ///< h x d
  Vector<Scalar> b0;             ///< h
  Matrix<Scalar> W1;             ///< h x h
  Vector<Scalar> b1;             ///< h
  Matrix<Scalar> W2;             ///< m x h
  Vector<Scalar> b2;             ///< m
  Matrix<Scalar> S;              ///< m x d, or 0 x 0 where the model has no skip connection

  Eigen::Index feature_count() const { return 2 * static_cast<Eigen::Index>(half_cycles.size()) + 1; }
  Eigen::Index hidden_size() const { return b0.size(); }
  Eigen::Index pose_size() const { return b2.size(); }
  bool has_skip() const { return S.size() > 0; }

  /// The numbers of W0, b0, W1, b1, W2, b2, S, each column-major.
  std::array<std::span<Scalar>, 7> tensors() { return {all(W0), all(b0), all(W1), all(b1), all(W2), all(b2), all(S)}; }

  template <typename Other>
  BasicPoseNetwork<Other> cast() const {
    return {half_cycles,
            W0.template cast<Other>(),
            b0.template cast<Other>(),
            W1.template cast<Other>(),
            b1.template cast<Other>(),
            W2.template cast<Other>(),
            b2.template cast<Other>(),
            S.template cast<Other>()};
  }

 private:
  template <typename Tensor>
  static std::span<Scalar> all(Tensor& tensor) {
    return {tensor.data(), static_cast<std::size_t>(tensor.size())};
  }
};
using PoseNetwork = BasicPoseNetwork<float>;

/// The hidden size that the paper chooses for K frequencies: 2 (2K + 1).
constexpr Eigen::Index paper_hidden_size(Eigen::Index frequencies) { return 2 * (2 * frequencies + 1); }

/// The number of trainable parameters alpha, as the paper counts them: all weights and biases, without Omega.
std::size_t parameter_count(const PoseNetwork& network);

/// A network with random W0 and W1 (uniform, +-1 / sqrt(fan in)) and b0, b1 in the same range; W2, b2 and S are zero.
/// The same seed gives the same numbers on every machine.
PoseNetwork make_network(std::vector<int> half_cycles, Eigen::Index hidden_size, Eigen::Index pose_size, bool skip,
                         std::uint64_t seed);

/// The poses of N feature rows (N x d): N x m.
Eigen::MatrixXf evaluate(const PoseNetwork& network, const Eigen::MatrixXf& features);

/// The poses at normalised times: times.size() x m.
Eigen::MatrixXf evaluate(const PoseNetwork& network, const Eigen::VectorXd& times);

/// Line 11 of Algorithm 1: a network with one more frequency and `hidden_size` hidden units (at least as many as
/// before) that holds the old weights and computes the same function: what the old units read from the new feature and
/// units, and the new units' columns of W2, start at zero; what the new units read is random as in make_network.
PoseNetwork grow(const PoseNetwork& network, int new_half_cycles, Eigen::Index hidden_size, std::uint64_t seed);

/// ELU (Clevert, Unterthiner, Hochreiter 2016) of an expression: z above zero, exp(z) - 1 below.
/// The largest error against expm1 is the rounding of exp near 1, 6e-8 in float.
template <typename Derived>
auto elu(const Eigen::ArrayBase<Derived>& z) {
  using Scalar = typename Derived::Scalar;
  return z.max(Scalar(0)) + (z.min(Scalar(0)).exp() - Scalar(1));
}

/// The derivative of ELU at z, from the value of ELU there.
template <typename Derived>
auto elu_derivative(const Eigen::ArrayBase<Derived>& activation) {
  using Scalar = typename Derived::Scalar;
  return activation.min(Scalar(0)) + Scalar(1);
}

}  // namespace nmc::network
