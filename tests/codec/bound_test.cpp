// Tolerances for some points, channels that stay, exact ends, a number of bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "codec/compress.h"
#include "codec/rules.h"
#include "codec/target_size.h"
#include "compressed_document.h"
#include "motion/error.h"
#include "samples/characters.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using codec::CompressOptions;
using codec::CompressResult;

constexpr double loose = 0.02, strict = 0.0005;  // of the character's size

Document humanoid() {
  return gltf::parse_document(samples::make_character("humanoid_30hz.glb"), "humanoid_30hz.glb", {});
}

Document tiny() { return gltf::parse_document(TinyGlb(31).bytes(), "tiny.glb", {}); }

CompressOptions quick() {
  CompressOptions options;
  options.effort = 1;
  options.tolerance.value = loose;
  return options;
}

/// The two shortest clips of a document, which has others: compressing all would take minutes with sanitizers.
CompressOptions two_clips(const Document& document) {
  std::vector<std::pair<float, std::string>> clips;
  for (const Animation& animation : core_animations(document))
    clips.emplace_back(animation.curves.front().times.back(), animation.name);
  std::sort(clips.begin(), clips.end());
  CompressOptions options = quick();
  for (std::size_t i = 2; i < clips.size(); ++i) options.exclude.push_back(clips[i].second);
  return options;
}

codec::ToleranceRule strict_for(codec::Selector where) { return {std::move(where), {strict, {}}}; }

/// A document and what became of it, as animations.
struct Pair {
  explicit Pair(const Document& document, const CompressOptions& options)
      : result(codec::compress(document, options)),
        asset(gltf::read_asset(document)),
        skeleton(codec::make_skeleton(asset)),
        wanted(core_animations(document)),
        got(core_animations(codec::expand(result.document))) {
    for (std::size_t i = 0; i < wanted.size(); ++i)
      if (result.clips[i].outcome == codec::Outcome::compressed) compressed.push_back(i);
    EXPECT_EQ(compressed.size(), 2U);
  }

  /// The largest error of an animation, over the origins of nodes whose names fit.
  double origin_error(std::size_t animation, const std::string& pattern) const {
    Points points;
    for (std::size_t n = 0; n < asset.nodes.size(); ++n) {
      const Influence origin{static_cast<int>(n), {}, 1};
      if (codec::matches(pattern, asset.nodes[n].name)) points.add(&origin, &origin + 1);
    }
    return motion::measure_error(skeleton, points, wanted[animation], got.at(animation)).max / result.size;
  }

  CompressResult result;
  gltf::Asset asset;
  motion::Skeleton skeleton;
  std::vector<Animation> wanted, got;
  std::vector<std::size_t> compressed;
};

TEST(Patterns, StarsAndQuestionMarks) {
  for (const auto& [pattern, name] :
       std::vector<std::pair<const char*, const char*>>{{"", ""},
                                                        {"*", ""},
                                                        {"*", "abc"},
                                                        {"a*c", "abbc"},
                                                        {"a*b*c", "aXbYbZc"},
                                                        {"?b*", "ab"},
                                                        {"**x", "x"},
                                                        {"*aab", "aaaab"},
                                                        {"mixamorig:*Hand", "mixamorig:LeftHand"}})
    EXPECT_TRUE(codec::matches(pattern, name)) << pattern << " " << name;
  for (const auto& [pattern, name] : std::vector<std::pair<const char*, const char*>>{
           {"", "a"}, {"a", ""}, {"?", ""}, {"a*c", "abcd"}, {"*b", "abc"}, {"A*", "abc"}, {"a?c", "abbc"}})
    EXPECT_FALSE(codec::matches(pattern, name)) << pattern << " " << name;
}

TEST(Bound, AJointsOwnToleranceIsKeptWhereOthersMoveFurther) {
  const Document document = humanoid();
  CompressOptions options = two_clips(document);
  options.rules.push_back(strict_for({.clip = "", .joint = "foot*", .path = {}}));
  const Pair pair(document, options);
  double others = 0;
  for (const std::size_t i : pair.compressed) {
    EXPECT_LE(pair.origin_error(i, "foot*"), strict) << pair.wanted[i].name;
    EXPECT_LE(pair.result.clips[i].share_of_tolerance, 1);
    others = std::max(others, pair.origin_error(i, "*"));
  }
  EXPECT_GT(others, 2 * strict);  // the rule is not for everything
  EXPECT_LE(others, loose);
}

