#include "network/training.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "network/fourier_features.h"

namespace {

using namespace nmc::network;

TrainingClip small_clip() {
  TrainingClip clip;
  clip.poses.resize(80, 4);
  for (int n = 0; n < 80; ++n) {
    const double t = n / 79.0;
    const double phase = std::numbers::pi * 4 * t;
    clip.poses(n, 0) = static_cast<float>(100 + 3 * t);
    clip.poses(n, 1) = static_cast<float>(std::sin(phase));
    clip.poses(n, 2) = static_cast<float>(0.3 * std::exp(std::cos(phase)));
    clip.poses(n, 3) = 0.5f;
  }
  clip.weights = Eigen::Vector4f(1, 0.5f, 0.25f, 0);
  return clip;
}

/// Equation 3 by its definition.
double equation_three(const PoseNetwork& network, const TrainingClip& clip) {
  const Eigen::MatrixXf poses = evaluate(network, frame_times(clip.poses.rows()));
  double sum = 0;
  for (Eigen::Index n = 0; n < poses.rows(); ++n) {
    for (Eigen::Index i = 0; i < poses.cols(); ++i) {
      sum += std::pow((double{clip.poses(n, i)} - poses(n, i)) * clip.weights[i], 2);
    }
  }
  return sum;
}

TEST(Train, ReducesTheLossAndReturnsIt) {
  const TrainingClip clip = small_clip();
  PoseNetwork network = make_network({4}, paper_hidden_size(1), 4, false, 1);
  TrainOptions options;
  options.iterations = 30;
  const double early = train(network, clip, options);
  EXPECT_NEAR(equation_three(network, clip), early, 1e-3 * early);
  options.iterations = 1000;
  const double late = train(network, clip, options);
  EXPECT_NEAR(equation_three(network, clip), late, 1e-2 * late);
  EXPECT_LT(late, 0.05 * early);
}

TEST(Train, NeverGivesBackWorseThanItGot) {
  const TrainingClip clip = small_clip();
  PoseNetwork network = make_network({4}, paper_hidden_size(1), 4, false, 1);
  TrainOptions options;
  options.iterations = 500;
  train(network, clip, options);
  const double before = equation_three(network, clip);
  options.iterations = 20;
  options.learning_rate = 10;  // sure to ruin it
  train(network, clip, options);
  EXPECT_LE(equation_three(network, clip), 1.001 * before);
}

TEST(Train, GivesParametersWithoutWeightTheirMean) {
  const TrainingClip clip = small_clip();
  PoseNetwork network = make_network({4}, paper_hidden_size(1), 4, false, 1);
  train(network, clip, {.iterations = 20});
  EXPECT_NEAR(evaluate(network, frame_times(3))(1, 3), 0.5f, 1e-5);
}

TEST(Train, WithoutHiddenUnitsFindsTheLinearFit) {
  TrainingClip clip = small_clip();
  PoseNetwork network = make_network({4}, 0, 4, true, 1);
  train(network, clip, {.iterations = 2000, .learning_rate = 0.05});
  const Eigen::MatrixXf poses = evaluate(network, frame_times(80));
  EXPECT_LT((poses.leftCols(2) - clip.poses.leftCols(2)).cwiseAbs().maxCoeff(), 0.01);
}

TEST(Train, StopsWhenAsked) {
  const TrainingClip clip = small_clip();
  PoseNetwork network = make_network({4}, paper_hidden_size(1), 4, false, 1);
  int asked = 0;
  TrainOptions options;
  options.iterations = 1'000'000'000;
  options.stop_requested = [&] { return ++asked > 3; };
  train(network, clip, options);
  EXPECT_EQ(asked, 4);
}

TEST(Train, IsDeterministic) {
  const TrainingClip clip = small_clip();
  const auto once = [&] {
    PoseNetwork network = make_network({4, 9}, paper_hidden_size(2), 4, true, 1);
    train(network, clip, {.iterations = 100});
    return network;
  };
  PoseNetwork a = once();
  PoseNetwork b = once();
  for (std::size_t t = 0; t < a.tensors().size(); ++t) {
    EXPECT_TRUE(std::ranges::equal(a.tensors()[t], b.tensors()[t])) << "tensor " << t;
  }
}

TEST(Train, OfAConstantClipIsExact) {
  TrainingClip clip;
  clip.poses = Eigen::MatrixXf::Constant(10, 3, 2.5f);
  clip.weights = Eigen::Vector3f::Ones();
  PoseNetwork network = make_network({}, 2, 3, false, 1);
  EXPECT_LT(train(network, clip, {.iterations = 5}), 1e-10);
}

}  // namespace
