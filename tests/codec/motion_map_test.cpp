// The linear map from parameters to points, and its transpose, against finite differences and each other.
#include "codec/motion_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "character.h"
#include "codec/clip_layout.h"
#include "codec/effects.h"

namespace nmc::codec {
namespace {

class MotionMapOf : public testing::TestWithParam<bool> {};

TEST_P(MotionMapOf, ErrorsAreTheDifferenceQuotientOfPositions) {
  const Character character(37, GetParam());
  MotionMap map = character.map();
  map.linearise(character.layout.values);
  constexpr double h = 1e-3;
  const Rows delta = random_rows(static_cast<Eigen::Index>(character.layout.moving.size()), 37, 1);
  Eigen::MatrixXd ahead = character.layout.values, behind = ahead;
  for (Eigen::Index i = 0; i < delta.rows(); ++i) {
    const Eigen::Index p = character.layout.moving[static_cast<std::size_t>(i)];
    ahead.row(p) += h * delta.row(i).cast<double>().matrix();
    behind.row(p) -= h * delta.row(i).cast<double>().matrix();
  }
  const Rows quotient = (map.positions(ahead) - map.positions(behind)) / static_cast<float>(2 * h);
  Rows error;
  map.errors(delta, error);
  // Positions of about 2 in float divided by 2 h: 1e-4; the third-order term is smaller.
  EXPECT_LT((error - quotient).abs().maxCoeff(), 1e-3f);
  EXPECT_GT(error.abs().maxCoeff(), 0.5f);
}

TEST_P(MotionMapOf, GradientIsTheTranspose) {
  const Character character(21, GetParam());
  MotionMap map = character.map();
  map.linearise(character.layout.values);
  const Rows delta = random_rows(static_cast<Eigen::Index>(character.layout.moving.size()), 21, 2);
  const Rows weight = random_rows(map.error_rows(), 21, 3);
  Rows error, gradient;
  map.errors(delta, error);
  map.gradient(weight, gradient);
  const double left = (error * weight).cast<double>().sum(), right = (delta * gradient).cast<double>().sum();
  EXPECT_NEAR(left, right, 1e-4 * (1 + std::abs(left)));
}

TEST_P(MotionMapOf, APartOfTheSamplesGivesTheSameAsAll) {
  const Character character(50, GetParam());
  MotionMap map = character.map();
  map.linearise(character.layout.values);
  const Rows delta = random_rows(static_cast<Eigen::Index>(character.layout.moving.size()), 50, 4);
  Rows all, part;
  map.errors(delta, all);
  map.errors(delta.middleCols(13, 20), part, 13);
  EXPECT_EQ((all.middleCols(13, 20) - part).abs().maxCoeff(), 0.0f);
}

TEST_P(MotionMapOf, AnEffectIsTheErrorOfOneUnit) {
  const Character character(40, GetParam());
  MotionMap map = character.map();
  map.linearise(character.layout.values);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(character.layout.moving.size()); ++i) {
    Rows delta = Rows::Zero(static_cast<Eigen::Index>(character.layout.moving.size()), 40), error;
    delta.row(i).setOnes();
    map.errors(delta, error);
    const Effect effect = map.effect(i, BlockRange::of(20, 20));
    ASSERT_EQ(effect.blocks.first, 1);
    ASSERT_EQ(effect.blocks.count, 2);
    LaneRows spread = LaneRows::Zero(lanes, 3 * error.rows());
    for (Eigen::Index b = 0; b < 2; ++b)
      for (std::size_t k = 0; k < effect.points.size(); ++k)
        spread.middleCols((1 + b) * error.rows() + 3 * effect.points[k], 3) =
            effect.values.middleCols(effect.column(k, b), 3);
    LaneRows expected = in_blocks(error);
    expected.leftCols(error.rows()).setZero();
    EXPECT_LT((spread - expected).abs().maxCoeff(), 1e-6f) << "parameter " << i;
  }
}

TEST_P(MotionMapOf, DescendIsTheGradientOfTheWeightedSquares) {
  const Character character(35, GetParam());
  MotionMap map = character.map();
  map.linearise(character.layout.values);
  const Rows delta = 0.01f * random_rows(static_cast<Eigen::Index>(character.layout.moving.size()), 35, 5);
  const Rows offset = 0.001f * random_rows(map.error_rows(), 35, 6);
  Rows emphasis = Rows::Ones(map.point_count(), 35);
  emphasis.row(2).setConstant(3.0f);
  const LaneRows offset_blocks = in_blocks(offset), emphasis_blocks = in_blocks(emphasis);
  const double tolerance = 0.02;
  Rows error, expected, gradient, threaded;
  map.errors(delta, error);
  error += offset;
  for (const int power : {2, 4, 6}) {
    Rows weighted = error;
    for (Eigen::Index q = 0; q < map.point_count(); ++q) {
      const PerSample square =
          error.middleRows(3 * q, 3).square().colwise().sum() / static_cast<float>(tolerance * tolerance);
      const PerSample weight = power == 2   ? PerSample::Constant(35, 1.05f)
                               : power == 4 ? PerSample(square.min(100.0f) + 0.05f)
                                            : PerSample((square * square).min(100.0f) + 0.05f);
      for (Eigen::Index a = 0; a < 3; ++a)
        weighted.row(3 * q + a) *= weight * emphasis.row(q) * static_cast<float>(2 / (tolerance * tolerance));
    }
    map.gradient(weighted, expected);
    map.descend(delta, offset_blocks, {tolerance, power, &emphasis_blocks}, nullptr, 1, gradient);
    map.descend(delta, offset_blocks, {tolerance, power, &emphasis_blocks}, nullptr, 8, threaded);
    EXPECT_LT((gradient - expected).abs().maxCoeff(), 1e-4f * expected.abs().maxCoeff()) << "power " << power;
    EXPECT_EQ((gradient - threaded).abs().maxCoeff(), 0.0f) << "power " << power;
  }
}

TEST_P(MotionMapOf, FocusHasAllPointsNearTheBoundAndAFourthOfTheOthers) {
  const Character character(35, GetParam());
  MotionMap map = character.map();
  map.linearise(character.layout.values);
  const Rows delta = 0.01f * random_rows(static_cast<Eigen::Index>(character.layout.moving.size()), 35, 7);
  const LaneRows offset = in_blocks(Rows::Zero(map.error_rows(), 35));
  Rows error;
  map.errors(delta, error);
  const double tolerance = 2 * largest_distance(error, map.point_count()) * 0.6;
  const Focus focus = map.focus(delta, offset, tolerance, 2);
  ASSERT_EQ(focus.blocks.size(), 3u);
  for (std::size_t b = 0; b < focus.blocks.size(); ++b) {
    const Eigen::Index first = static_cast<Eigen::Index>(b) * lanes, count = std::min<Eigen::Index>(lanes, 35 - first);
    Eigen::Index near = 0, stands_for = 0;
    for (Eigen::Index q = 0; q < map.point_count(); ++q)
      near += error.middleRows(3 * q, 3).middleCols(first, count).square().colwise().sum().maxCoeff() >
              static_cast<float>(0.25 * tolerance * tolerance);
    for (const Focus::Seen& seen : focus.blocks[b]) {
      const double most = std::sqrt(static_cast<double>(
          error.middleRows(3 * seen.point, 3).middleCols(first, count).square().colwise().sum().maxCoeff()));
      EXPECT_EQ(most > tolerance / 2, seen.count == 1) << "point " << seen.point;
      near -= seen.count == 1;
      stands_for += static_cast<Eigen::Index>(seen.count);
    }
    EXPECT_EQ(near, 0);
    EXPECT_GE(stands_for, map.point_count());
    EXPECT_LT(stands_for, map.point_count() + 4);
  }
  Rows all, looked_at;
  const Focus everything = map.focus(delta, offset, 1e-9, 1);
  map.descend(delta, offset, {tolerance, 6, nullptr}, nullptr, 1, all);
  map.descend(delta, offset, {tolerance, 6, nullptr}, &everything, 1, looked_at);
  EXPECT_EQ((all - looked_at).abs().maxCoeff(), 0.0f);
}

TEST_P(MotionMapOf, AddingAnEffectAddsTheErrorOfItsShares) {
  const Character character(40, GetParam());
  MotionMap map = character.map();
  map.linearise(character.layout.values);
  const Rows shares = random_rows(1, 40, 11);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(character.layout.moving.size()); ++i) {
    Rows delta = Rows::Zero(static_cast<Eigen::Index>(character.layout.moving.size()), 40), expected;
    delta.row(i) = shares.row(0);
    map.errors(delta, expected);
    LaneRows error = LaneRows::Zero(lanes, 3 * map.error_rows());
    add_effect(map, map.effect(i, {0, 3}), in_blocks(shares), error);
    EXPECT_LT((error - in_blocks(expected)).abs().maxCoeff(), 1e-6f) << "parameter " << i;
  }
}

