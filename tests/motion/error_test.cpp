// The error report against closed forms.
#include "motion/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace nmc::motion {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// A chain of `count` joints, each `length` along x from its parent.
Skeleton chain(int count, double length = 1.0) {
  Skeleton s;
  for (int i = 0; i < count; ++i) {
    s.names.push_back("joint " + std::to_string(i));
    s.parent.push_back(i - 1);
    s.order.push_back(i);
    Transform t;
    if (i > 0) t.translation = {length, 0, 0};
    s.rest.push_back(t);
    s.rest_matrix.push_back(to_matrix(t));
    s.rest_weights.emplace_back();
    s.joints.push_back(i);
  }
  return s;
}

void add_point(Points& points, std::vector<Influence> influences) {
  points.add(influences.data(), influences.data() + influences.size());
}

Points origins(const Skeleton& s) {
  Points points;
  for (const int joint : s.joints) add_point(points, {{joint, {0, 0, 0}, 1.0}});
  return points;
}

/// A rotation curve about z through the given angles.
Curve turning(int node, const std::vector<float>& times, const std::vector<double>& radians) {
  Curve curve{node, Path::rotation, Interpolation::linear, 4, times, {}};
  for (const double a : radians) {
    curve.values.insert(curve.values.end(),
                        {0, 0, static_cast<float>(std::sin(a / 2)), static_cast<float>(std::cos(a / 2))});
  }
  return curve;
}

Curve moving(int node, const std::vector<float>& times, const std::vector<float>& x) {
  Curve curve{node, Path::translation, Interpolation::linear, 3, times, {}};
  for (const float value : x) curve.values.insert(curve.values.end(), {value, 0, 0});
  return curve;
}

Animation only(Curve curve) { return {"", {std::move(curve)}}; }

TEST(CharacterSize, IsTheLargestSideOfTheJointsBox) {
  EXPECT_DOUBLE_EQ(character_size(chain(4, 0.5), {}), 1.5);
  EXPECT_EQ(character_size(chain(1), {}), 1.0);
  EXPECT_EQ(character_size({}, {}), 1.0);
}

TEST(CharacterSize, OfPointsWhereThereAreNoJoints) {
  Skeleton s = chain(2);
  s.joints.clear();
  Points points;
  add_point(points, {{1, {0, 4, 0}, 1.0}});
  add_point(points, {{0, {0, -1, 0}, 0.5}, {1, {0, -1, 0}, 0.5}});
  EXPECT_DOUBLE_EQ(character_size(s, points), 5.0);
}

TEST(MeasureError, NothingDiffersIsZero) {
  const Skeleton s = chain(3);
  const Animation a = only(turning(1, {0, 1}, {0, 1}));
  const ErrorReport r = measure_error(s, origins(s), a, a);
  EXPECT_EQ(r.max, 0);
  EXPECT_EQ(r.mean, 0);
  EXPECT_EQ(r.percentile_99, 0);
  EXPECT_EQ(r.max_joint, 0);
  EXPECT_EQ(r.max_rotation_degrees, 0);
  EXPECT_EQ(r.jitter, 0);
  EXPECT_FALSE(r.loop_seam);
  EXPECT_EQ(r.max_node, -1);
}

TEST(MeasureError, AWrongAngleMovesThePointByItsChord) {
  const Skeleton s = chain(1);
  Points points;
  add_point(points, {{0, {2.5, 0, 0}, 1.0}});
  for (const double angle : {1e-4, 0.1, 1.0, 3.0}) {
    const ErrorReport r = measure_error(s, points, only(turning(0, {0, 1, 2}, {0.1, 0.2, 0.3})),
                                        only(turning(0, {0, 1, 2}, {0.1, 0.2 + angle, 0.3})));
    EXPECT_NEAR(r.max, 2 * 2.5 * std::sin(angle / 2), 1e-6);
    EXPECT_NEAR(r.max_rotation_degrees, angle * 180 / pi, 2e-5);
    EXPECT_EQ(r.max_seconds, 1.0);
    EXPECT_EQ(r.max_node, 0);
    EXPECT_EQ(r.max_joint, 0.0);  // the origin stays
  }
}

TEST(MeasureError, AChainAddsUpBelowTheWrongJoint) {
  const Skeleton s = chain(5);
  const ErrorReport r =
      measure_error(s, origins(s), only(turning(1, {0, 1}, {0, 0})), only(turning(1, {0, 1}, {0.2, 0.2})));
  const double chord = 2 * std::sin(0.1);
  EXPECT_NEAR(r.max, 3 * chord, 1e-6);
  EXPECT_NEAR(r.max_joint, 3 * chord, 1e-6);
  EXPECT_EQ(r.max_node, 4);
  EXPECT_NEAR(r.mean, (0 + 0 + 1 + 2 + 3) / 5.0 * chord, 1e-6);
  EXPECT_NEAR(r.percentile_99, 3 * chord, 1e-6);
  EXPECT_NEAR(r.jitter, 0, 1e-12);
  EXPECT_NEAR(r.loop_seam.value(), 0, 1e-12);
}