TEST(Bound, AClipsOwnToleranceIsKept) {
  const Document document = humanoid();
  CompressOptions options = two_clips(document);
  const Pair without(document, options);
  const std::size_t one = without.compressed[0], other = without.compressed[1];
  options.rules.push_back(strict_for({.clip = without.wanted[one].name, .joint = "", .path = {}}));
  const Pair with(document, options);
  EXPECT_GT(without.origin_error(one, "*"), 2 * strict);
  EXPECT_LE(with.origin_error(one, "*"), strict);
  EXPECT_GT(with.origin_error(other, "*"), 2 * strict);
}

TEST(Bound, AChannelsToleranceIsThatOfWhatItMoves) {
  const Document document = humanoid();
  CompressOptions options = two_clips(document);
  options.rules.push_back(strict_for({.clip = "", .joint = "shin*", .path = Path::rotation}));
  const Pair pair(document, options);
  for (const std::size_t i : pair.compressed) EXPECT_LE(pair.origin_error(i, "foot*"), strict) << pair.wanted[i].name;
}

TEST(Bound, TheLastRuleCounts) {
  CompressOptions options = quick();
  options.rules.push_back(strict_for({.clip = "", .joint = "*", .path = {}}));
  options.rules.push_back({{.clip = "", .joint = "", .path = {}}, {loose, {}}});
  const CompressResult both = codec::compress(tiny(), options);
  options.rules.clear();
  const CompressResult plain = codec::compress(tiny(), options);
  EXPECT_EQ(codec::animation_bytes(both), codec::animation_bytes(plain));
}

TEST(Bound, PatternsThatFitNothingAreTold) {
  CompressOptions options = quick();
  options.rules.push_back(strict_for({.clip = "", .joint = "tpi", .path = {}}));
  options.keep.push_back({.clip = "wlak", .joint = "", .path = {}});
  const std::vector<std::string> notes = codec::compress(tiny(), options).notes;
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_NE(notes[0].find("'tpi'"), std::string::npos);
  EXPECT_NE(notes[1].find("'wlak'"), std::string::npos);
}

TEST(Keep, ChannelsStayAsTheyAre) {
  const Document document = tiny();
  CompressOptions options = quick();
  options.keep.push_back({.clip = "", .joint = "r?ot", .path = Path::rotation});
  const CompressResult result = codec::compress(document, options);
  const std::vector<Animation> before = core_animations(document), after = core_animations(result.document);
  ASSERT_EQ(after[0].curves.size(), 1U);
  EXPECT_EQ(after[0].curves[0].path, Path::rotation);
  EXPECT_EQ(after[0].curves[0].values, find_curve(before[0], 0, Path::rotation)->values);
  EXPECT_EQ(core_animations(codec::expand(result.document))[0].curves.size(), 3U);
}

TEST(ExactEnds, FirstAndLastPoseAreWithinAHundredth) {
  const Document document = humanoid();
  CompressOptions options = two_clips(document);
  options.exact_ends = true;
  const Pair exact(document, options);
  options.exact_ends = false;
  const Pair plain(document, options);
  const Points points = gltf::skin_points(document, exact.asset, true);
  const motion::ErrorMeter meter(exact.skeleton, points);
  double usual = 0;
  for (const std::size_t i : exact.compressed) {
    const std::vector<float>& times = exact.wanted[i].curves.front().times;
    for (const double seconds : {times.front(), times.back()}) {
      EXPECT_LE(meter.error_at(exact.wanted[i], exact.got[i], seconds), 0.01 * exact.result.tolerance)
          << exact.wanted[i].name << " at " << seconds;
      usual = std::max(usual, meter.error_at(plain.wanted[i], plain.got[i], seconds));
    }
  }
  EXPECT_GT(usual, 0.01 * plain.result.tolerance);  // it takes the option
}

TEST(TargetSize, TheBytesAreMetAndNotWasted) {
  const Document document = humanoid();
  CompressOptions options = two_clips(document);
  options.tolerance.value = 0.005;
  const std::size_t wanted = codec::animation_bytes(codec::compress(document, options));
  const CompressResult result = codec::compress_to_size(document, options, wanted);
  EXPECT_LE(codec::animation_bytes(result), wanted);
  EXPECT_GE(codec::animation_bytes(result), wanted * 9 / 10);
  for (const codec::ClipResult& clip : result.clips) EXPECT_LE(clip.error.max, result.tolerance);
}

TEST(TargetSize, TooFewBytesAreRefused) {
  try {
    codec::compress_to_size(tiny(), quick(), 100);
    ADD_FAILURE() << "100 bytes were enough";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("tiny.glb need"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace nmc::test
