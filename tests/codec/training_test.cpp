// The encoder's parts on a made clip: the linear map against finite differences, levels against the curves they stand
// for, corrections and refinements against the positions that they promise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "codec/atoms.h"
#include "codec/clip_layout.h"
#include "codec/corrections.h"
#include "codec/effects.h"
#include "codec/features.h"
#include "codec/motion_map.h"
#include "codec/refinement.h"
#include "codec/sparse_training.h"
#include "motion/clip.h"

namespace nmc::codec {
namespace {

using PerSample = Eigen::Array<float, 1, Eigen::Dynamic>;

/// A chain of joints, a moving and stretching root, and points at and beyond the joints.
struct Character {
  motion::Skeleton skeleton;
  Points points;
  motion::Clip clip;
  SetFrame frame;
  ClipLayout layout;
  ParameterSteps steps;

  explicit Character(std::size_t samples, bool stretches = false) {
    constexpr int joints = 4;
    for (int i = 0; i < joints; ++i) {
      motion::Transform t;
      t.translation = {0.1, i > 0 ? 0.5 : 0.0, 0};
      skeleton.names.push_back("joint");
      skeleton.parent.push_back(i - 1);
      skeleton.order.push_back(i);
      skeleton.rest.push_back(t);
      skeleton.rest_matrix.push_back(motion::to_matrix(t));
      skeleton.rest_weights.emplace_back();
      skeleton.joints.push_back(i);
      const Influence origin{i, {}, 1}, tip{i, {0.2, 0.3, 0.1}, 1};
      points.add(&origin, &origin + 1);
      points.add(&tip, &tip + 1);
    }
    const Influence blend[2] = {{1, {0.1, 0, 0.2}, 0.4}, {2, {-0.1, 0.1, 0}, 0.6}};
    points.add(blend, blend + 2);
    for (std::size_t n = 0; n < samples; ++n) clip.times.push_back(static_cast<float>(n) / 30);
    add_track(0, Path::translation, 3);
    for (int i = 0; i < joints; ++i) add_track(i, Path::rotation, 4);
    if (stretches) add_track(1, Path::scale, 3);
    frame = mean_frame(skeleton, {&clip});
    layout = layout_clip(clip, frame);
    const auto count = static_cast<Eigen::Index>(layout.parameters.size());
    steps = {Eigen::VectorXd::Constant(count, 0.01), Eigen::VectorXd::Constant(count, 0.002)};
  }

  Eigen::Index samples() const { return layout.values.cols(); }
  MotionMap map() const { return {skeleton, frame, layout, points, layout.values}; }

 private:
  void add_track(int node, Path path, int width) {
    motion::Track track{node, path, width, {}};
    for (std::size_t n = 0; n < clip.times.size(); ++n) {
      const double t = static_cast<double>(n) / static_cast<double>(clip.times.size());
      for (int a = 0; a < width; ++a) {
        // One scale for all axes: below others the map is an approximation.
        const int wave_of = path == Path::scale ? 0 : a;
        const double wave = 0.3 * std::sin(6.28 * t * (1 + (node + wave_of) % 3) + node + wave_of);
        const bool usual = path == Path::scale || (path == Path::rotation && a == 3);
        track.values.push_back(static_cast<float>(wave + (usual ? 1.0 : 0.0)));
      }
      if (path == Path::rotation) normalise(track);
    }
    clip.tracks.push_back(track);
  }