TEST(MeasureError, TranslationAndScale) {
  const Skeleton s = chain(2);
  Points points;
  add_point(points, {{1, {0, 2, 0}, 1.0}});
  const Animation a{"", {moving(1, {0}, {1}), {0, Path::scale, Interpolation::linear, 3, {0}, {1, 1, 1}}}};
  Animation b = a;
  b.curves[0].values[0] = 1.5f;
  EXPECT_NEAR(measure_error(s, points, a, b).max, 0.5, 1e-12);
  b = a;
  b.curves[1].values = {1, 2, 1};
  EXPECT_NEAR(measure_error(s, points, a, b).max, 2.0, 1e-12);
}

TEST(MeasureError, ABlendedVertexMovesByItsShare) {
  const Skeleton s = chain(2);
  Points points;
  add_point(points, {{0, {1, 1, 0}, 0.75}, {1, {0, 1, 0}, 0.25}});
  const ErrorReport r = measure_error(s, points, only(moving(1, {0}, {1})), only(moving(1, {0}, {3})));
  EXPECT_NEAR(r.max, 0.25 * 2.0, 1e-12);
  EXPECT_EQ(r.max_node, 0);  // the node with the largest influence
}

TEST(MeasureError, MidpointsAreSeen) {
  // At the keys all is well; between them the decoded curve has a bump.
  const Skeleton s = chain(1);
  const Animation a = only(moving(0, {0, 1, 2}, {0, 0, 0})), b = only(moving(0, {0, 1, 1.5f, 2}, {0, 0, 0.25f, 0}));
  const ErrorReport r = measure_error(s, origins(s), a, b);
  EXPECT_NEAR(r.max, 0.25, 1e-12);
  EXPECT_EQ(r.max_seconds, 1.5);
  const ErrorProfile p = error_profile(s, origins(s), a, b);
  EXPECT_EQ(p.seconds, (std::vector<double>{0, 0.5, 1, 1.5, 2}));
  EXPECT_EQ(p.max_error, (std::vector<double>{0, 0, 0, 0.25, 0}));
  EXPECT_EQ(p.worst_point, (std::vector<int>{-1, -1, -1, 0, -1}));
}

TEST(MeasureError, AProfileIsRenewedWhereItIsStale) {
  const Skeleton s = chain(1);
  const Points points = origins(s);
  const ErrorMeter meter(s, points);
  const Animation still = only(moving(0, {0, 1, 2, 3}, {0, 0, 0, 0}));
  ErrorProfile p = meter.profile(still, only(moving(0, {0, 1, 2, 3}, {0.5f, 0, 0, 0})));
  EXPECT_EQ(p.max_error, (std::vector<double>{0.5, 0.25, 0, 0, 0, 0, 0}));
  const Animation other = only(moving(0, {0, 1, 2, 3}, {0, 0, 1, 1}));
  meter.renew(p, {false, false, false, true, true, true, false}, still, other);
  EXPECT_EQ(p.max_error, (std::vector<double>{0.5, 0.25, 0, 0.5, 1, 1, 0}));
  EXPECT_EQ(p.worst_point, (std::vector<int>{0, 0, -1, 0, 0, 0, -1}));
  EXPECT_EQ(p.seconds, (std::vector<double>{0, 0.5, 1, 1.5, 2, 2.5, 3}));
}

TEST(MeasureError, SlerpBetweenKeysIsCompared) {
  // The decoded animation goes the same way with one key in the middle where a straight line of numbers would not be.
  const Skeleton s = chain(2);
  const Animation a = only(turning(0, {0, 1}, {0, 2})), b = only(turning(0, {0, 0.25f, 1}, {0, 0.5, 2}));
  EXPECT_LT(measure_error(s, origins(s), a, b).max, 1e-6);
}

