// Clips: the common grid, sampling on it, and back to curves.
#include "motion/clip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "base/error.h"
#include "motion/curve.h"

namespace nmc::motion {
namespace {

using ::testing::ElementsAre;

std::vector<float> grid(int first, int last, int step = 1, float rate = 30.0f) {
  std::vector<float> times;
  for (int i = first; i <= last; i += step) times.push_back(static_cast<float>(i) / rate);
  return times;
}

Curve curve_on(std::vector<float> times, int node = 0) {
  Curve curve{node, Path::translation, Interpolation::linear, 3, std::move(times), {}};
  for (std::size_t i = 0; i < curve.times.size() * 3; ++i) curve.values.push_back(static_cast<float>(i * i % 7));
  return curve;
}

Curve random_rotations(std::vector<float> times, unsigned seed) {
  std::mt19937 random(seed);
  Curve curve{1, Path::rotation, Interpolation::linear, 4, std::move(times), {}};
  for (std::size_t i = 0; i < curve.times.size() * 4; ++i) {
    curve.values.push_back(static_cast<float>(static_cast<double>(random()) / 2147483648.0 - 1.0));
  }
  return curve;
}

std::vector<double> value_at(const Curve& curve, double seconds) {
  std::vector<double> out(static_cast<std::size_t>(curve.width));
  evaluate(curve, seconds, out);
  return out;
}

double angle(const std::vector<double>& a, const std::vector<double>& b) {
  double minus = 0, plus = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    minus += (a[i] - b[i]) * (a[i] - b[i]);
    plus += (a[i] + b[i]) * (a[i] + b[i]);
  }
  return 4 * std::atan2(std::sqrt(std::min(minus, plus)), std::sqrt(std::max(minus, plus)));
}

TEST(CommonTimes, OneSharedGridComesBackBitForBit) {
  const std::vector<float> times = grid(0, 100);
  EXPECT_EQ(common_times({curve_on(times), curve_on(times), curve_on(times)}), times);
  EXPECT_TRUE(common_times({}).empty());
}

TEST(CommonTimes, ConstantsAndSubsetsBelongToTheGridOfTheOthers) {
  const std::vector<float> times = grid(0, 24);
  EXPECT_EQ(common_times({curve_on({times.front(), times.back()}), curve_on({0.0f}), curve_on(times)}), times);
  EXPECT_EQ(common_times({curve_on(grid(0, 24, 2)), curve_on(grid(0, 24, 3)), curve_on(grid(0, 24, 8)),
                          curve_on(grid(1, 23, 1))}),
            times);
}

TEST(CommonTimes, KeysCloserThanAMicrosecondTakeTheBitsOfTheMajority) {
  const float common = 0.1f, odd = std::nextafter(common, 1.0f), odder = std::nextafter(odd, 1.0f);
  EXPECT_THAT(common_times({curve_on({0, odd, 1}), curve_on({0, common}), curve_on({0.05f, common})}),
              ElementsAre(0.0f, 0.05f, common, 1.0f));
  EXPECT_THAT(common_times({curve_on({0, odder}), curve_on({0, common, 1})}), ElementsAre(0.0f, odder, 1.0f));
  EXPECT_THAT(common_times({curve_on({0.1f, 0.100002f}), curve_on({0.1f})}), ElementsAre(0.1f, 0.100002f));
}

TEST(CommonTimes, TwoKeysOfOneCurveAreNeverMerged) {
  // A jump written as two LINEAR keys next to each other.
  const float before = 0.5f, after = std::nextafter(before, 1.0f);
  EXPECT_THAT(common_times({curve_on({0, before, after, 1}), curve_on({0, 1})}),
              ElementsAre(0.0f, before, after, 1.0f));
  EXPECT_THAT(common_times({curve_on({0, before, after, 1}), curve_on({0, after, 1})}),
              ElementsAre(0.0f, before, after, 1.0f));
}

TEST(CommonTimes, IncommensurableGridsGiveTheWholeUnion) {
  const std::vector<float> times = common_times({curve_on(grid(0, 30, 1, 30)), curve_on(grid(0, 25, 1, 25))});
  EXPECT_EQ(times.size(), 31u + 26u - 6u);  // they meet each fifth of a second
  EXPECT_TRUE(std::is_sorted(times.begin(), times.end()));
}

TEST(CommonTimes, SubdivisionsKeepTheKeys) {
  EXPECT_THAT(common_times({curve_on({0, 1, 3})}, 4),
              ElementsAre(0.0f, 0.25f, 0.5f, 0.75f, 1.0f, 1.5f, 2.0f, 2.5f, 3.0f));
  const float next = std::nextafter(1.0f, 2.0f);
  EXPECT_THAT(common_times({curve_on({1, next})}, 64), ElementsAre(1.0f, next));
  EXPECT_THROW(common_times({curve_on({0, 1})}, 0), Error);
}

TEST(NeededSubdivisions, FollowsTheCurvatureOfACubic) {
  // x = t^2 on [0, 1]: the chord of a part of length h is h^2 / 4 away in its middle, so 1/n^2 / 4 <= limit decides.
  const Curve parabola{0,
                       Path::translation,
                       Interpolation::cubic_spline,
                       3,
                       {0, 1},
                       {0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 1, 0, 0, 0, 0, 0}};
  EXPECT_EQ(needed_subdivisions({parabola}, 1, 0.251), 1);
  EXPECT_EQ(needed_subdivisions({parabola}, 1, 0.249), 2);
  EXPECT_EQ(needed_subdivisions({parabola}, 1, 0.25 / 256 * 1.001), 16);
  EXPECT_EQ(needed_subdivisions({parabola}, 1, 0.25 / 256 * 0.999), 32);
  EXPECT_EQ(needed_subdivisions({parabola}, 1, 0), 64);
  EXPECT_EQ(needed_subdivisions({curve_on({0, 1})}, 0, 0), 1);
  EXPECT_EQ(needed_subdivisions({}, 0, 0), 1);
}

TEST(NeededSubdivisions, FollowsARotation) {
  // Appendix C: eased from 0 to a right angle and back; without subdivision the ease is missed by far.
  const float s = std::sqrt(0.5f);
  const Curve ease{0, Path::rotation, Interpolation::cubic_spline,
                   4, {0, 1},         {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, s, s, 0, 0, 0, 0}};
  const int n = needed_subdivisions({ease}, 1e-3, 0);
  EXPECT_GT(n, 4);
  const std::vector<float> times = common_times({ease}, n), coarse = common_times({ease}, n / 2);
  const auto worst = [&](const std::vector<float>& samples) {
    const Animation sampled = to_animation(sample_clip("", {ease}, samples));
    double largest = 0;
    for (double t = 0; t <= 1; t += 1.0 / 1024) {
      largest = std::max(largest, angle(value_at(ease, t), value_at(sampled.curves[0], t)));
    }
    return largest;
  };
  EXPECT_LT(worst(times), 1.05e-3);
  EXPECT_GT(worst(coarse), 1e-3);
}

TEST(SampleRate, IsFoundFromTheKeys) {
  EXPECT_NEAR(sample_rate_hz(grid(0, 1000)), 30.0, 1e-4);
  EXPECT_NEAR(sample_rate_hz(grid(3000, 4000, 1, 120)), 120.0, 1e-3);
  EXPECT_NEAR(sample_rate_hz({0, 0.1f, 0.2f, 0.3f, 5.0f}), 10.0, 1e-5);
  EXPECT_EQ(sample_rate_hz({1.0f}), 0.0);
  EXPECT_EQ(sample_rate_hz({}), 0.0);
}

TEST(SampleClip, FinerGridReproducesSparseCurves) {
  const std::vector<float> times = grid(0, 60);
  const std::vector<Curve> curves{random_rotations(grid(0, 60, 12), 3), curve_on(grid(0, 60, 7)), curve_on(times)};
  const Clip clip = sample_clip("clip", curves, common_times(curves));
  ASSERT_EQ(clip.times, times);
  const Animation back = to_animation(clip);
  for (double t = -0.1; t < 2.2; t += 0.003) {
    EXPECT_LT(angle(value_at(curves[0], t), value_at(back.curves[0], t)), 1e-6) << t;
    for (std::size_t c : {1u, 2u}) {
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(value_at(curves[c], t)[i], value_at(back.curves[c], t)[i], 1e-6) << t;
      }
    }
  }
}

