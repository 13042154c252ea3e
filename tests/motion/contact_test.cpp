// Standing still and sliding, against paths whose answers are written by hand.
#include "motion/contact.h"

#include <gtest/gtest.h>

namespace nmc::motion {
namespace {

/// 10 samples a second.
std::vector<float> tenths(std::size_t count) {
  std::vector<float> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(static_cast<float>(i) / 10);
  return times;
}

std::vector<glm::dvec3> along_x(const std::vector<double>& x) {
  std::vector<glm::dvec3> path;
  for (const double value : x) path.emplace_back(value, 0, 0);
  return path;
}

TEST(Contact, FindsTheSpansBelowOnePercentOfTheSizePerSecond) {
  // Size 2: still is less than 0.002 a sample.
  const auto path = along_x({0, 0.001, 0.002, 1, 2, 2, 2.0019, 2.0019 + 0.0021, 3});
  const std::vector<Span> spans = contact_spans(path, tenths(path.size()), 2);
  ASSERT_EQ(spans.size(), 2u);
  EXPECT_EQ(spans[0].first, 0u);
  EXPECT_EQ(spans[0].last, 2u);
  EXPECT_EQ(spans[1].first, 4u);
  EXPECT_EQ(spans[1].last, 6u);
}

TEST(Contact, NeedsATenthOfASecond) {
  const auto path = along_x({0, 0, 1, 2});
  EXPECT_EQ(contact_spans(path, std::vector<float>{0, 0.09f, 0.2f, 0.3f}, 1).size(), 0u);
  EXPECT_EQ(contact_spans(path, std::vector<float>{0, 0.11f, 0.2f, 0.3f}, 1).size(), 1u);
}

TEST(Contact, NothingAndOneSampleHaveNoSpans) {
  EXPECT_TRUE(contact_spans({}, {}, 1).empty());
  EXPECT_TRUE(contact_spans(along_x({1}), tenths(1), 1).empty());
}

TEST(Contact, DriftIsTheChangeOfTheErrorWhileTheOriginalStands) {
  const auto path = along_x({0, 1, 1, 1, 1, 2});
  const auto error = along_x({5, 0.3, 0.4, 0.1, 0.3, 9});
  ContactDrift drift;
  for (std::size_t i = 0; i < path.size(); ++i) drift.add(static_cast<double>(i) / 10, path[i], error[i], 1);
  EXPECT_NEAR(drift.largest(), 0.2, 1e-12);
}

TEST(Contact, AMovingPointDoesNotDrift) {
  ContactDrift drift;
  for (int i = 0; i < 9; ++i) drift.add(i / 10.0, {i, 0, 0}, {i % 2, 0, 0}, 1);
  EXPECT_EQ(drift.largest(), 0);
}

}  // namespace
}  // namespace nmc::motion