TEST(MeasureError, KeyTimesOfAllCurvesCount) {
  const Skeleton s = chain(2);
  Animation a{"", {moving(0, {0, 2}, {0, 0}), moving(1, {0.5f, 1.0f, 1.0000005f}, {1, 1, 1})}};
  EXPECT_EQ(error_profile(s, origins(s), a, a).seconds, (std::vector<double>{0, 0.25, 0.5, 0.75, 1, 1.5, 2}));
  EXPECT_EQ(error_profile(s, origins(s), {}, a).seconds, (std::vector<double>{0}));
  a.curves.push_back(moving(1, {0.5f, 1.0f, 1.0000005f}, {2, 2, 2}));
  EXPECT_EQ(error_profile(s, origins(s), a, a).seconds, (std::vector<double>{0, 0.25, 0.5, 0.75, 1, 1.5, 2}));
}

TEST(MeasureError, AMissingCurveMeansTheRestValue) {
  const Skeleton s = chain(2);
  EXPECT_NEAR(measure_error(s, origins(s), only(moving(1, {0}, {4})), {}).max, 3.0, 1e-12);
  EXPECT_NEAR(measure_error(s, origins(s), {}, only(moving(1, {0}, {4}))).max, 3.0, 1e-12);
}

TEST(MeasureError, TheProfileAgreesWithTheReport) {
  const Skeleton s = chain(6);
  Animation a, b;
  std::vector<float> times;
  for (int i = 0; i < 40; ++i) times.push_back(static_cast<float>(i) / 30);
  for (int node = 0; node < 6; ++node) {
    std::vector<double> angles, wrong;
    for (int i = 0; i < 40; ++i) {
      angles.push_back(std::sin(0.3 * i + node));
      wrong.push_back(angles.back() + 0.01 * std::sin(1.7 * i * node + 1));
    }
    a.curves.push_back(turning(node, times, angles));
    b.curves.push_back(turning(node, times, wrong));
  }
  Points points = origins(s);
  for (int i = 0; i < 500; ++i) add_point(points, {{i % 6, {0.01 * i, std::sin(i), 0}, 1.0}});
  const ErrorReport r = measure_error(s, points, a, b);
  const ErrorProfile p = error_profile(s, points, a, b);
  const auto top = std::max_element(p.max_error.begin(), p.max_error.end());
  ASSERT_EQ(p.seconds.size(), 79u);
  EXPECT_DOUBLE_EQ(*top, r.max);
  EXPECT_EQ(p.seconds[static_cast<std::size_t>(top - p.max_error.begin())], r.max_seconds);
  EXPECT_GT(r.max, r.percentile_99);
  EXPECT_GT(r.percentile_99, r.mean);
  EXPECT_GE(r.max, r.max_joint);
}

TEST(MeasureError, JitterOfAnAlternatingError) {
  // The error of the only point is +d, -d, +d, ...: second differences are 4 d.
  const Skeleton s = chain(1);
  std::vector<float> times, still(20, 0.0f), shaking;
  for (int i = 0; i < 20; ++i) {
    times.push_back(static_cast<float>(i) / 32);
    shaking.push_back(i % 2 == 0 ? 0.125f : -0.125f);
  }
  const ErrorReport r = measure_error(s, origins(s), only(moving(0, times, still)), only(moving(0, times, shaking)));
  EXPECT_NEAR(r.jitter, 4 * 0.125, 1e-12);
  EXPECT_NEAR(r.max, 0.125, 1e-12);
  EXPECT_NEAR(r.mean, 0.125 * 20 / 39, 1e-7);  // midpoints cross zero
}

TEST(MeasureError, ASteadyOrEvenlyGrowingErrorDoesNotJitter) {
  const Skeleton s = chain(1);
  const std::vector<float> times{0, 1, 2, 3};
  const ErrorReport r =
      measure_error(s, origins(s), only(moving(0, times, {0, 0, 0, 0})), only(moving(0, times, {1, 2, 3, 4})));
  EXPECT_NEAR(r.jitter, 0, 1e-12);
  EXPECT_NEAR(r.loop_seam.value(), 3, 1e-12);
}

TEST(MeasureError, LoopSeamIsTheChangeOfTheErrorVector) {
  const Skeleton s = chain(1);
  const std::vector<float> times{0, 1, 2};
  const ErrorReport r =
      measure_error(s, origins(s), only(moving(0, times, {5, 6, 5})), only(moving(0, times, {5.5f, 6, 4.5f})));
  EXPECT_NEAR(r.max, 0.5, 1e-12);
  EXPECT_NEAR(r.loop_seam.value(), 1.0, 1e-12);
}

TEST(MeasureError, OnlyALoopHasASeam) {
  // The size is 1, so that the last pose may be 0.01 away from the first.
  const Skeleton s = chain(1);
  const std::vector<float> times{0, 1, 2};
  const auto seam = [&](float last) {
    const Animation a = only(moving(0, times, {0, 1, last}));
    return measure_error(s, origins(s), a, a).loop_seam;
  };
  EXPECT_EQ(seam(0), 0);
  EXPECT_EQ(seam(0.0099f), 0);
  EXPECT_FALSE(seam(0.0101f));
  const Animation pose = only(moving(0, {0}, {0}));
  EXPECT_FALSE(measure_error(s, origins(s), pose, pose).loop_seam);
}