TEST_P(MotionMapOf, PointsAreEndangeredWhereTheirErrorCouldGetAboveTheLimit) {
  const Character character(40, GetParam());
  MotionMap map = character.map();
  map.linearise(character.layout.values);
  const LaneRows error = in_blocks(0.02f * random_rows(map.error_rows(), 40, 8));
  const float most = 0.01f, limit = 0.03f;
  std::size_t safe = 0, parts = 0;
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(character.layout.moving.size()); ++i) {
    const Effect effect = map.effect(i, {0, 3});
    const std::vector<Parabola> found = endangered(map, effect, most, error, limit);
    auto next = found.begin();
    for (Eigen::Index b = 0; b < 3; ++b)
      for (std::size_t k = 0; k < effect.points.size(); ++k) {
        const auto squares = [&](float share) {
          LaneRows moved = error.middleCols(b * map.error_rows() + map.first_row(effect.points[k]), 3);
          moved += share * effect.values.middleCols(effect.column(k, b), 3);
          return Lanes(moved.square().rowwise().sum() / (limit * limit));
        };
        if (std::max(squares(-most).maxCoeff(), squares(most).maxCoeff()) <= 1) {
          ++safe;
          continue;
        }
        ASSERT_NE(next, found.end());
        for (const float share : {-most, 0.0f, 0.5f * most, most})
          EXPECT_LT((next->at(Lanes::Constant(share)) - squares(share)).abs().maxCoeff(), 1e-4f);
        ++parts;
        ++next;
      }
    EXPECT_EQ(next, found.end());
  }
  EXPECT_GT(safe, 0u);
  EXPECT_GT(parts, 0u);
}

