// What a document keeps of the search: that it is what the search found, changes no stream, goes when the document is
// expanded, and that anything may stand in its place.
#include "codec/search_record.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "gltf/cost.h"
#include "samples/characters.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using codec::InspectedClip;
using codec::InspectedSet;
using codec::TriedKind;
using gltf::Json;

gltf::Document tiny(std::size_t frames = 31) { return gltf::parse_document(TinyGlb(frames).bytes(), "tiny.glb", {}); }

/// A sample character with three of its animations.
gltf::Document humanoid() {
  gltf::Document document = gltf::parse_document(samples::make_character("humanoid_30hz.glb"), "humanoid.glb", {});
  Json& animations = document.json["animations"];
  while (animations.size() > 3) animations.erase(animations.size() - 1);
  return document;
}

codec::CompressOptions explained(double tolerance = 0.01) {
  codec::CompressOptions options;
  options.effort = 4;
  options.tolerance.value = tolerance;
  options.explain = true;
  return options;
}

gltf::Document compressed(const gltf::Document& document, const codec::CompressOptions& options) {
  return codec::compress(document, options).document;
}

TEST(SearchRecord, ChangesNoStreamAndGoesWithTheExtension) {
  for (const gltf::Document& document : {tiny(), tiny(9)}) {
    codec::CompressOptions options = explained();
    const gltf::Document with = compressed(document, options);
    options.explain = false;
    const gltf::Document without = compressed(document, options);
    ASSERT_NE(with.json, without.json);
    const gltf::CompressedContent one = gltf::read_compression(with), two = gltf::read_compression(without);
    ASSERT_EQ(one.clip_sets.size(), two.clip_sets.size());
    for (std::size_t s = 0; s < one.clip_sets.size(); ++s) EXPECT_EQ(one.clip_sets[s].stream, two.clip_sets[s].stream);
    EXPECT_EQ(codec::expand(with).json, codec::expand(without).json);
    for (const InspectedSet& set : codec::inspect(without)) {
      EXPECT_TRUE(set.poses.empty());
      for (const InspectedClip& clip : set.clips) EXPECT_FALSE(clip.search);
    }
  }
}

TEST(SearchRecord, TheFirstIsWhatTheStreamHolds) {
  const gltf::Document document = humanoid();
  const std::vector<gltf::AnimationCost> costs = gltf::animation_costs(document);
  std::size_t clips = 0, several = 0;
  for (const InspectedSet& set : codec::inspect(compressed(document, explained()))) {
    for (const InspectedClip& clip : set.clips) {
      SCOPED_TRACE(clip.name);
      ++clips;
      ASSERT_TRUE(clip.search);
      const gltf::AnimationCost& cost = costs[static_cast<std::size_t>(clip.animation)];
      EXPECT_EQ(clip.search->key_bytes, cost.key_bytes);
      EXPECT_EQ(clip.search->json_bytes, cost.json_bytes);
      const std::vector<TriedKind>& tried = clip.search->tried;
      ASSERT_FALSE(tried.empty());
      several += tried.size() > 1 ? 1 : 0;
      EXPECT_EQ(tried.front().basis, clip.basis);
      EXPECT_TRUE(tried.front().within_bound);
      for (const TriedKind& kind : tried) {
        EXPECT_TRUE(!kind.within_bound || tried.front().bytes <= kind.bytes) << kind.basis;
        EXPECT_EQ(std::count_if(tried.begin(), tried.end(),
                                [&](const TriedKind& k) { return k.basis == kind.basis && k.jumps == kind.jumps; }),
                  1);
      }
    }
  }
  EXPECT_EQ(clips, 3U);
  EXPECT_GT(several, 0U);
}