TEST(MeasureError, AMorphThatStaysIsNoLoop) {
  Skeleton s = chain(1);
  s.rest_weights[0] = {0};
  Points points = origins(s);
  points.morphs = {{0, 0, 0.5}};
  const Animation there{"", {{0, Path::weights, Interpolation::linear, 1, {0, 1, 2}, {0, 1, 1}}}};
  const Animation back{"", {{0, Path::weights, Interpolation::linear, 1, {0, 1, 2}, {0, 1, 0}}}};
  EXPECT_FALSE(measure_error(s, points, there, there).loop_seam);
  EXPECT_TRUE(measure_error(s, points, back, back).loop_seam);
}

TEST(MeasureError, MorphWeightsReachTheFarthestVertex) {
  Skeleton s = chain(2);
  s.rest_weights[1] = {0, 0};
  Points points = origins(s);
  points.morphs = {{1, 0, 0.5}, {1, 1, 0.25}};
  const Curve scale{0, Path::scale, Interpolation::linear, 3, {0}, {1, 3, 1}};
  const Animation a{"", {{1, Path::weights, Interpolation::linear, 2, {0, 1}, {0, 0, 1, 1}}, scale}};
  Animation b = a;
  b.curves[0].values = {0, 0, 0.9f, 1.2f};
  const ErrorReport r = measure_error(s, points, a, b);
  EXPECT_NEAR(r.max, (0.1 * 0.5 + 0.2 * 0.25) * 3, 1e-6);
  EXPECT_NEAR(r.max_morph_weight, 0.2, 1e-6);
  EXPECT_EQ(r.max_seconds, 1.0);
  EXPECT_EQ(r.max_node, 1);
  EXPECT_EQ(error_profile(s, points, a, b).worst_point.back(), -1);
  EXPECT_NEAR(measure_error(s, points, a, only(scale)).max_morph_weight, 1.0, 1e-12);
}

TEST(MeasureError, NotANumberNeverPasses) {
  const Skeleton s = chain(2);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Animation good = only(moving(0, {0, 1, 2}, {0, 0, 0})), bad = only(moving(0, {0, 1, 2}, {0, nan, 0}));
  for (const ErrorReport& r : {measure_error(s, origins(s), good, bad), measure_error(s, origins(s), bad, good),
                               measure_error(s, origins(s), bad, bad)}) {
    EXPECT_EQ(r.max, infinity);
    EXPECT_EQ(r.max_joint, infinity);
    EXPECT_EQ(r.mean, infinity);
    EXPECT_EQ(r.jitter, infinity);
    EXPECT_EQ(r.max_seconds, 0.5);
  }
  Animation spin = only(turning(0, {0, 1}, {0, 1}));
  spin.curves[0].values[6] = nan;
  EXPECT_EQ(measure_error(s, origins(s), only(turning(0, {0, 1}, {0, 1})), spin).max_rotation_degrees, infinity);
  const Animation weights = only({0, Path::weights, Interpolation::linear, 1, {0, 1}, {0, nan}});
  EXPECT_EQ(measure_error(s, origins(s), weights, weights).max_morph_weight, infinity);
}

TEST(MeasureError, ManyPointsAreSampledForTheMeanButAllForTheMaximum) {
  const Skeleton s = chain(1);
  Points points;
  for (int i = 0; i < 5000; ++i) add_point(points, {{0, {i == 4321 ? 100.0 : 1.0, 0, 0}, 1.0}});
  const double chord = 2 * std::sin(0.05);
  const ErrorReport r = measure_error(s, points, only(turning(0, {0}, {0})), only(turning(0, {0}, {0.1})));
  EXPECT_NEAR(r.max, 100 * chord, 1e-5);
  EXPECT_NEAR(r.mean, chord, 1e-6);
}

TEST(ErrorMeter, IsReusable) {
  const Skeleton s = chain(3);
  const Points points = origins(s);
  const ErrorMeter meter(s, points);
  const Animation a = only(turning(0, {0, 1}, {0, 1}));
  for (const double wrong : {0.5, 0.25, 0.125}) {
    const Animation b = only(turning(0, {0, 1}, {0, 1 + wrong}));
    EXPECT_NEAR(meter.report(a, b).max, 2 * 2 * std::sin(wrong / 2), 1e-6);
  }
}

}  // namespace
}  // namespace nmc::motion
