// Corrections and refinements of levels against the positions that they promise.
#include "codec/corrections.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "character.h"
#include "codec/atoms.h"
#include "codec/refinement.h"

namespace nmc::codec {
namespace {

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