  static void normalise(motion::Track& track) {
    float* q = track.values.data() + track.values.size() - 4;
    const float length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int a = 0; a < 4; ++a) q[a] /= length;
  }
};

Rows random_rows(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  Rows made(rows, columns);
  for (Eigen::Index i = 0; i < made.size(); ++i) made.data()[i] = static_cast<float>(random() % 2001) / 1000.0f - 1.0f;
  return made;
}

double largest_distance(const Rows& difference, Eigen::Index points) {
  double most = 0;
  for (Eigen::Index q = 0; q < points; ++q)
    most = std::max(
        most, std::sqrt(static_cast<double>(difference.middleRows(3 * q, 3).square().colwise().sum().maxCoeff())));
  return most;
}

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

struct Cut {
  Basis basis;
  std::size_t samples;
};

/// Every basis with even and odd lengths: an untrained transform with fine steps is the curve itself.
class Transform : public testing::TestWithParam<Cut> {};

TEST_P(Transform, WithFineStepsIsTheCurve) {
  const auto [basis, samples] = GetParam();
  const Character character(samples);
  MotionMap map = character.map();
  const auto whole = static_cast<std::uint32_t>(samples);
  SparseSettings settings{.basis = basis, .boundaries = {0, basis == Basis::cosine ? whole : whole - 1}};
  settings.step_exponent = 40;
  settings.iterations = 0;
  const LaneRows offset = in_blocks(Rows::Zero(map.error_rows(), character.samples()));
  const TrainedClip trained =
      train_sparse({.layout = &character.layout, .steps = &character.steps, .offset = {&offset, 1}}, map, settings);
  const Eigen::MatrixXd values = values_of_levels(trained.levels, character.steps, character.samples());
  // Anchors are rounded to 0.002; at both ends of a line, and the rest follows what is left.
  EXPECT_LT((values - character.layout.values).cwiseAbs().maxCoeff(), 0.0021);
}

TEST_P(Transform, WithFineStepsIsWhatANetworkLeavesOfTheCurve) {
  const auto [basis, samples] = GetParam();
  Character character(samples);
  MotionMap map = character.map();
  character.steps.given = random_rows(character.layout.values.rows(), character.samples(), 5).cast<double>().matrix();
  const auto whole = static_cast<std::uint32_t>(samples);
  SparseSettings settings{.basis = basis, .boundaries = {0, basis == Basis::cosine ? whole : whole - 1}};
  settings.step_exponent = 40;
  settings.iterations = 0;
  const LaneRows offset = in_blocks(Rows::Zero(map.error_rows(), character.samples()));
  const LevelClip levels =
      train_sparse({.layout = &character.layout, .steps = &character.steps, .offset = {&offset, 1}}, map, settings)
          .levels;
  const ParameterSteps alone{character.steps.slot, character.steps.anchor};
  const Eigen::MatrixXd rest = character.layout.values - character.steps.given;
  EXPECT_LT((values_of_levels(levels, alone, character.samples()) - rest).cwiseAbs().maxCoeff(), 0.0021);
  EXPECT_LT(
      (values_of_levels(levels, character.steps, character.samples()) - character.layout.values).cwiseAbs().maxCoeff(),
      0.0021);
}

INSTANTIATE_TEST_SUITE_P(Cuts, Transform,
                         testing::Values(Cut{Basis::cosine, 12}, Cut{Basis::cosine, 13}, Cut{Basis::periodic, 12},
                                         Cut{Basis::periodic, 13}, Cut{Basis::periodic, 20}, Cut{Basis::sine, 12},
                                         Cut{Basis::sine, 13}));

/// A trained clip of coarse steps, and where its points should be.
struct Trained {
  Character character{60};
  MotionMap map = character.map();
  Rows wanted = map.positions(character.layout.values);
  LevelClip levels;
  double tolerance = 0.01;

  Trained() {
    const LaneRows offset = in_blocks(Rows::Zero(map.error_rows(), 60));
    SparseSettings settings{.basis = Basis::cosine, .boundaries = {0, 60}};
    settings.iterations = 120;
    settings.rate = 0.6;
    settings.step_exponent = -6;
    levels =
        train_sparse(
            {.layout = &character.layout, .steps = &character.steps, .offset = {&offset, 1}, .tolerance = tolerance},
            map, settings)
            .levels;
  }

