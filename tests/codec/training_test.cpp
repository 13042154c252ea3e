// Training on a made clip: levels against the curves that they stand for.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "character.h"
#include "codec/features.h"
#include "codec/sparse_training.h"

namespace nmc::codec {
namespace {

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

}  // namespace
}  // namespace nmc::codec
