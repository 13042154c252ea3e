#include "network/pose_network.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "network/fourier_features.h"

namespace {

using namespace nmc::network;

double reference_elu(double z) { return z > 0 ? z : std::expm1(z); }

/// Equation 2 in plain loops and double precision.
Eigen::VectorXd reference_pose(const PoseNetwork& network, const Eigen::VectorXd& x) {
  const auto layer = [](const Eigen::MatrixXf& weights, const Eigen::VectorXf& bias, const Eigen::VectorXd& input) {
    Eigen::VectorXd output(weights.rows());
    for (Eigen::Index i = 0; i < weights.rows(); ++i) {
      output[i] = bias[i];
      for (Eigen::Index j = 0; j < weights.cols(); ++j) output[i] += double{weights(i, j)} * input[j];
    }
    return output;
  };
  const Eigen::VectorXd first = layer(network.W0, network.b0, x).unaryExpr(&reference_elu);
  const Eigen::VectorXd second = layer(network.W1, network.b1, first).unaryExpr(&reference_elu);
  Eigen::VectorXd pose = layer(network.W2, network.b2, second);
  if (network.has_skip()) pose += network.S.cast<double>() * x;
  return pose;
}

PoseNetwork full_random_network(std::vector<int> half_cycles, int hidden, int pose, bool skip) {
  PoseNetwork network = make_network(std::move(half_cycles), hidden, pose, skip, 7);
  std::srand(3);
  network.W2.setRandom();
  network.b2.setRandom();
  if (skip) network.S.setRandom();
  return network;
}

TEST(PoseNetwork, ComputesEquationTwo) {
  for (const bool skip : {false, true}) {
    const PoseNetwork network = full_random_network({3, 8}, 10, 7, skip);
    const Eigen::VectorXd times = frame_times(20);
    const Eigen::MatrixXf features = fourier_features(network.half_cycles, times);
    const Eigen::MatrixXf poses = evaluate(network, times);
    ASSERT_EQ(poses.rows(), 20);
    ASSERT_EQ(poses.cols(), 7);
    for (Eigen::Index n = 0; n < 20; ++n) {
      const Eigen::VectorXd expected = reference_pose(network, features.row(n).transpose().cast<double>());
      for (Eigen::Index i = 0; i < 7; ++i) EXPECT_NEAR(poses(n, i), expected[i], 2e-6);
    }
  }
}

TEST(PoseNetwork, WithoutHiddenUnitsIsTheSkip) {
  const PoseNetwork network = full_random_network({2, 5}, 0, 4, true);
  const Eigen::VectorXd times = frame_times(9);
  const Eigen::MatrixXf poses = evaluate(network, times);
  const Eigen::MatrixXf features = fourier_features(network.half_cycles, times);
  for (Eigen::Index n = 0; n < 9; ++n) {
    for (Eigen::Index i = 0; i < 4; ++i) {
      double expected = network.b2[i];
      for (Eigen::Index j = 0; j < 5; ++j) expected += double{network.S(i, j)} * features(n, j);
      EXPECT_NEAR(poses(n, i), expected, 1e-6);
    }
  }
}

TEST(PoseNetwork, RefusesFeaturesOfOtherFrequencies) {
  const PoseNetwork network = full_random_network({2, 5}, 4, 4, false);
  EXPECT_THROW(evaluate(network, Eigen::MatrixXf(3, 7)), nmc::Error);
}

TEST(ParameterCount, IsThePapersFormula) {
  for (const std::size_t frequencies : {0u, 1u, 5u, 10u}) {
    const std::size_t m = 97;
    const std::size_t d = 2 * frequencies + 1;
    const std::size_t h = 2 * d;
    const std::vector<int> half_cycles(frequencies, 1);
    const auto hidden = paper_hidden_size(static_cast<Eigen::Index>(frequencies));
    ASSERT_EQ(static_cast<std::size_t>(hidden), h);
    const PoseNetwork network = make_network(half_cycles, hidden, static_cast<Eigen::Index>(m), false, 1);
    EXPECT_EQ(parameter_count(network), h * d + h + h * h + h + h * m + m);
  }
  EXPECT_EQ(parameter_count(make_network({4}, 0, 5, true, 1)), 5u + 15u);
}

TEST(MakeNetwork, StartsWithinItsRangeAndDependsOnTheSeedAlone) {
  const PoseNetwork network = make_network({1, 2, 3}, 14, 5, false, 11);
  EXPECT_LE(network.W0.cwiseAbs().maxCoeff(), 1 / std::sqrt(7.0f));
  EXPECT_GT(network.W0.cwiseAbs().maxCoeff(), 0.8f / std::sqrt(7.0f));
  EXPECT_LE(network.W1.cwiseAbs().maxCoeff(), 1 / std::sqrt(14.0f));
  EXPECT_NEAR(network.W1.mean(), 0, 0.05);
  EXPECT_EQ(make_network({1, 2, 3}, 14, 5, false, 11).W1, network.W1);
  EXPECT_NE(make_network({1, 2, 3}, 14, 5, false, 12).W1, network.W1);
}

TEST(Grow, KeepsTheFunctionAndTheOldWeights) {
  for (const bool skip : {false, true}) {
    const PoseNetwork small = full_random_network({3, 8}, 10, 7, skip);
    const PoseNetwork grown = grow(small, 13, 14, 5);
    EXPECT_EQ(grown.half_cycles, (std::vector<int>{3, 8, 13}));
    EXPECT_EQ(grown.hidden_size(), 14);
    EXPECT_EQ(grown.W0.topLeftCorner(10, 5), small.W0);
    EXPECT_EQ(grown.W1.topLeftCorner(10, 10), small.W1);
    EXPECT_EQ(grown.W2.leftCols(10), small.W2);
    EXPECT_EQ(grown.has_skip(), skip);
    const Eigen::VectorXd times = frame_times(50);
    EXPECT_LT((evaluate(grown, times) - evaluate(small, times)).cwiseAbs().maxCoeff(), 2e-6f);
    // The new units must be able to learn: they see something.
    EXPECT_GT(grown.W0.bottomRows(4).cwiseAbs().minCoeff(), 0.0f);
    EXPECT_GT(grown.W1.bottomRows(4).cwiseAbs().minCoeff(), 0.0f);
  }
}

TEST(Grow, RefusesToShrink) { EXPECT_THROW(grow(full_random_network({3}, 6, 2, false), 4, 5, 1), nmc::Error); }

TEST(Elu, MatchesItsDefinition) {
  for (double z = -30; z <= 30; z += 0.01) {
    const Eigen::Array<float, 8, 1> input = Eigen::Array<float, 8, 1>::Constant(static_cast<float>(z));
    const Eigen::Array<float, 8, 1> output = elu(input);
    EXPECT_NEAR(output[3], reference_elu(double{input[3]}), 1.5e-7 + 1e-7 * std::abs(z));
    const double derivative = input[3] > 0 ? 1.0 : std::exp(double{input[3]});
    EXPECT_NEAR(Eigen::ArrayXf(elu_derivative(output))[3], derivative, 2e-7);
  }
}

}  // namespace
