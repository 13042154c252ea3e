// Rotations as vectors, quaternions and means, against closed forms.
#include "motion/pose_parameters.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <random>

#include "base/error.h"

namespace nmc::motion {
namespace {

constexpr double pi = std::numbers::pi;

class Random {
 public:
  double gauss() { return normal_(engine_); }
  glm::dquat rotation() { return glm::normalize(glm::dquat(gauss(), gauss(), gauss(), gauss())); }
  glm::dvec3 axis() { return glm::normalize(glm::dvec3(gauss(), gauss(), gauss())); }

 private:
  std::mt19937 engine_{12345};
  std::normal_distribution<double> normal_;
};

glm::dquat about(const glm::dvec3& axis, double radians) {
  return glm::dquat(std::cos(radians / 2), std::sin(radians / 2) * axis);
}

Track track_of(const std::vector<glm::dquat>& rows) {
  Track track{0, Path::rotation, 4, {}};
  for (const glm::dquat& q : rows) {
    for (const double x : {q.x, q.y, q.z, q.w}) track.values.push_back(static_cast<float>(x));
  }
  return track;
}

double chord(const glm::dquat& a, const glm::dquat& b) { return std::min(glm::length(a - b), glm::length(a + b)); }

void expect_same_rotations(const std::vector<float>& a, const std::vector<float>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); i += 4) {
    EXPECT_LT(chord(glm::dquat(a[i + 3], a[i], a[i + 1], a[i + 2]), glm::dquat(b[i + 3], b[i], b[i + 1], b[i + 2])),
              tolerance)
        << i / 4;
  }
}

TEST(RotationVector, IsAxisTimesAngle) {
  Random random;
  for (double angle : {1e-300, 1e-12, 1e-8, 5e-5, 1e-4, 1.9e-4, 2.1e-4, 1e-3, 0.1, 1.0, 3.0, 3.14}) {
    const glm::dvec3 axis = random.axis();
    EXPECT_LT(glm::length(rotation_vector(about(axis, angle)) - axis * angle), 4e-15 * angle) << angle;
    EXPECT_LT(glm::length(rotation_vector(-about(axis, angle)) - axis * angle), 4e-15 * angle) << angle;
    EXPECT_LT(glm::length(rotation_of_vector(axis * angle) - about(axis, angle)), 4e-16) << angle;
  }
  EXPECT_EQ(rotation_vector(glm::dquat(1, 0, 0, 0)), glm::dvec3(0));
  EXPECT_EQ(rotation_of_vector(glm::dvec3(0)), glm::dquat(1, 0, 0, 0));
  EXPECT_NEAR(glm::length(rotation_vector(glm::dquat(0, 0, 1, 0))), pi, 1e-15);
  EXPECT_LT(glm::length(rotation_vector(about({0, 0, 1}, pi + 0.1)) - glm::dvec3(0, 0, 0.1 - pi)), 1e-14);
}

TEST(RotationVector, VectorAndQuaternionAreInverse) {
  Random random;
  for (int i = 0; i < 2000; ++i) {
    const glm::dquat q = random.rotation();
    EXPECT_LT(chord(rotation_of_vector(rotation_vector(q)), q), 1e-14);
  }
}

TEST(MeanRotation, OfRotationsSpreadEvenlyAboutOne) {
  Random random;
  for (int trial = 0; trial < 20; ++trial) {
    const glm::dquat center = random.rotation();
    std::vector<glm::dquat> rows;
    for (int i = 0; i < 10; ++i) {
      const glm::dvec3 axis = random.axis();
      const double angle = i == 0 ? 1.3 : 0.13 * i;
      for (const double side : {-1.0, 1.0}) {  // in pairs, and half of them with the other sign
        const glm::dquat q = center * about(axis, side * angle);
        rows.push_back(side * q);
      }
    }
    const MeanRotation mean = mean_rotation(track_of(rows).values);
    EXPECT_LT(chord(mean.mean, center), 1e-6);
    EXPECT_NEAR(glm::length(mean.mean), 1.0, 1e-14);
    EXPECT_NEAR(mean.largest_angle_radians, 1.3, 1e-6);
  }
}

TEST(MeanRotation, OfTwoIsHalfway) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, -2, 3));
  const MeanRotation mean = mean_rotation(track_of({about(axis, 0.2), about(axis, 2.2)}).values);
  EXPECT_LT(chord(mean.mean, about(axis, 1.2)), 1e-7);
  EXPECT_NEAR(mean.largest_angle_radians, 1.0, 1e-6);
}

TEST(MeanRotation, OfOneIsItself) {
  Random random;
  for (int i = 0; i < 50; ++i) {
    const glm::dquat q = random.rotation();
    const MeanRotation mean = mean_rotation(track_of({q, -q, q}).values);
    EXPECT_LT(chord(mean.mean, q), 1e-7);
    EXPECT_LT(mean.largest_angle_radians, 1e-6);
  }
  EXPECT_EQ(mean_rotation({}).mean, glm::dquat(1, 0, 0, 0));
  EXPECT_EQ(mean_rotation({}).largest_angle_radians, 0.0);
}

