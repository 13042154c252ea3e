// Channels that change nothing: when they are left out of the clips, and when they must not be.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "codec/compress.h"
#include "compressed_document.h"
#include "motion/error.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using codec::CompressOptions;
using codec::CompressResult;

const std::vector<float> rest_of_tip{0, 1, 0};

/// The tiny character with more channels.
class Resting : public testing::Test {
 protected:
  static constexpr int tip = 1;
  TinyGlb glb_;

  /// A channel that goes from one value to another in `seconds`.
  void add_channel(std::size_t animation, int node, const char* path, const std::vector<float>& from,
                   const std::vector<float>& to, float seconds = 2) {
    const std::size_t input = glb_.add(std::vector<float>{0, seconds}, 5126, "SCALAR", 1);
    glb_.json["accessors"][input]["min"] = {0};
    glb_.json["accessors"][input]["max"] = {seconds};
    std::vector<float> values = from;
    values.insert(values.end(), to.begin(), to.end());
    const std::size_t output = glb_.add(values, 5126, from.size() == 4 ? "VEC4" : "VEC3", from.size());
    auto& made = glb_.json["animations"][animation];
    made["channels"].push_back({{"sampler", made["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    made["samplers"].push_back({{"input", input}, {"output", output}});
  }

  std::size_t add_animation(const char* name) {
    glb_.json["animations"].push_back({{"name", name}, {"channels", Json::array()}, {"samplers", Json::array()}});
    return glb_.json["animations"].size() - 1;
  }

  Document document() const { return gltf::parse_document(glb_.bytes(), "resting.glb", {}); }

  static CompressOptions options() {
    CompressOptions options;
    options.effort = 1;
    options.tolerance.value = 0.01;
    options.threads = 1;
    return options;
  }

  CompressResult compress(const CompressOptions& how = options()) const { return codec::compress(document(), how); }

  /// Whether the animation, decoded again, has a channel for a property.
  static bool has(const CompressResult& result, std::size_t animation, int node, Path path) {
    return find_curve(core_animations(codec::expand(result.document)).at(animation), node, path) != nullptr;
  }
};

TEST_F(Resting, ChannelsAreLeftOut) {
  add_channel(0, tip, "translation", rest_of_tip, rest_of_tip);
  add_channel(0, tip, "scale", {1, 1, 1}, {1, 1, 1});
  const CompressResult result = compress();
  ASSERT_EQ(result.clips[0].outcome, codec::Outcome::compressed);
  EXPECT_FALSE(has(result, 0, tip, Path::translation));
  EXPECT_FALSE(has(result, 0, tip, Path::scale));
  EXPECT_TRUE(has(result, 0, tip, Path::rotation));
  EXPECT_EQ(result.document.json["animations"][0]["channels"].size(), 1u);  // the stub
  EXPECT_EQ(gltf::read_compression(result.document).clip_sets.at(0).targets.size(), 3u);
  EXPECT_NE(std::find_if(result.notes.begin(), result.notes.end(),
                         [](const std::string& note) { return note.starts_with("2 of 5 channels"); }),
            result.notes.end());
}

TEST_F(Resting, TheOppositeQuaternionIsTheSameRotation) {
  glb_.json["nodes"][2]["rotation"] = {0, 0, 1, 0};
  add_channel(0, 2, "rotation", {0, 0, 1, 0}, {0, 0, -1, 0});
  EXPECT_FALSE(has(compress(), 0, 2, Path::rotation));
}

TEST_F(Resting, ChannelsStayOnRequest) {
  add_channel(0, tip, "translation", rest_of_tip, rest_of_tip);
  CompressOptions all = options();
  all.keep_resting = true;
  const CompressResult result = compress(all);
  ASSERT_EQ(result.clips[0].outcome, codec::Outcome::compressed);
  EXPECT_TRUE(has(result, 0, tip, Path::translation));
}

TEST_F(Resting, TheFilesOwnKeysStayBesideAFallback) {
  add_channel(0, tip, "translation", rest_of_tip, rest_of_tip);
  CompressOptions both = options();
  both.requirement = gltf::Requirement::fallback;
  EXPECT_EQ(compress(both).document.json["animations"][0]["channels"].size(), 4u);
}

TEST_F(Resting, ThePapersProfileTakesAllChannels) {
  add_channel(0, tip, "translation", rest_of_tip, rest_of_tip);
  CompressOptions paper = options();
  paper.profile = codec::Profile::paper;
  paper.tolerance.value = 0.1;
  const CompressResult result = compress(paper);
  ASSERT_EQ(result.clips[0].outcome, codec::Outcome::compressed);
  EXPECT_TRUE(has(result, 0, tip, Path::translation));
}

TEST_F(Resting, AChannelStaysWhereTheValueIsNotTheNodesOwn) {
  add_channel(0, tip, "translation", {0, 1.1F, 0}, {0, 1.1F, 0});
  EXPECT_TRUE(has(compress(), 0, tip, Path::translation));
}

TEST_F(Resting, UnderALargeScaleLittleIsMuch) {
  // Joints of some metres in nodes that count in millimetres.
  Json& nodes = glb_.json["nodes"];
  nodes.push_back({{"name", "armature"}, {"scale", {1000, 1000, 1000}}, {"children", {4}}});
  nodes.push_back({{"name", "prop"}, {"translation", {0.001, 0, 0}}, {"scale", {0.001, 0.001, 0.001}}});
  glb_.json["scenes"][0]["nodes"].push_back(3);
  glb_.json["skins"][0]["joints"].push_back(4);
  glb_.json["skins"][0].erase("inverseBindMatrices");
  constexpr float away = 0.00105F;  // 5 cm
  add_channel(0, 4, "translation", {away, 0, 0}, {away, 0, 0});
  const CompressResult result = compress();
  ASSERT_EQ(result.clips[0].outcome, codec::Outcome::compressed);
  EXPECT_TRUE(has(result, 0, 4, Path::translation));
}

TEST_F(Resting, AChannelStaysWhereAnotherAnimationMovesTheNode) {
  add_channel(0, tip, "scale", {1, 1, 1}, {1, 1, 1});
  const std::size_t other = add_animation("grow");
  add_channel(other, tip, "scale", {1, 1, 1}, {2, 2, 2});
  const CompressResult result = compress();
  EXPECT_TRUE(has(result, 0, tip, Path::scale));
  // Also where that one is none of the codec's business.
  CompressOptions without = options();
  without.exclude = {"grow"};
  EXPECT_TRUE(has(compress(without), 0, tip, Path::scale));
}

TEST_F(Resting, AllChannelsStayWherePointersMoveNodes) {
  add_channel(0, tip, "scale", {1, 1, 1}, {1, 1, 1});
  const std::size_t other = add_animation("pointed");
  add_channel(other, tip, "scale", {1, 1, 1}, {2, 2, 2});
  Json& target = glb_.json["animations"][other]["channels"][0]["target"];
  target = {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/1/scale"}}}}}};
  glb_.json["extensionsUsed"] = {"KHR_animation_pointer"};
  EXPECT_TRUE(has(compress(), 0, tip, Path::scale));
  target["extensions"]["KHR_animation_pointer"]["pointer"] = "/materials/0/alphaCutoff";
  EXPECT_FALSE(has(compress(), 0, tip, Path::scale));
}

TEST_F(Resting, TheClipLastsAsLongAsItDid) {
  add_channel(0, tip, "translation", rest_of_tip, rest_of_tip, 5);
  const CompressResult result = compress();
  ASSERT_FALSE(has(result, 0, tip, Path::translation));
  EXPECT_FLOAT_EQ(core_animations(codec::expand(result.document))[0].curves.at(0).times.back(), 5);
}

TEST_F(Resting, AnAnimationThatOnlyRestsKeepsAChannel) {
  const std::size_t pose = add_animation("pose");
  add_channel(pose, tip, "translation", rest_of_tip, rest_of_tip);
  add_channel(pose, tip, "scale", {1, 1, 1}, {1, 1, 1});
  const CompressResult result = compress();
  const Animation expanded = core_animations(codec::expand(result.document)).at(pose);
  EXPECT_EQ(expanded.curves.size(), 1u);
  EXPECT_FLOAT_EQ(expanded.curves.at(0).times.back(), 2);
}

TEST_F(Resting, TheMotionIsTheSame) {
  add_channel(0, tip, "translation", rest_of_tip, rest_of_tip);
  add_channel(0, tip, "scale", {1, 1, 1}, {1, 1, 1});
  const CompressResult result = compress();
  const codec::Verification check = codec::verify(document(), codec::expand(result.document), options().tolerance);
  ASSERT_EQ(check.clips.size(), 1u);
  EXPECT_LE(check.clips[0].share_of_tolerance, 1);
  EXPECT_GT(check.clips[0].share_of_tolerance, 0);
}

}  // namespace
}  // namespace nmc::test