TEST(SampleClip, ALateCurveHoldsItsFirstValue) {
  const std::vector<Curve> curves{curve_on(grid(0, 10)), curve_on(grid(4, 7))};
  const Clip clip = sample_clip("clip", curves, common_times(curves));
  const Curve back = to_animation(clip).curves[1];
  for (double t = 0; t < 0.4; t += 0.001) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(value_at(back, t)[i], value_at(curves[1], t)[i], 1e-6) << t;
  }
}

TEST(SampleClip, RotationsAreUnitAndSignContinuous) {
  const Curve curve = random_rotations(grid(0, 50), 11);
  const Clip clip = sample_clip("clip", {curve}, curve.times);
  const std::vector<float>& v = clip.tracks[0].values;
  ASSERT_EQ(v.size(), 51u * 4);
  for (std::size_t row = 0; row < v.size(); row += 4) {
    double length = 0, dot = 0;
    for (std::size_t i = row; i < row + 4; ++i) {
      length += static_cast<double>(v[i]) * v[i];
      if (row > 0) dot += static_cast<double>(v[i]) * v[i - 4];
    }
    EXPECT_NEAR(length, 1.0, 3e-7);
    EXPECT_GE(dot, 0.0);
  }
}

TEST(SampleClip, OnlyWhatNeverChangesIsConstant) {
  const std::vector<float> times{0, 1, 2};
  const auto track = [&](const Curve& curve) { return sample_clip("", {curve}, times).tracks[0]; };
  const Curve still{0, Path::scale, Interpolation::linear, 3, times, {1, 2, 3, 1, 2, 3, 1, 2, 3}};
  EXPECT_TRUE(track(still).constant());
  EXPECT_THAT(track(still).values, ElementsAre(1, 2, 3));

  Curve almost = still;
  almost.values[8] = std::nextafter(3.0f, 4.0f);
  EXPECT_FALSE(track(almost).constant());

  const Curve signs{0, Path::rotation, Interpolation::linear,
                    4, times,          {0.6f, 0, 0, 0.8f, -0.6f, -0.0f, 0, -0.8f, 0.6f, 0, 0, 0.8f}};
  EXPECT_TRUE(track(signs).constant());
  const Curve lengths{0, Path::rotation, Interpolation::linear, 4, times, {0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 1}};
  EXPECT_TRUE(track(lengths).constant());

  const Curve bulge{0, Path::weights, Interpolation::cubic_spline, 1, {0, 2}, {0, 5, 1, -1, 5, 0}};
  EXPECT_FALSE(track(bulge).constant());
}

