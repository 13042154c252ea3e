// Prices of levels: what a step costs among the levels that the coder's contexts see.
#include "codec/level_prices.h"

#include <gtest/gtest.h>

#include <cmath>

namespace nmc::codec {
namespace {

constexpr Eigen::Index features = 9, middle = 4;

/// Two targets of three parameters each.
ClipLayout layout_of_two_targets() {
  ClipLayout layout;
  for (std::size_t t = 0; t < 2; ++t)
    for (int a = 0; a < 3; ++a) {
      layout.moving.push_back(static_cast<Eigen::Index>(layout.parameters.size()));
      layout.parameters.push_back({t, a, true});
    }
  return layout;
}

Weights zeros() { return Weights::Zero(6, features); }

Weights one_level(Eigen::Index parameter, Eigen::Index feature, float level) {
  Weights levels = zeros();
  levels(parameter, feature) = level;
  return levels;
}

float price_in_the_middle(const std::vector<Weights>& windows, std::size_t w = 0) {
  return level_prices(windows, layout_of_two_targets())[w](1, middle);
}

TEST(LevelPrices, FollowAGeometricDistribution) {
  // Bits of one more step: log2(1 + 1 / mean); the mean is 0.02 at least, half a bit is added, two bits are the unit.
  const auto expected = [](double mean) { return (0.5 + std::log2(1 + 1 / (mean + 0.02))) / 2; };
  EXPECT_NEAR(price_in_the_middle({zeros()}), expected(0), 1e-5);
  EXPECT_NEAR(price_in_the_middle({Weights::Constant(6, features, 1)}), expected(1), 1e-5);
  EXPECT_NEAR(price_in_the_middle({Weights::Constant(6, features, -3)}), expected(3), 1e-5);
  const Weights twos = Weights::Constant(6, features, 2);
  EXPECT_NEAR(price_in_the_middle({twos, twos, twos}, 1), expected(2), 1e-5);
}

TEST(LevelPrices, FallBesideWhatTheContextsSee) {
  const float alone = price_in_the_middle({zeros()});
  for (const Eigen::Index feature : {middle - 2, middle - 1, middle + 1, middle + 2})
    EXPECT_LT(price_in_the_middle({one_level(1, feature, 2)}), alone) << feature;
  for (const Eigen::Index parameter : {0, 2})
    EXPECT_LT(price_in_the_middle({one_level(parameter, middle, 2)}), alone) << parameter;
  EXPECT_LT(price_in_the_middle({zeros(), one_level(1, middle, 2)}), price_in_the_middle({zeros(), zeros()}));
  EXPECT_LT(price_in_the_middle({one_level(1, middle, 2), zeros()}, 1), price_in_the_middle({zeros(), zeros()}, 1));
}

TEST(LevelPrices, DoNotDependOnTheRest) {
  const float alone = price_in_the_middle({zeros()});
  EXPECT_EQ(price_in_the_middle({one_level(1, middle, 5)}), alone);         // the level itself
  EXPECT_EQ(price_in_the_middle({one_level(3, middle, 5)}), alone);         // another target
  EXPECT_EQ(price_in_the_middle({one_level(1, middle - 1, 0.4f)}), alone);  // rounds to zero
}

TEST(LevelPrices, WindowsMayDifferInFeatures) {
  const Weights none(6, 0), few = Weights::Ones(6, 2);
  const std::vector<Weights> prices = level_prices({zeros(), few, none}, layout_of_two_targets());
  ASSERT_EQ(prices.size(), 3u);
  EXPECT_EQ(prices[0].cols(), features);
  EXPECT_EQ(prices[1].cols(), 2);
  EXPECT_EQ(prices[2].cols(), 0);
  EXPECT_LT(prices[0](1, 0), prices[0](1, middle));  // beside the other window's levels
}

}  // namespace
}  // namespace nmc::codec
