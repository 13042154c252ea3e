#include "network/loss.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "network/fourier_features.h"

namespace {

using namespace nmc::network;
using NetworkD = BasicPoseNetwork<double>;

struct Shape {
  int frequencies;
  int hidden;
  int pose;
  bool skip;
};

class LossGradient : public testing::TestWithParam<Shape> {};

TEST_P(LossGradient, MatchesCentralDifferencesInEveryTensor) {
  const auto [frequencies, hidden, pose, skip] = GetParam();
  std::vector<int> half_cycles;
  for (int k = 0; k < frequencies; ++k) half_cycles.push_back(2 * k + 3);
  NetworkD network = make_network(half_cycles, hidden, pose, skip, 9).cast<double>();
  std::srand(1);
  network.W2.setRandom();
  network.b2.setRandom();
  if (skip) network.S.setRandom();
  const Eigen::Index frames = 23;
  const Matrix<double> features = fourier_features(half_cycles, frame_times(frames)).cast<double>();
  const Vector<double> weights = Vector<double>::Random(pose).cwiseAbs();
  Loss<double> loss(features, Matrix<double>::Random(frames, pose), weights);
  if (hidden > 0) {
    // Both branches of the ELU are met.
    const Matrix<double> input = (features * network.W0.transpose()).rowwise() + network.b0.transpose();
    ASSERT_LT(input.minCoeff(), 0);
    ASSERT_GT(input.maxCoeff(), 0);
  }

  NetworkD gradient;
  const double value = loss.value_and_gradient(network, gradient);
  EXPECT_DOUBLE_EQ(value, loss.value(network));
  const auto tensors = network.tensors();
  const auto gradients = gradient.tensors();
  for (std::size_t t = 0; t < tensors.size(); ++t) {
    ASSERT_EQ(tensors[t].size(), gradients[t].size()) << "tensor " << t;
    for (std::size_t i = 0; i < tensors[t].size(); ++i) {
      const double step = 1e-6;
      const double kept = tensors[t][i];
      tensors[t][i] = kept + step;
      const double above = loss.value(network);
      tensors[t][i] = kept - step;
      const double below = loss.value(network);
      tensors[t][i] = kept;
      const double expected = (above - below) / (2 * step);
      EXPECT_NEAR(gradients[t][i], expected, 1e-6 * (1 + std::abs(expected))) << "tensor " << t << " entry " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, LossGradient,
                         testing::Values(Shape{0, 4, 3, false}, Shape{1, 6, 1, false}, Shape{3, 14, 5, false},
                                         Shape{2, 7, 4, true}, Shape{2, 0, 4, true}, Shape{0, 0, 3, false}));

TEST(Loss, IsEquationThree) {
  const PoseNetwork network = make_network({3}, 6, 3, false, 2);
  const Eigen::MatrixXf features = fourier_features(network.half_cycles, frame_times(4));
  Eigen::MatrixXf targets = Eigen::MatrixXf::Zero(4, 3);
  targets(1, 0) = 2;
  targets(3, 2) = -1;
  // W2 and b2 are zero, so F is: the loss is (2 * 3)^2 + (1 * 0.5)^2.
  Loss<float> loss(features, targets, Eigen::Vector3f(3, 1, 0.5f));
  EXPECT_FLOAT_EQ(static_cast<float>(loss.value(network)), 36.25f);
}

TEST(Loss, RefusesSizesThatDisagree) {
  const Eigen::MatrixXf features = fourier_features({}, frame_times(4));
  EXPECT_THROW(Loss<float>(features, Eigen::MatrixXf::Zero(5, 3), Eigen::VectorXf::Ones(3)), nmc::Error);
  EXPECT_THROW(Loss<float>(features, Eigen::MatrixXf::Zero(4, 3), Eigen::VectorXf::Ones(2)), nmc::Error);
}

}  // namespace