TEST(Parameters, NumbersAreThemselves) {
  const Track track{0, Path::weights, 2, {1, 2, 3, 4}};
  const Block block{Form::vector, {}, 0, 2};
  const std::vector<double> parameters = to_parameters(track, block);
  EXPECT_EQ(parameters, (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(from_parameters(parameters, block, Path::weights), track.values);
}

TEST(Parameters, AxisAngleRoundTripOverRandomRotations) {
  Random random;
  std::vector<glm::dquat> rows;
  for (int i = 0; i < 3000; ++i) rows.push_back(random.rotation());
  const Track track = track_of(rows);
  const Block block{Form::axis_angle, random.rotation(), 0, 3};
  const std::vector<double> parameters = to_parameters(track, block);
  ASSERT_EQ(parameters.size(), rows.size() * 3);
  expect_same_rotations(from_parameters(parameters, block, Path::rotation), track.values, 1e-6);
}

TEST(Parameters, QuaternionRoundTripOverRandomRotations) {
  Random random;
  std::vector<glm::dquat> rows;
  for (int i = 0; i < 3000; ++i) rows.push_back(random.rotation());
  const Track track = track_of(rows);
  const Block block{Form::quaternion, random.rotation(), 0, 4};
  const std::vector<double> parameters = to_parameters(track, block);
  EXPECT_GE(parameters[0] * block.reference.x + parameters[1] * block.reference.y + parameters[2] * block.reference.z +
                parameters[3] * block.reference.w,
            0.0);
  for (std::size_t i = 4; i < parameters.size(); i += 4) {
    double dot = 0;
    for (std::size_t k = i; k < i + 4; ++k) dot += parameters[k] * parameters[k - 4];
    EXPECT_GE(dot, 0.0);
  }
  expect_same_rotations(from_parameters(parameters, block, Path::rotation), track.values, 1e-6);
}

TEST(Parameters, AxisAngleIsTakenRelativeToTheReference) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(2, 1, -1));
  const glm::dquat reference = about(glm::normalize(glm::dvec3(0, 3, 1)), 3.0);
  const Block block{Form::axis_angle, reference, 0, 3};
  const std::vector<double> v = to_parameters(track_of({reference * about(axis, 0.7)}), block);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(v[static_cast<std::size_t>(i)], 0.7 * axis[i], 1e-6);
}

TEST(Parameters, VectorsStayContinuousPastPi) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, 2));
  std::vector<glm::dquat> rows;
  for (int i = 0; i <= 400; ++i) rows.push_back(about(axis, -7.0 + 0.05 * i));  // from -7 to 13 radians: three turns
  const Block block{Form::axis_angle, {1, 0, 0, 0}, 0, 3};
  const std::vector<double> v = to_parameters(track_of(rows), block);
  const glm::dvec3 first(v[0], v[1], v[2]);
  EXPECT_NEAR(glm::dot(first, axis), 2 * pi - 7.0, 1e-6);  // the first is on the short arc
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const glm::dvec3 row(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    EXPECT_LT(glm::length(row - axis * (2 * pi - 7.0 + 0.05 * static_cast<double>(i))), 1e-4) << i;
  }
  expect_same_rotations(from_parameters(v, block, Path::rotation), track_of(rows).values, 1e-6);
}

TEST(Parameters, NearPiVectorsDoNotFlip) {
  // A joint that rests half a turn from its reference and trembles about it.
  std::vector<glm::dquat> rows;
  for (int i = 0; i < 200; ++i) rows.push_back(about({0, 1, 0}, pi + 0.02 * std::sin(0.7 * i)));
  const std::vector<double> v = to_parameters(track_of(rows), {Form::axis_angle, {1, 0, 0, 0}, 0, 3});
  for (std::size_t i = 3; i < v.size(); ++i) EXPECT_LT(std::abs(v[i] - v[i - 3]), 0.03) << i;
}

TEST(Parameters, QuaternionFormFollowsWholeTurns) {
  std::vector<glm::dquat> rows;
  for (int i = 0; i <= 72; ++i) {
    const glm::dquat q = about({0, 0, 1}, 2 * pi * i / 72.0 * 2);
    rows.push_back(i % 3 == 0 ? -q : q);  // signs as a careless exporter leaves them
  }
  const Block block{Form::quaternion, {1, 0, 0, 0}, 0, 4};
  const std::vector<double> p = to_parameters(track_of(rows), block);
  for (int i = 0; i <= 72; ++i) {
    const double half = 2 * pi * i / 72.0;
    EXPECT_NEAR(p[static_cast<std::size_t>(4 * i + 2)], std::sin(half), 1e-6);
    EXPECT_NEAR(p[static_cast<std::size_t>(4 * i + 3)], std::cos(half), 1e-6);
  }
}

TEST(Parameters, DecodedRotationsAreUnitAndSignContinuous) {
  const Block quaternion{Form::quaternion, {1, 0, 0, 0}, 0, 4};
  const std::vector<float> q =
      from_parameters(std::vector<double>{0, 0, 3, 4, 0, 0, -3, -4, 0, 0, 0, 0}, quaternion, Path::rotation);
  EXPECT_EQ(q, (std::vector<float>{0, 0, 0.6f, 0.8f, 0, 0, 0.6f, 0.8f, 0, 0, 0, 1}));
  const Block vector{Form::axis_angle, {1, 0, 0, 0}, 0, 3};
  const std::vector<float> v = from_parameters(std::vector<double>{0, 0, 1, 0, 0, 1 + 2 * pi}, vector, Path::rotation);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(v[i], v[i + 4], 1e-6);
}

TEST(Parameters, WhatDoesNotFitIsRefused) {
  const Track track = track_of({{1, 0, 0, 0}});
  EXPECT_THROW(to_parameters(track, {Form::vector, {}, 0, 4}), Error);
  EXPECT_THROW(to_parameters(track, {Form::axis_angle, {}, 0, 4}), Error);
  EXPECT_THROW(from_parameters(std::vector<double>{1, 2}, {Form::axis_angle, {}, 0, 3}, Path::rotation), Error);
  EXPECT_THROW(from_parameters(std::vector<double>{1, 2, 3}, {Form::axis_angle, {}, 0, 3}, Path::scale), Error);
}

}  // namespace
}  // namespace nmc::motion