  Rows error(const LevelClip& clip) const {
    return map.positions(values_of_levels(clip, character.steps, 60)) - wanted;
  }
  double largest(const LevelClip& clip) const { return largest_distance(error(clip), map.point_count()); }
};

TEST(Training, BeatsTheTransformAtTheSameSteps) {
  Trained trained;
  const LaneRows offset = in_blocks(Rows::Zero(trained.map.error_rows(), 60));
  SparseSettings settings{.basis = Basis::cosine, .boundaries = {0, 60}};
  settings.step_exponent = -6;
  settings.iterations = 0;
  const LevelClip plain = train_sparse({.layout = &trained.character.layout,
                                        .steps = &trained.character.steps,
                                        .offset = {&offset, 1},
                                        .tolerance = trained.tolerance},
                                       trained.map, settings)
                              .levels;
  EXPECT_LT(trained.levels.windows[0].weights.size(), plain.windows[0].weights.size());
}

/// Of 300 samples one or two turns are wide windows, where most steps leave the fastest features alone; three are not.
class TrainingInTurns : public testing::TestWithParam<std::uint32_t> {};

TEST_P(TrainingInTurns, EndsNearTheOneThatLooksAtAllSamples) {
  const std::uint32_t samples = GetParam();
  const Character character(samples);
  MotionMap map = character.map();
  const Rows wanted = map.positions(character.layout.values);
  const Rows zero = Rows::Zero(map.error_rows(), samples);
  const auto trained = [&](Eigen::Index turns) {
    const std::vector<LaneRows> offset = in_turns(zero, turns);
    return train_sparse(
               {.layout = &character.layout, .steps = &character.steps, .offset = offset, .tolerance = 0.01}, map,
               {.basis = Basis::cosine, .boundaries = {0, samples}, .step_exponent = -4, .rate = 2, .iterations = 200})
        .levels;
  };
  const auto error = [&](const LevelClip& levels) {
    const Rows off = map.positions(values_of_levels(levels, character.steps, samples)) - wanted;
    return std::sqrt(static_cast<double>(off.square().mean()));
  };
  const LevelClip all = trained(1);
  for (const Eigen::Index turns : {2, 3}) {
    const LevelClip some = trained(turns);
    EXPECT_NEAR(error(some), error(all), 0.1 * error(all)) << turns;
    EXPECT_NEAR(static_cast<double>(some.windows[0].weights.size()), static_cast<double>(all.windows[0].weights.size()),
                0.1 * static_cast<double>(all.windows[0].weights.size()))
        << turns;
  }
}

INSTANTIATE_TEST_SUITE_P(Samples, TrainingInTurns, testing::Values(120, 300));

TEST(Training, KeepsQuaternionsFromShrinking) {
  // A joint that goes from one to another of four rotations, half a turn apart, every other sample.
  constexpr std::size_t samples = 96, stay = 2;
  Character character(samples);
  std::mt19937 random(7);
  motion::Track& track = character.clip.tracks[1];
  for (std::size_t n = 0; n < samples; n += stay) {
    const std::size_t axis = random() % 4;
    for (std::size_t k = n; k < n + stay; ++k)
      for (std::size_t a = 0; a < 4; ++a) track.values[4 * k + a] = a == axis ? 1.0f : 0.0f;
  }
  character.frame = mean_frame(character.skeleton, {&character.clip});
  character.layout = layout_clip(character.clip, character.frame);
  const LayoutBlock& turning = character.layout.blocks[1];
  ASSERT_EQ(turning.state, State::quaternion);
  const auto count = static_cast<Eigen::Index>(character.layout.parameters.size());
  character.steps = {Eigen::VectorXd::Constant(count, 0.05), Eigen::VectorXd::Constant(count, 0.002)};
  MotionMap map = character.map();
  const LaneRows offset = in_blocks(Rows::Zero(map.error_rows(), character.samples()));
  SparseSettings settings{.basis = Basis::cosine, .boundaries = {0, samples}};
  settings.iterations = 150;
  settings.rate = 1;
  // Points may move by as much as about a radian makes them: the rate is free to take what it can.
  const LevelClip levels =
      train_sparse({.layout = &character.layout, .steps = &character.steps, .offset = {&offset, 1}, .tolerance = 0.4},
                   map, settings)
          .levels;
  const Eigen::MatrixXd values = values_of_levels(levels, character.steps, character.samples());
  EXPECT_GT(values.middleRows(turning.block.first, 4).colwise().norm().minCoeff(), 0.7);
}

bool correct(LevelClip& clip, const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted,
             double bound, const SampleRow& strictness, std::size_t most_atoms, int threads = 1) {
  return Corrections(layout, steps, map, wanted, bound, threads).correct(clip, strictness, most_atoms);
}

TEST(Corrections, BringEverySampleWithinItsBound) {
  Trained trained;
  const double bound = 0.5 * trained.largest(trained.levels);
  PerSample strictness = PerSample::Ones(60);
  strictness.segment(20, 5).setConstant(4.0f);
  LevelClip corrected = trained.levels;
  ASSERT_TRUE(correct(corrected, trained.character.layout, trained.character.steps, trained.map, trained.wanted, bound,
                      strictness, 2000));
  EXPECT_FALSE(corrected.atoms.empty());
  EXPECT_LE(largest_distance(trained.error(corrected).rowwise() * strictness, trained.map.point_count()),
            bound * (1 + 1e-5));
}

TEST(Corrections, AddNothingWhereTheBoundHolds) {
  Trained trained;
  LevelClip corrected = trained.levels;
  ASSERT_TRUE(correct(corrected, trained.character.layout, trained.character.steps, trained.map, trained.wanted,
                      1.01 * trained.largest(trained.levels), PerSample::Ones(60), 10));
  EXPECT_TRUE(corrected.atoms.empty());
}

TEST(Corrections, SayWhenTheyMayNotGoOn) {
  Trained trained;
  LevelClip corrected = trained.levels;
  EXPECT_FALSE(correct(corrected, trained.character.layout, trained.character.steps, trained.map, trained.wanted,
                       0.1 * trained.largest(trained.levels), PerSample::Ones(60), 2));
}

/// A long clip that random atoms have put off everywhere.
struct LongClip {
  static constexpr Eigen::Index samples = 1200;
  Character character{samples};
  MotionMap map = character.map();
  Rows wanted = map.positions(character.layout.values);
  LevelClip levels;
  double bound = 0;