TEST(SearchRecord, BytesAreThoseOfTheStream) {
  const std::vector<InspectedSet> sets = codec::inspect(compressed(tiny(100), explained()));
  ASSERT_EQ(sets.size(), 1U);
  ASSERT_EQ(sets[0].clips.size(), 1U);
  std::size_t bits = 0;
  for (const codec::InspectedPart& part : sets[0].parts)
    if (part.name == "anchors" || part.name == "weights" || part.name == "atoms") bits += part.bits;
  // Rounded up, and each part's bits are rounded in the list.
  EXPECT_NEAR(static_cast<double>(sets[0].clips[0].search->tried.at(0).bytes), static_cast<double>(bits) / 8, 1.5);
}

TEST(SearchRecord, ShortClipsHaveTheirPosesTriedCoarser) {
  const std::vector<InspectedSet> sets = codec::inspect(compressed(tiny(9), explained()));
  ASSERT_EQ(sets.size(), 1U);
  ASSERT_EQ(sets[0].poses.size(), 4U);
  EXPECT_EQ(sets[0].poses[0].coarser, 0);
  std::size_t least = sets[0].poses[0].bytes;
  for (const codec::PoseRecord& pose : sets[0].poses)
    if (pose.within_bound) least = std::min(least, pose.bytes);
  EXPECT_EQ(sets[0].stream_bytes, least);
}

TEST(SearchRecord, TellsWhyAnAnimationStays) {
  codec::CompressOptions options = explained();
  gltf::Document document = tiny();
  document.json["animations"].push_back(document.json["animations"][0]);
  document.json["animations"][1]["name"] = "other";
  options.exclude = {document.json["animations"][1]["name"].get<std::string>()};
  const codec::CompressResult result = codec::compress(document, options);
  const std::vector<codec::KeptRecord> kept = codec::inspect_kept(result.document);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].animation, 1);
  EXPECT_EQ(kept[0].reason, result.clips[1].reason);
  EXPECT_NE(kept[0].reason, "");
  EXPECT_EQ(kept[0].search.key_bytes, gltf::animation_costs(document)[1].key_bytes);
}

TEST(SearchRecord, ThePaperHasItsNetwork) {
  codec::CompressOptions options = explained(0.05);
  options.profile = codec::Profile::paper;
  options.max_frequencies = 4;
  const std::vector<InspectedSet> sets = codec::inspect(compressed(tiny(), options));
  ASSERT_EQ(sets.size(), 1U);
  for (const InspectedSet& set : sets)
    for (const InspectedClip& clip : set.clips) EXPECT_EQ(clip.search->tried.at(0).basis, "network");
}

TEST(SearchRecord, ExtrasMayBeAnything) {
  const gltf::Document good = compressed(tiny(9), explained());
  const Json odd = Json::parse(R"([null, true, -1, 1e300, "text", [], [1], {}, {"search": 1}, {"search": []},
    {"search": {"keys": -1, "json": "x", "tried": 4, "poses": {}}}, {"kept": 1}, {"kept": [1, {}, {"animation": 1e15}]},
    {"search": {"tried": [1, null, {}, {"basis": 1, "jumps": 2, "bytes": -3, "givenUp": "x"}],
                "poses": [[], {"coarser": 1e15, "bytes": 0.5}]}}])");
  for (const Json& extras : odd) {
    SCOPED_TRACE(extras.dump());
    gltf::Document document = good;
    Json& root = document.json["extensions"][gltf::extension_name];
    root["extras"] = extras;
    root["clipSets"][0]["extras"] = extras;
    document.json["animations"][0]["extensions"][gltf::extension_name]["extras"] = extras;
    const std::vector<InspectedSet> sets = codec::inspect(document);
    ASSERT_EQ(sets.at(0).clips.size(), 1U);
    for (const codec::PoseRecord& pose : sets[0].poses) EXPECT_LE(pose.coarser, 100);
    EXPECT_LE(codec::inspect_kept(document).size(), 1U);
    EXPECT_EQ(codec::expand(document).json, codec::expand(good).json);
  }
}

}  // namespace
}  // namespace nmc::test
