// Curves against the closed forms of glTF 2.0, section 3.11 and appendix C.
#include "motion/curve.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"

namespace nmc::motion {
namespace {

constexpr double pi = std::numbers::pi;

std::vector<double> value_at(const Curve& curve, double seconds) {
  std::vector<double> out(static_cast<std::size_t>(curve.width));
  evaluate(curve, seconds, out);
  return out;
}

/// x, y, z, w of a rotation about the z axis.
std::array<float, 4> about_z(double radians) {
  return {0.0f, 0.0f, static_cast<float>(std::sin(radians / 2)), static_cast<float>(std::cos(radians / 2))};
}

Curve rotation_curve(std::vector<float> times, const std::vector<std::array<float, 4>>& keys) {
  Curve curve{0, Path::rotation, Interpolation::linear, 4, std::move(times), {}};
  for (const auto& key : keys) curve.values.insert(curve.values.end(), key.begin(), key.end());
  return curve;
}

double angle_about_z(const std::vector<double>& q) { return 2 * std::atan2(q[2], q[3]); }

TEST(Curve, LinearInterpolatesAndClamps) {
  const Curve curve{0, Path::translation, Interpolation::linear, 3, {1, 3, 4}, {0, 1, 2, 4, 1, 0, 4, 5, 0}};
  EXPECT_EQ(value_at(curve, 1.5), (std::vector<double>{1, 1, 1.5}));
  EXPECT_EQ(value_at(curve, 3.25), (std::vector<double>{4, 2, 0}));
  EXPECT_EQ(value_at(curve, -7), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(value_at(curve, 1), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(value_at(curve, 4), (std::vector<double>{4, 5, 0}));
  EXPECT_EQ(value_at(curve, 99), (std::vector<double>{4, 5, 0}));
}

TEST(Curve, OneKeyHoldsForEver) {
  const Curve curve{0, Path::scale, Interpolation::linear, 3, {2}, {1, 2, 3}};
  for (const double t : {0.0, 2.0, 5.0}) EXPECT_EQ(value_at(curve, t), (std::vector<double>{1, 2, 3}));
  const Curve cubic{0, Path::scale, Interpolation::cubic_spline, 3, {2}, {9, 9, 9, 1, 2, 3, 9, 9, 9}};
  for (const double t : {0.0, 2.0, 5.0}) EXPECT_EQ(value_at(cubic, t), (std::vector<double>{1, 2, 3}));
}

TEST(Curve, StepHoldsUntilTheNextKey) {
  const Curve curve{0, Path::weights, Interpolation::step, 2, {0, 1, 2}, {1, 10, 2, 20, 3, 30}};
  EXPECT_EQ(value_at(curve, 0.999999), (std::vector<double>{1, 10}));
  EXPECT_EQ(value_at(curve, 1.0), (std::vector<double>{2, 20}));
  EXPECT_EQ(value_at(curve, 1.5), (std::vector<double>{2, 20}));
  EXPECT_EQ(value_at(curve, 2.0), (std::vector<double>{3, 30}));
  EXPECT_EQ(value_at(curve, 3.0), (std::vector<double>{3, 30}));
  EXPECT_EQ(value_at(curve, -1.0), (std::vector<double>{1, 10}));
}

TEST(Curve, CubicSplineReproducesACubicPolynomial) {
  // With its own values and derivatives at the keys, a cubic is its own Hermite interpolant. Coefficients are exact in
  // float.
  const auto p = [](double t) { return 0.5 * t * t * t - 1.25 * t * t + 0.75 * t - 2.0; };
  const auto slope = [](double t) { return 1.5 * t * t - 2.5 * t + 0.75; };
  Curve curve{0, Path::weights, Interpolation::cubic_spline, 1, {0.5, 1, 3, 3.5}, {}};
  for (const double t : curve.times) {
    curve.values.insert(curve.values.end(),
                        {static_cast<float>(slope(t)), static_cast<float>(p(t)), static_cast<float>(slope(t))});
  }
  for (double t = 0.5; t <= 3.5; t += 1.0 / 64) EXPECT_NEAR(value_at(curve, t)[0], p(t), 1e-12) << t;
}

TEST(Curve, CubicSplineTakesTheOutTangentOfTheStartAndTheInTangentOfTheEnd) {
  const Curve curve{0, Path::weights, Interpolation::cubic_spline, 1, {0, 2}, {100, 0, 3, 5, 0, 100}};
  // p(1/2) = h/8 (out - in) with zero values: 2/8 * (3 - 5).
  EXPECT_NEAR(value_at(curve, 1.0)[0], -0.5, 1e-15);
}

TEST(Curve, CubicSplineRotationIsNormalised) {
  const Curve curve{0, Path::rotation, Interpolation::cubic_spline,
                    4, {0, 1},         {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}};
  const std::vector<double> q = value_at(curve, 0.25);
  const double u = 0.25, s = 3 * u * u - 2 * u * u * u, length = std::hypot(s, 1 - s);
  EXPECT_NEAR(q[2], s / length, 1e-15);
  EXPECT_NEAR(q[3], (1 - s) / length, 1e-15);
}

TEST(Curve, SlerpTurnsEvenly) {
  const Curve curve = rotation_curve({0, 2}, {about_z(0.3), about_z(2.7)});
  for (double u = 0; u <= 1; u += 1.0 / 32) EXPECT_NEAR(angle_about_z(value_at(curve, 2 * u)), 0.3 + 2.4 * u, 2e-7);
}

TEST(Curve, SlerpTakesTheShortArc) {
  std::array<float, 4> end = about_z(0.5);
  for (float& x : end) x = -x;
  const Curve curve = rotation_curve({0, 1}, {about_z(-0.5), end});
  EXPECT_NEAR(angle_about_z(value_at(curve, 0.25)), -0.25, 1e-7);
}

TEST(Curve, SlerpIsAccurateForTinyAngles) {
  for (const float half : {1e-3f, 1e-5f, 1e-7f, 1e-9f, 1e-12f}) {
    const Curve curve = rotation_curve({0, 1}, {{0, 0, 0, 1}, {half, 0, 0, 1}});
    const double whole = std::atan(static_cast<double>(half));
    const std::vector<double> q = value_at(curve, 0.375);
    EXPECT_NEAR(std::atan2(q[0], q[3]) / whole, 0.375, 1e-12) << half;
  }
}

TEST(Curve, SlerpOfRightAndHalfTurns) {
  // Quaternions at right angles: rotations half a turn apart.
  const Curve curve = rotation_curve({0, 1}, {{0, 0, 0, 1}, {0, 0, 1, 0}});
  for (const double u : {0.125, 0.5, 0.875}) EXPECT_NEAR(angle_about_z(value_at(curve, u)), pi * u, 1e-14);
}

TEST(Curve, KeysOfAnyLengthAreNormalised) {
  const Curve curve = rotation_curve({0, 1}, {{0, 0, 0, 5}, {0, 0, 0.01f, 0.01f}});
  EXPECT_NEAR(angle_about_z(value_at(curve, 0.5)), pi / 4, 1e-14);
  EXPECT_NEAR(value_at(curve, 0.0)[3], 1.0, 1e-15);
  const Curve zero = rotation_curve({0, 1}, {{0, 0, 0, 0}, {0, 0, 0, 0}});
  EXPECT_EQ(value_at(zero, 0.5), (std::vector<double>{0, 0, 0, 1}));
}

TEST(Curve, ManyTimesAreTheSameAsOneByOne) {
  std::mt19937 random(7);
  const auto next = [&](double scale) { return scale * (static_cast<double>(random()) / 4294967296.0); };
  for (const auto mode : {Interpolation::linear, Interpolation::step, Interpolation::cubic_spline}) {
    Curve curve{0, Path::rotation, mode, 4, {}, {}};
    float t = 0.25f;
    for (int key = 0; key < 40; ++key, t += static_cast<float>(0.01 + next(0.1))) curve.times.push_back(t);
    const std::size_t rows = mode == Interpolation::cubic_spline ? 3 : 1;
    for (std::size_t i = 0; i < curve.times.size() * rows * 4; ++i) {
      curve.values.push_back(static_cast<float>(next(2) - 1));
    }
    std::vector<double> times;
    for (int i = 0; i < 200; ++i) times.push_back(i < 150 ? i * 0.02 : next(3.0));  // increasing, then anyhow
    std::vector<double> all(times.size() * 4);
    evaluate(curve, times, all);
    for (std::size_t i = 0; i < times.size(); ++i) {
      const std::vector<double> one = value_at(curve, times[i]);
      EXPECT_TRUE(std::equal(one.begin(), one.end(), all.begin() + static_cast<std::ptrdiff_t>(4 * i))) << times[i];
      EXPECT_NEAR(std::hypot(std::hypot(one[0], one[1]), std::hypot(one[2], one[3])), 1.0, 1e-15);
    }
  }
}

TEST(Curve, MalformedCurvesAreRefused) {
  std::array<double, 4> out{};
  EXPECT_THROW(evaluate(Curve{}, 0, out), Error);
  EXPECT_THROW(evaluate(Curve{0, Path::translation, Interpolation::linear, 3, {0, 1}, {1, 2, 3}}, 0, out), Error);
  EXPECT_THROW(evaluate(Curve{0, Path::translation, Interpolation::cubic_spline, 3, {0}, {1, 2, 3}}, 0, out), Error);
  EXPECT_THROW(evaluate(Curve{0, Path::rotation, Interpolation::linear, 3, {0}, {1, 2, 3}}, 0, out), Error);
}

}  // namespace
}  // namespace nmc::motion
