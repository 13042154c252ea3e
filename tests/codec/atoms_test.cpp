// Atoms by themselves: joined, turned into values, and as few as are needed; flips between samples.
#include "codec/atoms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "codec/between.h"

namespace nmc::codec {
namespace {

LevelAtom atom(int parameter, std::int32_t level, std::uint32_t sample = 4, int width = 0) {
  return {sample, parameter, width, level};
}

TEST(Atoms, OfOnePlaceAreOne) {
  std::vector<LevelAtom> atoms;
  put_atom(atom(1, 3), atoms);
  put_atom(atom(2, 5), atoms);
  put_atom(atom(1, -4), atoms);
  put_atom(atom(1, 7, 4, 2), atoms);
  put_atom(atom(1, 7, 5), atoms);
  ASSERT_EQ(atoms.size(), 4u);
  EXPECT_EQ(atoms[0].level, -1);
  EXPECT_EQ(atoms[1].level, 5);
}

TEST(Atoms, OfManyPlacesAreJoinedAsOneByOne) {
  const std::vector<LevelAtom> added{atom(1, 3), atom(2, 5), atom(1, -4), atom(3, 2, 1), atom(1, 7, 4, 2), atom(2, 1)};
  std::vector<LevelAtom> one_by_one{atom(2, 9), atom(5, 1, 7)}, together = one_by_one;
  for (const LevelAtom& one : added) put_atom(one, one_by_one);
  put_atoms(added, together);
  ASSERT_EQ(together.size(), one_by_one.size());
  for (std::size_t k = 0; k < together.size(); ++k) {
    EXPECT_EQ(together[k].parameter, one_by_one[k].parameter);
    EXPECT_EQ(together[k].sample, one_by_one[k].sample);
    EXPECT_EQ(together[k].width, one_by_one[k].width);
    EXPECT_EQ(together[k].level, one_by_one[k].level);
  }
}

TEST(Atoms, FallLikeARaisedCosineToTheirHalfWidth) {
  const ParameterSteps steps{Eigen::VectorXd::Ones(2), Eigen::VectorXd::Constant(2, 0.5)};
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(2, 9);
  add_atom_values(atom(1, 8, 2, 2), {}, steps, values);
  Eigen::RowVectorXd expected(9);
  for (int n = 0; n < 9; ++n)
    expected(n) = n < 6 ? 8 * 0.5 * 0.5 * (1 + std::cos(3.141592653589793 * (n - 2) / 4)) : 0.0;
  EXPECT_EQ(values.row(0).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_LT((values.row(1) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

/// What a clip of two windows of six samples has at its samples by one jump of height 10.
Eigen::RowVectorXd jump_values(Basis basis, std::uint32_t sample) {
  LevelClip clip;
  clip.basis = basis;
  clip.windows = {{0, 6, {}}, {6, 6, {}}};
  if (basis == Basis::cosine) clip.windows = {{0, 13, {}}};
  const ParameterSteps steps{Eigen::VectorXd::Ones(1), Eigen::VectorXd::Constant(1, 0.5)};
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(1, 13);
  add_atom_values(atom(0, 20, sample, LevelAtom::jump_width), clip, steps, values);
  return values;
}

TEST(Atoms, OfAJumpAreAStepWithoutTheLineOfTheWindow) {
  Eigen::RowVectorXd expected = Eigen::RowVectorXd::Zero(13);
  for (int m = 0; m < 6; ++m) expected(m) = 10 * ((m >= 4 ? 1 : 0) - m / 6.0);
  EXPECT_LT((jump_values(Basis::sine, 4) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Atoms, OfAJumpBetweenWindowsBelongToTheFormer) {
  Eigen::RowVectorXd expected = Eigen::RowVectorXd::Zero(13);
  for (int m = 0; m < 6; ++m) expected(m) = -10 * m / 6.0;
  EXPECT_LT((jump_values(Basis::sine, 6) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(Atoms, OfAJumpAreAllOfTheStepWithTheCosineBasis) {
  Eigen::RowVectorXd expected = Eigen::RowVectorXd::Zero(13);
  expected.tail(12).setConstant(10);
  EXPECT_LT((jump_values(Basis::cosine, 1) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

double sum_of_levels(const std::vector<LevelAtom>& atoms) {
  double sum = 0;
  for (const LevelAtom& one : atoms) sum += one.level;
  return sum;
}

std::vector<LevelAtom> needed_of(std::vector<std::vector<LevelAtom>> lists, const Excess& excess) {
  int tries = 1000;
  return needed_atoms(std::move(lists), excess, tries);
}

TEST(NeededAtoms, AreTheOneThatIsEnough) {
  const auto excess = [](const std::vector<LevelAtom>& atoms) { return std::max(0.0, 10 - sum_of_levels(atoms)); };
  const std::vector<LevelAtom> needed = needed_of({{atom(0, 4)}, {atom(1, 11)}, {atom(2, 9)}}, excess);
  ASSERT_EQ(needed.size(), 1u);
  EXPECT_EQ(needed[0].parameter, 1);
}

TEST(NeededAtoms, AreNoneWhereNothingIsWrong) {
  EXPECT_TRUE(needed_of({{atom(0, 4)}}, [](const auto&) { return 0.0; }).empty());
}

TEST(NeededAtoms, LeaveOutWhatDoesNotHelpWhereOnlyTwoTogetherDo) {
  // Two errors that cancel each other: setting right either of them alone makes it worse.
  const auto excess = [](const std::vector<LevelAtom>& atoms) {
    int right = 0;
    for (const LevelAtom& one : atoms) right += one.parameter == 1 || one.parameter == 3;
    return right == 2 ? 0.0 : 1.0 + right;
  };
  const std::vector<LevelAtom> needed = needed_of({{atom(0, 1)}, {atom(1, 1)}, {atom(2, 50)}, {atom(3, 9)}}, excess);
  ASSERT_EQ(needed.size(), 2u);
  EXPECT_EQ(needed[0].parameter + needed[1].parameter, 4);
}

TEST(NeededAtoms, AreAllWhereAllAreNotEnough) {
  EXPECT_EQ(needed_of({{atom(0, 1)}, {atom(1, 1)}}, [](const auto&) { return 1.0; }).size(), 2u);
}

TEST(NeededAtoms, WithFewTriesAreTheFirstOnesThatAreEnough) {
  std::vector<std::vector<LevelAtom>> lists;
  for (int k = 0; k < 1000; ++k) lists.push_back({atom(k, 1)});
  int looks = 0, tries = 20;
  const std::vector<LevelAtom> needed = needed_atoms(
      lists,
      [&](const std::vector<LevelAtom>& atoms) {
        ++looks;
        return std::any_of(atoms.begin(), atoms.end(), [](const LevelAtom& one) { return one.parameter == 700; }) ? 0.0
                                                                                                                  : 1.0;
      },
      tries);
  EXPECT_EQ(needed.size(), 701u);
  EXPECT_LE(looks, 20 + 1 + 10);  // those tried, none of them, and halving 1,000
  EXPECT_LE(tries, 0);
}

TEST(NeededAtoms, LeaveTheTriesThatTheyDoNotTake) {
  int tries = 10;
  needed_atoms(
      {{atom(0, 1)}, {atom(1, 1)}}, [](const auto& atoms) { return atoms.empty() ? 1.0 : 0.0; }, tries);
  EXPECT_EQ(tries, 9);
}

/// Two joints side by side below a root; the first turns by nearly half a turn from one key to the next.
struct Flipping {
  motion::Skeleton skeleton;
  Points points;
  ClipSource source;
  SetFrame frame;
  ClipLayout layout;
  ParameterSteps steps;

  Flipping() {
    for (int i = 0; i < 2; ++i) {
      skeleton.names.push_back("joint");
      skeleton.parent.push_back(-1);
      skeleton.order.push_back(i);
      skeleton.rest.push_back({});
      skeleton.rest_matrix.push_back(glm::dmat4(1.0));
      skeleton.rest_weights.emplace_back();
      skeleton.joints.push_back(i);
      const Influence tip{i, {1, 0, 0}, 1};
      points.add(&tip, &tip + 1);
    }
    source.clip.times = {0, 0.1f, 0.2f, 0.3f};
    for (int i = 0; i < 2; ++i) {
      motion::Track track{i, Path::rotation, 4, {}};
      for (int n = 0; n < 4; ++n) {
        const double angle = i == 1 ? 0.1 * n : n >= 2 ? 3.14 : 0.0;
        for (const double value : {0.0, 0.0, std::sin(angle / 2), std::cos(angle / 2)})
          track.values.push_back(static_cast<float>(value));
      }
      source.clip.tracks.push_back(track);
      source.original.curves.push_back(
          {i, Path::rotation, Interpolation::linear, 4, source.clip.times, source.clip.tracks.back().values});
    }
    frame = mean_frame(skeleton, {&source.clip});
    layout = layout_clip(source.clip, frame);
    const auto count = static_cast<Eigen::Index>(layout.parameters.size());
    steps = {Eigen::VectorXd::Constant(count, 0.01), Eigen::VectorXd::Constant(count, 1e-5)};
  }
};

TEST(MendBetween, SetsRightTheJointThatTurnsTheOtherWay) {
  const Flipping flipping;
  const motion::ErrorMeter meter(flipping.skeleton, flipping.points);
  Eigen::MatrixXd values = flipping.layout.values;
  // A little more at the later side: the shorter way is now the other one, and both joints are off by a little.
  values.col(2).array() += 0.02;
  const auto error_between = [&] {
    return meter.error_at(
        flipping.source.original,
        with_kept(flipping.source, clip_of_parameters(flipping.source.clip, flipping.frame, flipping.layout, values)),
        0.15);
  };
  ASSERT_GT(error_between(), 1.0);
  LevelClip levels;
  mend_between({flipping.source, flipping.frame, flipping.layout, flipping.steps, meter}, 2, 0.15, 0.03,
               Mending::true_poses, most_tries, values, levels.atoms);
  EXPECT_LT(error_between(), 0.03);
  ASSERT_FALSE(levels.atoms.empty());
  for (const LevelAtom& one : levels.atoms) {
    EXPECT_EQ(one.sample, 2u);  // the earlier side was right
    EXPECT_EQ(flipping.layout.parameters[static_cast<std::size_t>(one.parameter)].target, 0u);
  }
}

TEST(MendBetween, TipsAHalfTurnThatRoundingSendsTheOtherWay) {
  Flipping flipping;
  flipping.steps.anchor.setConstant(0.01);
  const motion::ErrorMeter meter(flipping.skeleton, flipping.points);
  Eigen::MatrixXd values = flipping.layout.values;
  // Less than half a step too far: no whole step is missing.
  values.col(2).head(3).array() += 0.004;
  const auto error_at = [&](double seconds) {
    return meter.error_at(
        flipping.source.original,
        with_kept(flipping.source, clip_of_parameters(flipping.source.clip, flipping.frame, flipping.layout, values)),
        seconds);
  };
  ASSERT_GT(error_at(0.15), 1.0);
  LevelClip levels;
  const BetweenInput input{flipping.source, flipping.frame, flipping.layout, flipping.steps, meter};
  EXPECT_TRUE(mend_between(input, 2, 0.15, 0.03, Mending::true_poses, most_tries, values, levels.atoms));
  for (const double seconds : {0.1, 0.15, 0.2}) EXPECT_LT(error_at(seconds), 0.03);
  EXPECT_EQ(levels.atoms.size(), 1u);
  // A bound below what rounding leaves is out of reach, and is not said to be kept.
  EXPECT_FALSE(mend_between(input, 2, 0.15, 1e-6, Mending::true_poses, most_tries, values, levels.atoms));
}

TEST(MendBetween, TipsWithOneAtomWhatItsTruePoseTakesMoreFor) {
  Flipping flipping;
  flipping.steps.anchor.setConstant(1e-3);
  const motion::ErrorMeter meter(flipping.skeleton, flipping.points);
  const BetweenInput input{flipping.source, flipping.frame, flipping.layout, flipping.steps, meter};
  std::size_t atoms[2] = {};
  for (const Mending mending : {Mending::tips, Mending::true_poses}) {
    Eigen::MatrixXd values = flipping.layout.values;
    values.col(2).array() += 0.01;
    LevelClip levels;
    EXPECT_TRUE(mend_between(input, 2, 0.15, 0.03, mending, most_tries, values, levels.atoms));
    const Animation made =
        with_kept(flipping.source, clip_of_parameters(flipping.source.clip, flipping.frame, flipping.layout, values));
    for (const double seconds : {0.1, 0.15, 0.2})
      EXPECT_LT(meter.error_at(flipping.source.original, made, seconds), 0.03);
    atoms[mending == Mending::tips ? 0 : 1] = levels.atoms.size();
  }
  EXPECT_EQ(atoms[0], 1u);
  EXPECT_GT(atoms[1], 1u);
}

TEST(MendBetween, TipsEveryHalfTurnEvenWithoutTries) {
  Flipping flipping;
  flipping.steps.anchor.setConstant(1e-3);
  const motion::ErrorMeter meter(flipping.skeleton, flipping.points);
  Eigen::MatrixXd values = flipping.layout.values;
  values.col(2).head(3).array() += 0.01;
  LevelClip levels;
  const BetweenInput input{flipping.source, flipping.frame, flipping.layout, flipping.steps, meter};
  EXPECT_TRUE(mend_between(input, 2, 0.15, 0.03, Mending::tips, 0, values, levels.atoms));
  EXPECT_EQ(levels.atoms.size(), 1u);
  const Animation made =
      with_kept(flipping.source, clip_of_parameters(flipping.source.clip, flipping.frame, flipping.layout, values));
  for (const double seconds : {0.1, 0.15, 0.2})
    EXPECT_LT(meter.error_at(flipping.source.original, made, seconds), 0.03);
}

}  // namespace
}  // namespace nmc::codec
