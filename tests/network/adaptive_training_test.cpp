#include "network/adaptive_training.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "network/fourier_features.h"

namespace {

using namespace nmc::network;

/// A clip whose parameters are cosines of the given half cycles, in falling amplitude.
TrainingClip cosine_clip(const std::vector<int>& half_cycles) {
  TrainingClip clip;
  clip.poses.setZero(200, 6);
  for (Eigen::Index n = 0; n < 200; ++n) {
    const double t = static_cast<double>(n) / 199;
    for (std::size_t k = 0; k < half_cycles.size(); ++k) {
      const double amplitude = std::pow(0.6, static_cast<double>(k));
      const auto i = static_cast<Eigen::Index>(k);
      clip.poses(n, i) += static_cast<float>(amplitude * std::cos(std::numbers::pi * half_cycles[k] * t));
      clip.poses(n, i + 3) += static_cast<float>(0.5 * amplitude * std::cos(std::numbers::pi * half_cycles[k] * t));
    }
  }
  clip.weights = Eigen::VectorXf::Ones(6);
  return clip;
}

double largest_difference(const PoseNetwork& network, const TrainingClip& clip) {
  return (evaluate(network, frame_times(clip.poses.rows())) - clip.poses).cwiseAbs().maxCoeff();
}

TEST(TrainAdaptive, FindsTheFrequenciesOfTheClip) {
  const TrainingClip clip = cosine_clip({29, 13, 8});
  AdaptiveOptions options;
  options.max_frequencies = 3;
  // The fastest is the strongest and none is slow: a network makes slow waves of time alone and faster ones of slow
  // ones, without their feature. frequencies.
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    options.seed = seed;
    const AdaptiveResult result =
        train_adaptive(clip, options, [&](const PoseNetwork& network) { return largest_difference(network, clip); });
    EXPECT_EQ(result.network.half_cycles, (std::vector<int>{29, 13, 8})) << "seed " << seed;
    EXPECT_LT(result.error, 0.02);
    EXPECT_EQ(result.error, largest_difference(result.network, clip));
  }
}

TEST(TrainAdaptive, StopsAtTheFirstNetworkUnderTheThreshold) {
  const TrainingClip clip = cosine_clip({3, 8, 13});
  AdaptiveOptions options;
  options.max_frequencies = 20;
  options.threshold = 0.05;
  const AdaptiveResult result =
      train_adaptive(clip, options, [&](const PoseNetwork& network) { return largest_difference(network, clip); });
  ASSERT_TRUE(result.success);
  EXPECT_LE(result.error, 0.05);
  EXPECT_LT(result.steps.size(), 8u);
  for (std::size_t k = 0; k + 1 < result.steps.size(); ++k) EXPECT_GT(result.steps[k].error, 0.05);
  EXPECT_EQ(result.steps.back().frequencies, static_cast<int>(result.network.half_cycles.size()));
}

TEST(TrainAdaptive, LossFallsWithEveryFrequency) {
  const TrainingClip clip = cosine_clip({3, 8, 13});
  AdaptiveOptions options;
  options.max_frequencies = 4;
  const AdaptiveResult result = train_adaptive(clip, options, [](const PoseNetwork&) { return 1.0; });
  ASSERT_EQ(result.steps.size(), 5u);
  for (std::size_t k = 1; k < result.steps.size(); ++k) {
    EXPECT_LE(result.steps[k].loss, 1.001 * result.steps[k - 1].loss);
  }
}

TEST(TrainAdaptive, GivesTheBestWhereNoneIsUnderTheThreshold) {
  const TrainingClip clip = cosine_clip({3, 8});
  AdaptiveOptions options;
  options.max_frequencies = 3;
  // A measure that likes one frequency best.
  const AdaptiveResult result = train_adaptive(clip, options, [](const PoseNetwork& network) {
    return std::abs(double(network.half_cycles.size()) - 1.0) + 1.0;
  });
  EXPECT_FALSE(result.success);
  EXPECT_EQ(result.network.half_cycles.size(), 1u);
  EXPECT_EQ(result.error, 1.0);
  EXPECT_EQ(result.steps.size(), 4u);
}

TEST(TrainAdaptive, ConsecutiveChoiceIsFullCycles) {
  const TrainingClip clip = cosine_clip({3, 8, 13});
  AdaptiveOptions options;
  options.choice = FrequencyChoice::consecutive;
  options.max_frequencies = 3;
  options.training.iterations = 10;
  options.final_iterations = 10;
  const AdaptiveResult result = train_adaptive(
      clip, options, [](const PoseNetwork& network) { return 1.0 / double(network.half_cycles.size() + 1); });
  EXPECT_EQ(result.network.half_cycles, (std::vector<int>{2, 4, 6}));
}

TEST(TrainAdaptive, IsDeterministic) {
  const TrainingClip clip = cosine_clip({3, 8, 13});
  AdaptiveOptions options;
  options.max_frequencies = 2;
  const auto measure = [&](const PoseNetwork& network) { return largest_difference(network, clip); };
  AdaptiveResult a = train_adaptive(clip, options, measure);
  AdaptiveResult b = train_adaptive(clip, options, measure);
  EXPECT_EQ(a.network.half_cycles, b.network.half_cycles);
  for (std::size_t t = 0; t < a.network.tensors().size(); ++t) {
    EXPECT_TRUE(std::ranges::equal(a.network.tensors()[t], b.network.tensors()[t])) << "tensor " << t;
  }
}

TEST(TrainAdaptive, EndsWhenAsked) {
  const TrainingClip clip = cosine_clip({3, 8, 13});
  AdaptiveOptions options;
  options.stop_requested = [] { return true; };
  const AdaptiveResult result = train_adaptive(clip, options, [](const PoseNetwork&) { return 1.0; });
  EXPECT_EQ(result.steps.size(), 1u);
  EXPECT_FALSE(result.success);
}

TEST(TrainAdaptive, WorksOnOneAndTwoFrames) {
  for (const Eigen::Index frames : {1, 2}) {
    TrainingClip clip;
    clip.poses = Eigen::MatrixXf::Random(frames, 5);
    clip.weights = Eigen::VectorXf::Ones(5);
    AdaptiveOptions options;
    options.threshold = 1e-3;
    const AdaptiveResult result =
        train_adaptive(clip, options, [&](const PoseNetwork& network) { return largest_difference(network, clip); });
    EXPECT_TRUE(result.success) << frames << " frames, error " << result.error;
  }
}

TEST(TrainAdaptive, RefusesWhatItCannotLearn) {
  const auto attempt = [](const TrainingClip& clip) {
    return train_adaptive(clip, {}, [](const PoseNetwork&) { return 0.0; });
  };
  TrainingClip clip = cosine_clip({3});
  clip.poses(4, 2) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(attempt(clip), nmc::Error);
  clip = cosine_clip({3});
  clip.weights = Eigen::VectorXf::Ones(5);
  EXPECT_THROW(attempt(clip), nmc::Error);
  clip.weights = -Eigen::VectorXf::Ones(6);
  EXPECT_THROW(attempt(clip), nmc::Error);
  EXPECT_THROW(attempt(TrainingClip{}), nmc::Error);
}

}  // namespace
