// Excerpts of long clips: whole windows, every sample with all that belongs to it.
#include "codec/excerpt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace nmc::codec {
namespace {

constexpr Eigen::Index samples = 1000;
constexpr std::uint32_t window = 50;

/// A clip whose numbers tell the sample that they are of. Its second half bends a hundred times as much.
PreparedClip numbered_clip(Eigen::Index turns) {
  PreparedClip clip;
  clip.layout.moving = {0, 1};
  clip.layout.values.resize(2, samples);
  for (Eigen::Index n = 0; n < samples; ++n)
    for (Eigen::Index i = 0; i < 2; ++i)
      clip.layout.values(i, n) =
          static_cast<double>(n) + (n < samples / 2 ? 0.05 : 5.0) * std::sin(0.7 * static_cast<double>(n * (i + 1)));
  clip.steps = {Eigen::VectorXd::Constant(2, 0.01), Eigen::VectorXd::Constant(2, 0.002), {}};
  clip.coded = clip.layout.values.col(0);
  clip.wanted = Rows(3, samples);
  for (Eigen::Index r = 0; r < 3; ++r)
    for (Eigen::Index n = 0; n < samples; ++n) clip.wanted(r, n) = static_cast<float>(1000 * r + n);
  clip.offset = in_turns(clip.wanted, turns);
  clip.emphasis = in_turns(clip.wanted.topRows(1), turns);
  return clip;
}

std::vector<std::uint32_t> even_boundaries() {
  std::vector<std::uint32_t> boundaries;
  for (std::uint32_t b = 0; b < samples - 1; b += window) boundaries.push_back(b);
  boundaries.push_back(samples - 1);
  return boundaries;
}

class ExcerptOf : public testing::TestWithParam<int> {};

TEST_P(ExcerptOf, WindowsHasEverySampleWithWhatBelongsToIt) {
  const PreparedClip clip = numbered_clip(GetParam());
  const std::optional<Excerpt> excerpt = excerpt_of(clip, even_boundaries(), 300);
  ASSERT_TRUE(excerpt);
  const PreparedClip& part = excerpt->clip;
  const Eigen::Index count = part.layout.values.cols();
  EXPECT_NEAR(static_cast<double>(count), 300, window);
  EXPECT_NEAR(excerpt->share, static_cast<double>(count) / samples, 1e-9);
  EXPECT_EQ(std::ssize(excerpt->source.clip.times), count);
  Rows taken(3, count);
  for (Eigen::Index n = 0; n < count; ++n) {
    const auto of = static_cast<Eigen::Index>(part.wanted(0, n));
    if (n > 0) {
      EXPECT_GT(of, static_cast<Eigen::Index>(part.wanted(0, n - 1)));
    }
    taken.col(n) = clip.wanted.col(of);
    EXPECT_EQ(part.layout.values.col(n), clip.layout.values.col(of));
  }
  EXPECT_TRUE((part.wanted == taken).all());
  const std::vector<LaneRows> offset = in_turns(taken, GetParam()), emphasis = in_turns(taken.topRows(1), GetParam());
  ASSERT_EQ(part.offset.size(), offset.size());
  for (std::size_t t = 0; t < offset.size(); ++t) {
    EXPECT_TRUE((part.offset[t] == offset[t]).all());
    EXPECT_TRUE((part.emphasis[t] == emphasis[t]).all());
  }
}

INSTANTIATE_TEST_SUITE_P(Turns, ExcerptOf, testing::Values(1, 2, 3));

TEST(Excerpt, EndsItsWindowsWhereTheClipDoes) {
  const PreparedClip clip = numbered_clip(1);
  const std::vector<std::uint32_t> all = even_boundaries();
  const std::optional<Excerpt> excerpt = excerpt_of(clip, all, 300);
  ASSERT_TRUE(excerpt);
  ASSERT_EQ(excerpt->boundaries.front(), 0u);
  EXPECT_EQ(excerpt->boundaries.back() + 1, static_cast<std::uint32_t>(excerpt->clip.layout.values.cols()));
  for (std::size_t b = 0; b < excerpt->boundaries.size(); ++b) {
    const auto of = static_cast<std::uint32_t>(excerpt->clip.wanted(0, excerpt->boundaries[b]));
    EXPECT_TRUE(std::binary_search(all.begin(), all.end(), of)) << of;
    if (b == 0) continue;
    // A whole window of the clip, or the step from one stretch to the next.
    const auto before = static_cast<std::uint32_t>(excerpt->clip.wanted(0, excerpt->boundaries[b - 1]));
    const std::uint32_t length = excerpt->boundaries[b] - excerpt->boundaries[b - 1];
    const auto next = std::upper_bound(all.begin(), all.end(), before);
    EXPECT_TRUE(length == 1 || (of == *next && length == of - before)) << before << " to " << of;
  }
}

TEST(Excerpt, HasCalmAndBusyWindows) {
  const std::optional<Excerpt> excerpt = excerpt_of(numbered_clip(1), even_boundaries(), 300);
  ASSERT_TRUE(excerpt);
  const Eigen::Index count = excerpt->clip.wanted.cols();
  const auto calm = (excerpt->clip.wanted.row(0) < samples / 2.0f).count();
  EXPECT_NEAR(static_cast<double>(calm), static_cast<double>(count) / 2, window);
}

TEST(Excerpt, HasTheJumpsOfItsWindows) {
  PreparedClip clip = numbered_clip(1);
  for (std::uint32_t n = 7; n < samples; n += 10) clip.jumps.push_back({n, 1, LevelAtom::jump_width, 40});
  const std::optional<Excerpt> excerpt = excerpt_of(clip, even_boundaries(), 300);
  ASSERT_TRUE(excerpt);
  std::set<std::uint32_t> jumps;
  for (const LevelAtom& jump : excerpt->clip.jumps) {
    const auto of = static_cast<std::uint32_t>(excerpt->clip.wanted(0, jump.sample));
    EXPECT_EQ(of % 10, 7u);
    EXPECT_EQ(jump.level, 40);
    EXPECT_TRUE(jumps.insert(of).second) << "twice: " << of;
  }
  std::size_t expected = 0;
  for (Eigen::Index n = 0; n < excerpt->clip.wanted.cols(); ++n)
    if (static_cast<int>(excerpt->clip.wanted(0, n)) % 10 == 7) ++expected;
  EXPECT_EQ(jumps.size(), expected);
}

TEST(Excerpt, IsNoneOfFewWindowsOrWhereItWouldBeMostOfTheClip) {
  const PreparedClip clip = numbered_clip(1);
  EXPECT_FALSE(excerpt_of(clip, even_boundaries(), 900));
  EXPECT_TRUE(excerpt_of(clip, {0, 100, 200, 300, 400, 500, samples - 1}, 300));
  EXPECT_FALSE(excerpt_of(clip, {0, 100, 200, 300, 400, samples - 1}, 300));
}

}  // namespace
}  // namespace nmc::codec
