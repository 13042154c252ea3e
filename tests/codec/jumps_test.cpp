// Jumps: found where a curve leaves for elsewhere, not where it is merely fast.
#include "codec/jumps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "codec/atoms.h"

namespace nmc::codec {
namespace {

constexpr Eigen::Index samples = 60;
constexpr double step = 0.001;

struct Curve {
  ClipLayout layout;
  ParameterSteps steps{Eigen::VectorXd::Ones(1), Eigen::VectorXd::Constant(1, step)};

  explicit Curve(const std::function<double(double)>& value) {
    layout.moving = {0};
    layout.values.resize(1, samples);
    for (Eigen::Index n = 0; n < samples; ++n) layout.values(0, n) = value(static_cast<double>(n));
  }

  std::vector<LevelAtom> jumps() const { return find_jumps(layout, steps); }

  /// What is left without the atoms, in one window.
  Eigen::RowVectorXd rest() const {
    LevelClip clip;
    clip.windows = {{0, samples, {}}};
    Eigen::MatrixXd given = Eigen::MatrixXd::Zero(1, samples);
    for (const LevelAtom& atom : jumps()) add_atom_values(atom, clip, steps, given);
    return layout.values - given;
  }
};

double wave(double n) { return std::sin(0.2 * n); }

double largest_difference(const Eigen::RowVectorXd& values) {
  return (values.tail(samples - 1) - values.head(samples - 1)).cwiseAbs().maxCoeff();
}

TEST(Jumps, AreTakenOutToWithinAStep) {
  const Curve curve([](double n) { return wave(n) + (n >= 20 ? 7.0 : 0) - (n >= 41 ? 12.0 : 0); });
  const std::vector<LevelAtom> jumps = curve.jumps();
  ASSERT_EQ(jumps.size(), 2u);
  EXPECT_EQ(jumps[0].sample, 20u);
  EXPECT_EQ(jumps[1].sample, 41u);
  for (const LevelAtom& jump : jumps) EXPECT_EQ(jump.width, LevelAtom::jump_width);
  // A wave of 0.2 radians a sample moves by up to 0.2, and the jumps' own samples are known to about its curvature.
  EXPECT_LT(largest_difference(curve.rest()), 0.25);
}

TEST(Jumps, OfOneSampleAreASpike) {
  const Curve curve([](double n) { return wave(n) + (n == 30 ? 5.0 : 0); });
  const std::vector<LevelAtom> jumps = curve.jumps();
  ASSERT_EQ(jumps.size(), 1u);
  EXPECT_EQ(jumps[0].sample, 30u);
  EXPECT_EQ(jumps[0].width, 0);
  EXPECT_NEAR(jumps[0].level * step, 5.0, 0.05);
}

TEST(Jumps, AreNotTheStartOfAMovement) {
  const Curve curve([](double n) { return n < 25 ? 0.0 : 3.0 * (n - 25); });
  EXPECT_TRUE(curve.jumps().empty());
}

TEST(Jumps, AreNotFastMotion) {
  const Curve curve([](double n) { return 50 * std::sin(0.9 * n); });
  EXPECT_TRUE(curve.jumps().empty());
}

TEST(Jumps, OfFewStepsAreLeftToTheNetwork) {
  const Curve curve([](double n) { return n < 25 ? 0.0 : 20 * step; });
  EXPECT_TRUE(curve.jumps().empty());
}

TEST(Jumps, TooHighForAStreamAreLeft) {
  const Curve curve([](double n) { return n < 25 ? 0.0 : 1e4; });
  EXPECT_TRUE(curve.jumps().empty());
}

}  // namespace
}  // namespace nmc::codec
