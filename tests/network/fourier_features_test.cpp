#include "network/fourier_features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace {

using nmc::network::fourier_features;
using nmc::network::frame_times;

TEST(FrameTimes, RunFromZeroToOne) {
  const Eigen::VectorXd times = frame_times(5);
  ASSERT_EQ(times.size(), 5);
  for (int n = 0; n < 5; ++n) EXPECT_EQ(times[n], n / 4.0);
}

TEST(FrameTimes, OneFrameIsAtZeroAndNoFrameIsNone) {
  EXPECT_EQ(frame_times(1), Eigen::VectorXd::Zero(1));
  EXPECT_EQ(frame_times(0).size(), 0);
}

TEST(FourierFeatures, AreEquationOne) {
  const std::vector<int> half_cycles = {1, 8, 13, 2000};
  const Eigen::VectorXd times = frame_times(101);
  const Eigen::MatrixXf features = fourier_features(half_cycles, times);
  ASSERT_EQ(features.rows(), 101);
  ASSERT_EQ(features.cols(), 9);
  for (int n = 0; n < 101; ++n) {
    EXPECT_EQ(features(n, 0), static_cast<float>(times[n]));
    for (std::size_t k = 0; k < half_cycles.size(); ++k) {
      const double phase = std::numbers::pi * half_cycles[k] * times[n];
      const auto column = static_cast<Eigen::Index>(2 * k + 1);
      EXPECT_NEAR(features(n, column), std::sin(phase), 1e-6);
      EXPECT_NEAR(features(n, column + 1), std::cos(phase), 1e-6);
    }
  }
}

TEST(FourierFeatures, KeepThePhaseOfLargeFrequencies) {
  const std::vector<int> half_cycles = {1'000'001};
  const Eigen::VectorXd times{{0.5}};
  const Eigen::MatrixXf features = fourier_features(half_cycles, times);
  // 500000.5 half cycles: an even number of them and a quarter of a cycle.
  EXPECT_FLOAT_EQ(features(0, 1), 1.0f);
  EXPECT_NEAR(features(0, 2), 0.0f, 1e-7);
}

TEST(FourierFeatures, WithoutFrequenciesAreTime) {
  const Eigen::VectorXd times = frame_times(3);
  EXPECT_EQ(fourier_features({}, times), Eigen::MatrixXf(times.cast<float>()));
}

}  // namespace