INSTANTIATE_TEST_SUITE_P(Kinds, MotionMapOf, testing::Bool(),
                         [](const auto& tested) { return tested.param ? "Stretching" : "Rigid"; });

TEST(ClipLayout, HoldsWhatStandsStillAsMovingWhereTheFrameAsksForIt) {
  const motion::Clip clip{"still",
                          {0, 1, 2},
                          {{0, Path::translation, 3, {1, 2, 3}},
                           {0, Path::rotation, 4, {0.5f, 0.5f, 0.5f, 0.5f}},
                           {1, Path::rotation, 4, {0.6f, 0, 0, 0.8f}}}};
  const Character two(3);
  SetFrame frame = mean_frame(two.skeleton, {&clip});
  ASSERT_EQ(layout_clip(clip, frame).moving.size(), 0u);
  frame.least_states = {State::moving, State::quaternion, State::fixed};
  const ClipLayout layout = layout_clip(clip, frame);
  EXPECT_EQ(layout.states, frame.least_states);
  EXPECT_EQ(layout.moving.size(), 7u);
  const motion::Clip back = clip_of_parameters(clip, frame, layout, layout.values);
  ASSERT_EQ(back.tracks.size(), 3u);
  for (std::size_t t = 0; t < 2; ++t) {
    const std::vector<float>&still = clip.tracks[t].values, &made = back.tracks[t].values;
    ASSERT_EQ(made.size(), 3 * still.size());
    for (std::size_t i = 0; i < made.size(); ++i) EXPECT_NEAR(made[i], still[i % still.size()], 1e-6);
  }
  EXPECT_TRUE(back.tracks[2].constant());
}

}  // namespace
}  // namespace nmc::codec
