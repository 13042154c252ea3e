// Windows that follow the motion.
#include "codec/windows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace nmc::codec {
namespace {

/// Three parameters of one joint, a hundredth of a unit a step, that follow `value`.
struct Joint {
  ClipLayout layout;
  ParameterSteps steps{Eigen::VectorXd::Constant(3, 0.01), Eigen::VectorXd::Constant(3, 0.0025)};

  Joint(Eigen::Index samples, const std::function<double(double)>& value) {
    layout.moving = {0, 1, 2};
    layout.values.resize(3, samples);
    for (Eigen::Index i = 0; i < 3; ++i)
      for (Eigen::Index n = 0; n < samples; ++n)
        layout.values(i, n) = static_cast<double>(i + 1) * value(static_cast<double>(n));
  }

  std::vector<std::uint32_t> windows(const std::vector<LevelAtom>& jumps = {}, int threads = 1) const {
    return fitted_windows(layout, steps, jumps, 0, threads);
  }
};

using Boundaries = std::vector<std::uint32_t>;

TEST(Windows, EndWhereStraightMotionTurns) {
  const Joint joint(61, [](double n) { return n < 20 ? 0.0 : n < 33 ? 0.05 * (n - 20) : 0.65 - 0.02 * (n - 33); });
  // From 33 to 60 in two: lengths above 16 are tried at every second place only.
  const Boundaries windows = joint.windows();
  for (const std::uint32_t turn : {0u, 20u, 33u, 60u})
    EXPECT_NE(std::find(windows.begin(), windows.end(), turn), windows.end()) << turn;
  EXPECT_LE(windows.size(), 5u);
}

TEST(Windows, OfOneSineAreOne) {
  const Joint joint(33, [](double n) { return std::sin(M_PI * n / 32); });
  EXPECT_EQ(joint.windows(), (Boundaries{0, 32}));
}

TEST(Windows, DoNotEndAtJumps) {
  const auto wave = [](double n) { return std::sin(M_PI * n / 32); };
  const Joint joint(33, [&](double n) { return wave(n) + (n >= 11 ? 4.0 : 0) + (n == 25 ? 9.0 : 0); });
  std::vector<LevelAtom> jumps;
  for (int i = 0; i < 3; ++i)
    jumps.push_back({11, i, LevelAtom::jump_width, static_cast<std::int32_t>(std::lround((i + 1) * 4.0 / 0.0025))});
  for (int i = 0; i < 3; ++i)
    jumps.push_back({25, i, 0, static_cast<std::int32_t>(std::lround((i + 1) * 9.0 / 0.0025))});
  EXPECT_EQ(joint.windows(jumps), (Boundaries{0, 32}));
  EXPECT_GT(joint.windows().size(), 2u);
}

TEST(Windows, CoverClipsOfAnyLengthInOrder) {
  for (const Eigen::Index samples : {2, 3, 9, 17, 101, 202, 203, 399, 1001, 1003}) {
    const Joint joint(samples, [](double n) { return std::sin(0.3 * n) + 0.4 * std::sin(0.011 * n * n); });
    const Boundaries windows = joint.windows();
    ASSERT_GE(windows.size(), 2u) << samples;
    EXPECT_EQ(windows.front(), 0u);
    EXPECT_EQ(windows.back(), static_cast<std::uint32_t>(samples - 1));
    for (std::size_t k = 1; k < windows.size(); ++k) {
      EXPECT_LT(windows[k - 1], windows[k]) << samples;
      EXPECT_LE(windows[k] - windows[k - 1], 256u) << samples;
    }
    EXPECT_EQ(joint.windows({}, 2), windows) << samples;
  }
}

TEST(Windows, OfAboutOneLengthAreEven) {
  EXPECT_EQ(even_windows(257, 128), (Boundaries{0, 128, 256}));
  EXPECT_EQ(even_windows(10, 128), (Boundaries{0, 9}));
  EXPECT_EQ(even_windows(101, 30), (Boundaries{0, 33, 66, 100}));
}

TEST(Windows, OfAClipThatHoldsStillAreFew) {
  Joint joint(65, [](double) { return 1.0; });
  EXPECT_LE(joint.windows().size(), 3u);
  joint.layout.moving.clear();
  EXPECT_GE(joint.windows().size(), 2u);
}

}  // namespace
}  // namespace nmc::codec