TEST(SampleClip, StepCurvesMustStandStill) {
  const std::vector<float> times{0, 1};
  const Curve still{0, Path::scale, Interpolation::step, 3, times, {1, 2, 3, 1, 2, 3}};
  EXPECT_TRUE(sample_clip("", {still}, times).tracks[0].constant());
  const Curve jump{0, Path::scale, Interpolation::step, 3, times, {1, 2, 3, 1, 2, 4}};
  try {
    sample_clip("hop", {jump}, times);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::internal);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("hop"));
  }
}

TEST(SampleClip, KeysComeBackBitForBit) {
  const Curve curve = curve_on(grid(5, 40));
  const Animation back = to_animation(sample_clip("walk", {curve}, common_times({curve})));
  EXPECT_EQ(back.name, "walk");
  EXPECT_EQ(back.curves[0], curve);
}

TEST(ToAnimation, ConstantTracksGetTheirTwoEnds) {
  Clip clip{"c", {0.5f, 1, 2}, {{3, Path::translation, 3, {1, 2, 3}}}};
  EXPECT_EQ(to_animation(clip).curves[0],
            (Curve{3, Path::translation, Interpolation::linear, 3, {0.5f, 2}, {1, 2, 3, 1, 2, 3}}));
  clip.times = {0.5f};
  EXPECT_EQ(to_animation(clip).curves[0], (Curve{3, Path::translation, Interpolation::linear, 3, {0.5f}, {1, 2, 3}}));
}

}  // namespace
}  // namespace nmc::motion
