// Corrections of loops: what they change at one end they change at the other.
#include "codec/seam.h"

#include <gtest/gtest.h>

#include <random>

#include "codec/atoms.h"
#include "codec/sparse_training.h"

namespace nmc::codec {
namespace {

constexpr Eigen::Index parameters = 3;
const Eigen::Vector3d signs(1, -1, 1);

/// What the atoms add to the parameters, parameters x samples.
Eigen::MatrixXd added(const LevelClip& clip, Eigen::Index samples) {
  const ParameterSteps steps{Eigen::VectorXd::Ones(parameters), Eigen::VectorXd::Ones(parameters)};
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(parameters, samples);
  for (const LevelAtom& atom : clip.atoms) add_atom_values(atom, clip, steps, values);
  return values;
}

void expect_closed(LevelClip clip, Eigen::Index samples) {
  close_seam(clip, signs, samples);
  const Eigen::MatrixXd after = added(clip, samples);
  EXPECT_LT((after.col(samples - 1) - signs.cwiseProduct(after.col(0))).cwiseAbs().maxCoeff(), 1e-12) << samples;
}

TEST(Seam, ClosesWhereAnAtomIsAtOneEnd) {
  LevelClip clip;
  clip.atoms = {{0, 0, 0, 3}, {0, 1, 0, -2}};
  expect_closed(clip, 40);
  close_seam(clip, signs, 40);
  EXPECT_EQ(added(clip, 40).col(0), Eigen::Vector3d(3, -2, 0));  // that end needs what it has
  EXPECT_EQ(added(clip, 40).col(39), Eigen::Vector3d(3, 2, 0));
}

TEST(Seam, ClosesWhereAnAtomReachesFromOneEndToTheOther) {
  LevelClip clip;
  clip.atoms = {{0, 0, 5, 1}};
  expect_closed(clip, 21);
}

TEST(Seam, ClosesWhereBothEndsHaveUnlikeAtomsBesideThem) {
  LevelClip clip;
  clip.atoms = {{1, 2, 1, 3}, {38, 2, 1, 2}};
  expect_closed(clip, 40);
}

TEST(Seam, ClosesWhateverTheAtoms) {
  std::mt19937 random(4);
  for (int trial = 0; trial < 200; ++trial) {
    const auto samples = static_cast<std::uint32_t>(9 + random() % 80);
    LevelClip clip;
    for (int k = 0; k < 20; ++k)
      put_atom({static_cast<std::uint32_t>(random() % samples), static_cast<int>(random() % parameters),
                static_cast<int>(random() % 7), static_cast<std::int32_t>(random() % 9) - 4},
               clip.atoms);
    tidy_atoms(clip.atoms);
    expect_closed(clip, static_cast<Eigen::Index>(samples));
  }
}

}  // namespace
}  // namespace nmc::codec