  LongClip() {
    const LaneRows offset = in_blocks(Rows::Zero(map.error_rows(), samples));
    levels = train_sparse({.layout = &character.layout, .steps = &character.steps, .offset = {&offset, 1}}, map,
                          {.basis = Basis::cosine, .boundaries = {0, samples}, .step_exponent = 20, .iterations = 0})
                 .levels;
    std::mt19937 random(3);
    for (std::uint32_t n = 0; n < samples; n += 3)
      levels.atoms.push_back({n, static_cast<int>(random() % character.layout.parameters.size()),
                              static_cast<int>(random() % 4), static_cast<std::int32_t>(random() % 41) - 20});
    tidy_atoms(levels.atoms);
    bound = 0.3 * largest(levels);
  }

  double largest(const LevelClip& of) const {
    return largest_distance(map.positions(values_of_levels(of, character.steps, samples)) - wanted, map.point_count());
  }

  std::vector<LevelAtom> corrected(LevelClip clip, int threads) {
    EXPECT_TRUE(
        correct(clip, character.layout, character.steps, map, wanted, bound, PerSample::Ones(samples), 5000, threads));
    EXPECT_LE(largest(clip), bound * (1 + 1e-5));
    return clip.atoms;
  }
};

bool same_atom(const LevelAtom& a, const LevelAtom& b) {
  return a.sample == b.sample && a.parameter == b.parameter && a.width == b.width && a.level == b.level;
}

TEST(Corrections, GoOnAsIfTheyBeganAnew) {
  LongClip clip;
  Corrections corrections(clip.character.layout, clip.character.steps, clip.map, clip.wanted, clip.bound);
  LevelClip again = clip.levels;
  PerSample strictness = PerSample::Ones(LongClip::samples);
  ASSERT_TRUE(corrections.correct(again, strictness, 5000));
  again.atoms.push_back({700, 5, 2, 300});
  tidy_atoms(again.atoms);
  strictness.segment(300, 6).setConstant(1.5f);
  LevelClip anew = again;
  ASSERT_TRUE(corrections.correct(again, strictness, 5000));
  MotionMap other_map = clip.character.map();
  ASSERT_TRUE(
      correct(anew, clip.character.layout, clip.character.steps, other_map, clip.wanted, clip.bound, strictness, 5000));
  ASSERT_EQ(again.atoms.size(), anew.atoms.size());
  EXPECT_TRUE(std::equal(again.atoms.begin(), again.atoms.end(), anew.atoms.begin(), same_atom));
  const Rows error = clip.map.positions(values_of_levels(again, clip.character.steps, LongClip::samples)) - clip.wanted;
  EXPECT_LE(largest_distance(error.rowwise() * strictness, clip.map.point_count()), clip.bound * (1 + 1e-5));
}

TEST(Corrections, OfOnePlaceAreTheSameWhateverAnotherNeeds) {
  LongClip clip;
  LevelClip turned = clip.levels;
  for (int parameter = 3; parameter < 12; ++parameter)  // by up to two radians: no linear map tells what that does
    turned.atoms.push_back({1100, parameter, 3, parameter % 2 == 0 ? 1200 : -600});
  std::vector<LevelAtom> alone = clip.corrected(clip.levels, 1), beside = clip.corrected(turned, 1);
  EXPECT_GT(alone.size(), clip.levels.atoms.size() + 100);
  for (std::vector<LevelAtom>* atoms : {&alone, &beside})
    std::erase_if(*atoms, [](const LevelAtom& atom) { return atom.sample >= 500; });
  EXPECT_TRUE(std::equal(alone.begin(), alone.end(), beside.begin(), beside.end(), same_atom));
}

TEST(Corrections, DoNotDependOnThreads) {
  LongClip clip;
  const std::vector<LevelAtom> one = clip.corrected(clip.levels, 1);
  for (const int threads : {2, 5}) {
    const std::vector<LevelAtom> more = clip.corrected(clip.levels, threads);
    EXPECT_TRUE(std::equal(one.begin(), one.end(), more.begin(), more.end(), same_atom)) << threads;
  }
}

TEST(Refinement, RepairLowersTheLargestErrorWithoutNewWeights) {
  Trained trained;
  const double before = trained.largest(trained.levels);
  LevelClip repaired = trained.levels;
  repair(repaired, trained.character.layout, trained.character.steps, trained.map, trained.wanted, 0.7 * before);
  EXPECT_LT(trained.largest(repaired), before);
  EXPECT_LE(repaired.windows[0].weights.size(), trained.levels.windows[0].weights.size());
}

TEST(Refinement, PruneDropsLevelsAndStaysWithinTheBound) {
  Trained trained;
  const double bound = 1.3 * trained.largest(trained.levels);
  LevelClip pruned = trained.levels;
  prune(pruned, trained.character.layout, trained.character.steps, trained.map, trained.wanted, bound);
  const auto sum = [](const LevelClip& clip) {
    long levels = 0;
    for (const LevelWeight& weight : clip.windows[0].weights) levels += std::abs(weight.level);
    return levels;
  };
  EXPECT_LT(sum(pruned), sum(trained.levels));
  EXPECT_LE(trained.largest(pruned), bound * 1.02);  // linear about the pose before
}

}  // namespace
}  // namespace nmc::codec
