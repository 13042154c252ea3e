// Local and world transforms of node trees.
#include "motion/skeleton.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"
#include "motion/pose.h"

namespace nmc::motion {
namespace {

constexpr double pi = std::numbers::pi;

double largest_difference(const glm::dmat4& a, const glm::dmat4& b) {
  double largest = 0;
  for (int c = 0; c < 4; ++c) {
    for (int r = 0; r < 4; ++r) largest = std::max(largest, std::abs(a[c][r] - b[c][r]));
  }
  return largest;
}

/// Three nodes in file order leaf, root, middle; each one unit along x from its parent.
Skeleton three_nodes() {
  Skeleton s;
  s.names = {"leaf", "root", "middle"};
  s.parent = {2, -1, 1};
  s.order = {1, 2, 0};
  Transform one;
  one.translation = {1, 0, 0};
  s.rest = {one, Transform{}, one};
  for (const Transform& t : s.rest) s.rest_matrix.push_back(to_matrix(t));
  s.rest_weights.resize(3);
  return s;
}

TEST(Skeleton, MatrixScalesThenRotatesThenMoves) {
  const Transform t{{1, 2, 3}, glm::dquat(std::sqrt(0.5), 0, 0, std::sqrt(0.5)), {2, 3, 4}};  // a right angle about z
  const glm::dvec4 p = to_matrix(t) * glm::dvec4(1, 1, 1, 1);
  EXPECT_LT(glm::length(p - glm::dvec4(1 - 3, 2 + 2, 3 + 4, 1)), 1e-14);
}

TEST(Skeleton, DecompositionIsTheInverseOfComposition) {
  std::mt19937 engine(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 500; ++i) {
    const auto next = [&] { return normal(engine); };
    Transform t{{next(), next(), next()},
                glm::normalize(glm::dquat(next(), next(), next(), next())),
                {std::exp(next()), std::exp(next()), std::exp(next())}};
    if (i % 2 == 1) t.scale.x = -t.scale.x;
    const Transform back = decompose(to_matrix(t));
    EXPECT_LT(glm::length(back.translation - t.translation), 1e-15);
    EXPECT_LT(glm::length(back.scale - t.scale), 1e-13);
    EXPECT_NEAR(std::abs(glm::dot(back.rotation, t.rotation)), 1.0, 1e-13);
    EXPECT_LT(largest_difference(to_matrix(back), to_matrix(t)), 1e-12);
  }
}

TEST(Skeleton, DecompositionOfAMirrorFlipsX) {
  glm::dmat4 mirror(1.0);
  mirror[1][1] = -2.0;
  const Transform t = decompose(mirror);
  EXPECT_EQ(t.scale, glm::dvec3(-1, 2, 1));
  EXPECT_LT(largest_difference(to_matrix(t), mirror), 1e-15);
}

TEST(Skeleton, DecompositionOfAFlatMatrixHasZeroScale) {
  glm::dmat4 flat(1.0);
  flat[2][2] = 0.0;
  const Transform t = decompose(flat);
  EXPECT_EQ(t.scale, glm::dvec3(1, 1, 0));
  EXPECT_LT(largest_difference(to_matrix(t), flat), 1e-15);
}

TEST(Skeleton, WorldMatricesFollowTheParents) {
  const Skeleton s = three_nodes();
  std::vector<glm::dmat4> local = s.rest_matrix, world(3);
  Transform turned;
  turned.rotation = glm::dquat(std::cos(pi / 4), 0, 0, std::sin(pi / 4));
  local[1] = to_matrix(turned);
  world_matrices(s, local, world);
  EXPECT_LT(glm::length(world[2][3] - glm::dvec4(0, 1, 0, 1)), 1e-15);
  EXPECT_LT(glm::length(world[0][3] - glm::dvec4(0, 2, 0, 1)), 1e-15);
}

TEST(Pose, CurvesReplaceRestValuesAndTheRestStays) {
  Skeleton s = three_nodes();
  s.rest[2].scale = {2, 2, 2};
  s.rest_matrix[2] = to_matrix(s.rest[2]);
  const Animation animation{"", {{2, Path::translation, Interpolation::linear, 3, {0, 1}, {0, 0, 0, 0, 4, 0}}}};
  const std::vector<glm::dmat4> world = world_pose(s, animation, 0.5);
  EXPECT_LT(glm::length(world[2][3] - glm::dvec4(0, 2, 0, 1)), 1e-15);
  EXPECT_LT(glm::length(world[0][3] - glm::dvec4(2, 2, 0, 1)), 1e-15);

  PoseReader pose(s, animation);
  EXPECT_EQ(std::vector<int>(pose.moving().begin(), pose.moving().end()), (std::vector<int>{2, 0}));
  EXPECT_TRUE(pose.has_curve(2, Path::translation));
  EXPECT_FALSE(pose.has_curve(2, Path::rotation));
}

TEST(Pose, AMatrixWithoutDecompositionStaysUntilANodeIsAnimated) {
  Skeleton s = three_nodes();
  s.rest_matrix[2][1][0] = 0.5;  // shear
  s.rest[2] = decompose(s.rest_matrix[2]);
  EXPECT_EQ(world_pose(s, {}, 0)[2], s.rest_matrix[2]);
  const Animation animation{"", {{2, Path::scale, Interpolation::linear, 3, {0}, {1, 1, 1}}}};
  Transform expected = s.rest[2];
  expected.scale = glm::dvec3(1.0);
  EXPECT_LT(largest_difference(world_pose(s, animation, 0)[2], to_matrix(expected)), 1e-15);
}

TEST(Pose, MorphWeightsComeFromTheCurveOrFromRest) {
  Skeleton s = three_nodes();
  s.rest_weights[0] = {0.25, 0.5};
  s.rest_weights[1] = {0.75};
  const Animation animation{"", {{0, Path::weights, Interpolation::linear, 2, {0, 1}, {0, 0, 1, 2}}}};
  PoseReader pose(s, animation);
  pose.read(0.5);
  EXPECT_EQ(std::vector<double>(pose.weights(0).begin(), pose.weights(0).end()), (std::vector<double>{0.5, 1.0}));
  EXPECT_EQ(pose.weights(1)[0], 0.75);
  EXPECT_TRUE(pose.moving().empty());
}

TEST(Pose, CurvesThatDoNotFitAreRefused) {
  const Skeleton s = three_nodes();
  const auto bind = [&](Curve curve) { PoseReader(s, Animation{"", {std::move(curve)}}); };
  EXPECT_THROW(bind({3, Path::scale, Interpolation::linear, 3, {0}, {1, 1, 1}}), Error);
  EXPECT_THROW(bind({-1, Path::scale, Interpolation::linear, 3, {0}, {1, 1, 1}}), Error);
  EXPECT_THROW(bind({0, Path::scale, Interpolation::linear, 2, {0}, {1, 1}}), Error);
  EXPECT_THROW(bind({0, Path::scale, Interpolation::linear, 3, {}, {}}), Error);
}

}  // namespace
}  // namespace nmc::motion
