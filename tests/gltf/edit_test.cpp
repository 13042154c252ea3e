// The two edits on small documents made by hand: what goes, what stays, what is renumbered, what is refused.
#include "gltf/edit.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "support/fake_compression.h"
#include "support/passthrough.h"

namespace nmc::gltf {
namespace {

using test::make_fake_edit;
using test::passthrough_difference;
using test::read_floats;
using test::stub_channels;
using testing::ElementsAre;
using testing::HasSubstr;

/// Adds a bufferView of `size` bytes that occur nowhere else, and returns its index.
int add_view(Document& document, std::size_t size, std::size_t alignment = 4) {
  Bytes& bytes = document.buffers[0];
  while (bytes.size() % alignment != 0) bytes.push_back(0xEE);
  Json view{{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}};
  for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>((bytes.size() * 37 + size) % 251));
  document.json["buffers"][0]["byteLength"] = bytes.size();
  document.json["bufferViews"].push_back(view);
  return static_cast<int>(document.json["bufferViews"].size()) - 1;
}

int add_accessor(Document& document, const char* type, std::size_t count) {
  const std::size_t width = std::string(type) == "SCALAR" ? 1 : std::string(type) == "VEC4" ? 4 : 3;
  const int view = add_view(document, count * width * 4);
  document.json["accessors"].push_back(
      Json{{"bufferView", view}, {"componentType", 5126}, {"count", count}, {"type", type}});
  return static_cast<int>(document.json["accessors"].size()) - 1;
}

int add_times(Document& document, double end) {
  const int index = add_accessor(document, "SCALAR", 5);
  document.json["accessors"].back()["min"] = Json::array({0.25});
  document.json["accessors"].back()["max"] = Json::array({end});
  return index;
}

/// A file with two nodes and one animation for each entry of `ends` (its last time), of a rotation and a translation.
Document make_document(const std::vector<double>& ends = {1.5, 1.5, 2.0}) {
  Document document;
  document.name = "made.glb";
  document.is_glb = true;
  document.json = Json::parse(R"({"asset":{"version":"2.0"},"nodes":[
      {"name":"hip","rotation":[0,0.6,0,0.8]},{"name":"knee","translation":[1,2,3],"mesh":0}],
      "animations":[],"accessors":[],"bufferViews":[],"buffers":[{"byteLength":0,"name":"all"}]})");
  document.buffers = {Bytes()};
  document.has_data = {true};
  for (const double end : ends) {
    const int times = add_times(document, end);
    const int rotation = add_accessor(document, "VEC4", 5);
    const int translation = add_accessor(document, "VEC3", 5);
    Json animation = Json::parse(R"({"name":"clip","channels":[
        {"sampler":0,"target":{"node":0,"path":"rotation"}},{"sampler":1,"target":{"node":1,"path":"translation"}}]})");
    animation["samplers"] = Json::array({Json{{"input", times}, {"interpolation", "LINEAR"}, {"output", rotation}},
                                         Json{{"input", times}, {"output", translation}}});
    animation["extras"] = Json{{"loop", true}, {"input", 3}};
    document.json["animations"].push_back(animation);
  }
  return document;
}

/// Objects of every kind that refer to accessors and bufferViews, behind the animations' own.
void add_every_reference(Document& document) {
  const auto vec3 = [&] { return add_accessor(document, "VEC3", 3); };
  const auto view = [&](std::size_t size) { return add_view(document, size, 8); };
  Json& json = document.json;
  Json primitive;
  primitive["attributes"] = Json{{"POSITION", vec3()}, {"NORMAL", vec3()}};
  primitive["indices"] = add_accessor(document, "SCALAR", 3);
  primitive["targets"] = Json::array({Json::object({{"POSITION", vec3()}}), Json::object({{"POSITION", vec3()}})});
  primitive["extensions"]["KHR_draco_mesh_compression"] =
      Json{{"bufferView", view(77)}, {"attributes", Json::object({{"POSITION", 0}})}};
  primitive["extensions"]["CESIUM_primitive_outline"]["indices"] = add_accessor(document, "SCALAR", 7);
  json["meshes"] = Json::array({Json::object({{"primitives", Json::array({primitive})}})});
  json["skins"] = Json::array({Json{{"joints", {0, 1}}, {"inverseBindMatrices", vec3()}}});
  json["images"] = Json::array({Json{{"bufferView", view(33)}, {"mimeType", "image/png"}}});
  Json sparse{{"count", 2}};
  sparse = Json::parse(R"({"componentType":5126,"count":9,"type":"SCALAR","sparse":{"count":2}})");
  sparse["sparse"]["indices"] = Json{{"bufferView", view(2)}, {"componentType", 5121}};
  sparse["sparse"]["values"] = Json::object({{"bufferView", view(8)}});
  json["accessors"].push_back(sparse);
  json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] =
      Json{{"TRANSLATION", vec3()}, {"_ID", vec3()}};
  Json& extensions = json["extensions"];
  extensions["EXT_structural_metadata"]["propertyTables"] = Json::array({Json::object(
      {{"properties",
        Json::object(
            {{"height", Json{{"values", view(5)}, {"arrayOffsets", view(6)}, {"stringOffsets", view(7)}}}})}})});
  extensions["EXT_feature_metadata"]["featureTables"]["t"]["properties"]["p"] =
      Json{{"bufferView", view(9)}, {"arrayOffsetBufferView", view(10)}, {"stringOffsetBufferView", view(11)}};
  for (const auto* name : {"KHR_audio", "KHR_audio_emitter"}) {
    extensions[name]["audio"] = Json::array({Json{{"bufferView", view(12)}, {"mimeType", "audio/mpeg"}}});
  }
  extensions["MSFT_audio_emitter"]["clips"] = Json::array({Json{{"bufferView", view(13)}, {"mimeType", "audio/mpeg"}}});
  extensions["KHR_techniques_webgl"]["shaders"] = Json::array({Json{{"type", 35632}, {"bufferView", view(14)}}});
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ApplyCompression, NothingTakenChangesNothing) {
  Document document = make_document();
  const Document before = document;
  EXPECT_TRUE(apply_compression(document, {}).empty());
  EXPECT_EQ(document.json.dump(), before.json.dump());
  EXPECT_EQ(document.buffers, before.buffers);
}

TEST(ApplyCompression, RenumbersEveryKnownReference) {
  const Document original = [] {
    Document document = make_document();
    add_every_reference(document);
    return document;
  }();
  const auto fake = make_fake_edit(original, Requirement::required, 1.0, 3);
  Document edited = original;
  EXPECT_TRUE(apply_compression(edited, fake.edit).empty());
  EXPECT_EQ(passthrough_difference(original, edited, fake.taken, stub_channels(edited)), "");
  // 9 key accessors go; the stubs need two inputs (1.5 s twice, 2 s) and one output for each set's target.
  EXPECT_EQ(edited.json["accessors"].size(), original.json["accessors"].size() - 9 + 2 + 1);
  EXPECT_EQ(edited.json["bufferViews"].size(), original.json["bufferViews"].size() - 9 + 1 + 2);
  EXPECT_LT(edited.buffers[0].size(), original.buffers[0].size());
  for (std::size_t i = 0; i < edited.json["bufferViews"].size(); ++i) EXPECT_NO_THROW(stored_view(edited, i));
}

TEST(ApplyCompression, KeepsOffsetsModuloEight) {
  Document original = make_document();
  const int odd = add_view(original, 16, 8);
  original.json["images"] = Json::array({Json{{"bufferView", odd}, {"mimeType", "image/png"}}});
  ASSERT_EQ(original.json["bufferViews"][static_cast<std::size_t>(odd)]["byteOffset"].get<int>() % 8, 0);
  Document edited = original;
  apply_compression(edited, make_fake_edit(original, Requirement::required, 1.0, 3).edit);
  const auto view = edited.json["images"][0]["bufferView"].get<std::size_t>();
  EXPECT_EQ(edited.json["bufferViews"][view]["byteOffset"].get<int>() % 8, 0);
}

TEST(ApplyCompression, UnknownExtensionKeepsEveryIndex) {
  Document original = make_document();
  add_every_reference(original);
  original.json["scenes"] = Json::parse(R"([{"nodes":[0],"extensions":{"ACME_secret":{"accessor":11}}}])");
  const auto fake = make_fake_edit(original, Requirement::required, 1.0, 3);
  Document edited = original;
  const auto notes = apply_compression(edited, fake.edit);
  EXPECT_THAT(notes, ElementsAre(HasSubstr("ACME_secret")));
  EXPECT_EQ(passthrough_difference(original, edited, fake.taken, stub_channels(edited)), "");
  EXPECT_EQ(edited.json["meshes"], original.json["meshes"]);
  EXPECT_EQ(edited.json["skins"], original.json["skins"]);
  EXPECT_EQ(edited.json["animations"][0]["samplers"].size(), 2U);
  EXPECT_EQ(edited.json["accessors"][0].dump(), R"({"componentType":5121,"count":1,"type":"SCALAR"})");
  EXPECT_EQ(edited.json["bufferViews"][0].dump(), R"({"buffer":0,"byteLength":1})");
  EXPECT_LT(edited.buffers[0].size(), original.buffers[0].size());
  // A sampler that no channel uses still refers to something of its kind.
  for (const auto& sampler : edited.json["animations"][0]["samplers"]) {
    EXPECT_TRUE(edited.json["accessors"][sampler["input"].get<std::size_t>()].contains("max"));
  }
}

TEST(ApplyCompression, PointersIntoNumberedObjectsKeepIndices) {
  Document original = make_document();
  original.json["animations"][0]["channels"].push_back(Json::parse(
      R"({"sampler":0,"target":{"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/nodes/1/scale"}}}})"));
  const auto fake = make_fake_edit(original, Requirement::required, 1.0, 3);
  Document edited = original;
  EXPECT_TRUE(apply_compression(edited, fake.edit).empty());
  EXPECT_EQ(passthrough_difference(original, edited, fake.taken, stub_channels(edited)), "");

  auto& pointer =
      original.json["animations"][0]["channels"][2]["target"]["extensions"]["KHR_animation_pointer"]["pointer"];
  for (const auto* target : {"/accessors/3/count", "/bufferViews/1/byteLength", "/animations/1/samplers/0/input"}) {
    pointer = target;
    edited = original;
    EXPECT_THAT(apply_compression(edited, fake.edit), ElementsAre(HasSubstr("KHR_animation_pointer"))) << target;
  }
}

TEST(ApplyCompression, WhatOthersUseStays) {
  Document original = make_document({1.0});
  // The mesh reads the translations, and an image lies in the middle of the rotations' bytes.
  original.json["meshes"] = Json::parse(R"([{"primitives":[{"attributes":{"POSITION":2}}]}])");
  Json inside = original.json["bufferViews"][1];
  inside["byteOffset"] = inside["byteOffset"].get<int>() + 20;
  inside["byteLength"] = 12;
  original.json["bufferViews"].push_back(inside);
  original.json["images"] = Json::parse(R"([{"bufferView":3,"mimeType":"image/png"}])");
  const auto fake = make_fake_edit(original, Requirement::required, 1.0, 3);
  Document edited = original;
  apply_compression(edited, fake.edit);
  EXPECT_EQ(passthrough_difference(original, edited, fake.taken, stub_channels(edited)), "");
  EXPECT_EQ(edited.json["accessors"].size(), 3U);  // POSITION and the stub's two
}

TEST(ApplyCompression, MeshoptRangeMovesAndPlaceholderStays) {
  Document original = make_document({1.0});
  original.json["buffers"].push_back(
      Json::parse(R"({"byteLength":4096,"extensions":{"EXT_meshopt_compression":{"fallback":true}}})"));
  original.buffers.emplace_back();
  original.has_data.push_back(false);
  const int packed = add_view(original, 40);
  Json& view = original.json["bufferViews"][static_cast<std::size_t>(packed)];
  view["extensions"]["EXT_meshopt_compression"] =
      Json{{"buffer", 0}, {"byteOffset", view["byteOffset"]}, {"byteLength", 40}, {"mode", "ATTRIBUTES"}};
  view["buffer"] = 1;
  view["byteOffset"] = 1024;
  view["byteLength"] = 96;
  original.json["meshes"] = Json::parse(R"([{"primitives":[{"attributes":{"POSITION":3}}]}])");
  original.json["accessors"].push_back(
      Json{{"bufferView", packed}, {"componentType", 5126}, {"count", 8}, {"type", "VEC3"}});
  const auto fake = make_fake_edit(original, Requirement::required, 1.0, 3);
  Document edited = original;
  EXPECT_TRUE(apply_compression(edited, fake.edit).empty());
  EXPECT_EQ(passthrough_difference(original, edited, fake.taken, stub_channels(edited)), "");
  const Json& moved = edited.json["bufferViews"][0];
  EXPECT_EQ(moved["byteOffset"], 1024);
  EXPECT_LT(moved["extensions"]["EXT_meshopt_compression"]["byteOffset"], 8);
}

TEST(ApplyCompression, StubHoldsTheRestValueAndIsShared) {
  Document document = make_document();
  auto fake = make_fake_edit(document, Requirement::required, 1.0, 3);
  for (auto& taken : fake.edit.taken) taken.clip_set = 0;
  fake.edit.clip_sets.resize(1);
  apply_compression(document, fake.edit);
  const Json& animations = document.json["animations"];
  EXPECT_EQ(animations[0]["channels"].dump(), R"([{"sampler":0,"target":{"node":0,"path":"rotation"}}])");
  EXPECT_EQ(animations[0]["samplers"], animations[1]["samplers"]);
  EXPECT_NE(animations[0]["samplers"][0]["input"], animations[2]["samplers"][0]["input"]);
  EXPECT_EQ(animations[0]["samplers"][0]["output"], animations[2]["samplers"][0]["output"]);
  EXPECT_THAT(read_floats(document, animations[0]["samplers"][0]["input"]), ElementsAre(0.25F, 1.5F));
  EXPECT_THAT(read_floats(document, animations[0]["samplers"][0]["output"]),
              ElementsAre(0, 0.6F, 0, 0.8F, 0, 0.6F, 0, 0.8F));
  EXPECT_EQ(animations[0]["name"], "clip");
  EXPECT_EQ(animations[2]["extensions"].dump(), R"({"NMC_animation_compression":{"clipSet":0,"clip":1,"stub":true}})");
}

TEST(ApplyCompression, StubOfOneMomentHasOneKeyAndUnitRotation) {
  Document document = make_document({0.25});
  document.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
  apply_compression(document, make_fake_edit(document, Requirement::required, 1.0, 3).edit);
  const Json& sampler = document.json["animations"][0]["samplers"][0];
  EXPECT_THAT(read_floats(document, sampler["input"]), ElementsAre(0.25F));
  EXPECT_THAT(read_floats(document, sampler["output"]), ElementsAre(0, 0, 0, 1));
}

TEST(ApplyCompression, StubOfMorphWeightsHasAllTargets) {
  Document document = make_document({1.0});
  document.json["meshes"] = Json::parse(R"([{"weights":[0.5,0.25],"primitives":[{"attributes":{}}]}])");
  document.json["animations"][0]["channels"] = Json::parse(R"([{"sampler":0,"target":{"node":1,"path":"weights"}}])");
  apply_compression(document, make_fake_edit(document, Requirement::required, 1.0, 3).edit);
  const Json& sampler = document.json["animations"][0]["samplers"][0];
  EXPECT_THAT(read_floats(document, sampler["output"]), ElementsAre(0.5F, 0.25F, 0.5F, 0.25F));
}

TEST(ApplyCompression, RemainingChannelsKeepTheirSamplers) {
  const Document original = make_document({1.0});
  CompressionEdit edit;
  edit.clip_sets = {{{{0, Path::rotation}}, {1, 2, 3}}};
  edit.taken = {{0, {0}, 0, 0, 0.25F, 1.0F}};
  Document edited = original;
  apply_compression(edited, edit);
  EXPECT_EQ(passthrough_difference(original, edited, {{0, {0}}}, {}), "");
  const Json& animation = edited.json["animations"][0];
  EXPECT_EQ(animation["samplers"].dump(), R"([{"input":0,"output":1}])");
  EXPECT_EQ(animation["channels"][0]["sampler"], 0);
  EXPECT_FALSE(animation["extensions"][extension_name].contains("stub"));
  EXPECT_EQ(stored_view(edited, edited.json["bufferViews"].size() - 1).size(), 3U);
}

TEST(ApplyCompression, ListsTheExtensionAsAsked) {
  for (const auto requirement : {Requirement::required, Requirement::optional, Requirement::fallback}) {
    Document document = make_document();
    document.json["extensionsUsed"] = {"KHR_mesh_quantization"};
    apply_compression(document, make_fake_edit(document, requirement, 1.0, 3).edit);
    EXPECT_EQ(document.json["extensionsUsed"].dump(), R"(["KHR_mesh_quantization","NMC_animation_compression"])");
    EXPECT_EQ(document.json.contains("extensionsRequired"), requirement == Requirement::required);
    EXPECT_EQ(document.json["animations"][0]["channels"].size(), requirement == Requirement::fallback ? 2U : 1U);
    EXPECT_EQ(read_compression(document).requirement, requirement);
  }
}

TEST(ApplyCompression, AnEmptiedBufferGoes) {
  Document document = make_document({1.0});
  document.is_glb = false;
  document.json["buffers"].push_back(Json{{"byteLength", 8}, {"name", "mesh"}});
  document.buffers.push_back(Bytes(8, 1));
  document.has_data.push_back(true);
  for (auto& view : document.json["bufferViews"]) view["buffer"] = 1;
  std::swap(document.buffers[0], document.buffers[1]);
  std::swap(document.json["buffers"][0]["byteLength"], document.json["buffers"][1]["byteLength"]);
  apply_compression(document, make_fake_edit(document, Requirement::required, 1.0, 3).edit);
  ASSERT_EQ(document.json["buffers"].size(), 1U);
  EXPECT_EQ(document.json["buffers"][0]["byteLength"], document.buffers[0].size());
  EXPECT_EQ(document.buffers.size(), 1U);
}

TEST(ApplyCompression, RefusesBrokenDocuments) {
  const auto message = [](const char* pointer, const Json& value) {
    Document document = make_document();
    add_every_reference(document);
    const auto fake = make_fake_edit(document, Requirement::required, 1.0, 3);
    document.json[Json::json_pointer(pointer)] = value;
    return message_of([&] { apply_compression(document, fake.edit); });
  };
  EXPECT_THAT(message("/skins/0/inverseBindMatrices", 999), HasSubstr("skins/*/inverseBindMatrices holds 999"));
  EXPECT_THAT(message("/images/0/bufferView", -1), HasSubstr("no index into bufferViews"));
  EXPECT_THAT(message("/images/0/bufferView", 0.5), HasSubstr("no index into bufferViews"));
  EXPECT_THAT(message("/bufferViews/3/byteLength", 1e15), HasSubstr("bufferViews[3] ends beyond buffers[0]"));
  EXPECT_THAT(message("/bufferViews/3/byteOffset", "x"), HasSubstr("bufferViews[3] has no valid byteOffset"));
  EXPECT_THAT(message("/extensions/NMC_animation_compression", Json::object()), HasSubstr("compressed already"));
}

TEST(ApplyCompression, RefusesARestingChannelThatIsNotThereOrTaken) {
  Document document = make_document();
  CompressionEdit edit = make_fake_edit(document, Requirement::required, 1.0, 3).edit;
  const int taken = edit.taken.front().channels.front();
  for (const int channel : {-1, 2, taken}) {
    edit.taken.front().resting = {channel};
    EXPECT_THAT(message_of([&] { apply_compression(document, edit); }),
                HasSubstr("no channel " + std::to_string(channel) + " left to take"));
  }
}

TEST(ReadCompression, IsEmptyWithoutTheExtension) {
  const auto content = read_compression(make_document());
  EXPECT_TRUE(content.clip_sets.empty());
  EXPECT_TRUE(content.animations.empty());
}

TEST(ReadCompression, RefusesWhatBreaksTheFormat) {
  Document document = make_document();
  apply_compression(document, make_fake_edit(document, Requirement::required, 1.0, 3).edit);
  ASSERT_NO_THROW(read_compression(document));
  const auto message = [&](const std::string& pointer, const Json& value) {
    Document broken = document;
    broken.json[Json::json_pointer(pointer)] = value;
    return message_of([&] { read_compression(broken); });
  };
  const std::string root = "/extensions/NMC_animation_compression";
  const std::string clip = "/animations/2/extensions/NMC_animation_compression";
  EXPECT_THAT(message(root + "/version", 2), HasSubstr("version 2"));
  EXPECT_THAT(message(root + "/version", "1"), HasSubstr("version"));
  EXPECT_THAT(message(root + "/version", 1.0), HasSubstr("version"));
  EXPECT_THAT(message(root + "/clipSets", Json::array()), HasSubstr("has no clipSets"));
  EXPECT_THAT(message(root + "/clipSets/1/bufferView", 99), HasSubstr("clipSets[1]"));
  EXPECT_THAT(
      message(root + "/clipSets/1/bufferView", document.json[Json::json_pointer(root + "/clipSets/0/bufferView")]),
      HasSubstr("shares its bufferView"));
  EXPECT_THAT(message(root + "/clipSets/0/targets/0/nodes/0", 99), HasSubstr("clipSets[0].targets[0].nodes[0]"));
  EXPECT_THAT(message(root + "/clipSets/0/targets/0/nodes/0", 0.0), HasSubstr("is no node"));
  const Json node = document.json[Json::json_pointer(root + "/clipSets/0/targets/0/nodes/0")];
  EXPECT_THAT(message(root + "/clipSets/0/targets/0/nodes", Json::array({node, node})), HasSubstr("repeats a target"));
  EXPECT_THAT(message(root + "/clipSets/0/targets/0/path", "pointer"), HasSubstr("has the path \"pointer\""));
  EXPECT_THAT(message(root + "/fallback", 1), HasSubstr("fallback"));
  EXPECT_THAT(message(clip + "/clipSet", 7), HasSubstr("animations[2].extensions.NMC_animation_compression"));
  EXPECT_THAT(message(clip + "/clip", -1), HasSubstr("clip"));
  EXPECT_THAT(message(clip + "/clip", 1.0), HasSubstr("clip"));
  EXPECT_THAT(message(clip + "/stub", "yes"), HasSubstr("stub"));
  EXPECT_THAT(message("/animations/2/channels", Json::array()), HasSubstr("animations[2] has no channels"));
  EXPECT_THAT(message("/extensions", Json::object()), HasSubstr("refers to a clip set, but the file has none"));
  for (const auto* gone : {"/version", "/clipSets/0/targets", "/clipSets/0/bufferView"}) {
    EXPECT_NE(message(root + gone, nullptr), "no error") << gone;
  }
}

TEST(RemoveCompression, WritesTheDecodedCurves) {
  const Document original = make_document({1.0, 1.0});
  CompressionEdit edit;
  edit.clip_sets = {{{{0, Path::rotation}, {1, Path::translation}, {1, Path::scale}}, {1, 2, 3}}};
  edit.taken = {{0, {0, 1}, 0, 0, 0.25F, 1.0F}, {1, {1}, 0, 1, 0.25F, 1.0F}};
  Document document = original;
  apply_compression(document, edit);
  const std::vector<float> times = {0.1F, 0.7F};
  const std::vector<Animation> decoded = {
      {"",
       {{0, Path::rotation, Interpolation::linear, 4, times, {0, 0, 0, 1, 1, 0, 0, 0}},
        {1, Path::translation, Interpolation::step, 3, times, {1, 2, 3, 4, 5, 6}}}},
      {"", {{1, Path::translation, Interpolation::cubic_spline, 3, {0}, {0, 0, 0, 7, 8, 9, 0, 0, 0}}}}};
  remove_compression(document, read_compression(document), decoded);
  EXPECT_FALSE(document.json.contains("extensions"));
  EXPECT_FALSE(document.json.contains("extensionsUsed"));
  EXPECT_FALSE(document.json.contains("extensionsRequired"));
  const Json& first = document.json["animations"][0];
  EXPECT_EQ(
      first["channels"].dump(),
      R"([{"sampler":0,"target":{"node":0,"path":"rotation"}},{"sampler":1,"target":{"node":1,"path":"translation"}}])");
  EXPECT_EQ(first["samplers"][0]["input"], first["samplers"][1]["input"]);
  EXPECT_EQ(first["samplers"][1]["interpolation"], "STEP");
  EXPECT_EQ(read_floats(document, first["samplers"][0]["input"]), times);
  EXPECT_EQ(read_floats(document, first["samplers"][0]["output"]), decoded[0].curves[0].values);
  const Json& input = document.json["accessors"][first["samplers"][0]["input"].get<std::size_t>()];
  EXPECT_EQ(input["min"][0].get<float>(), times.front());
  EXPECT_EQ(input["max"][0].get<float>(), times.back());
  const Json& second = document.json["animations"][1];
  ASSERT_EQ(second["channels"].size(), 2U);
  EXPECT_EQ(second["samplers"][1]["interpolation"], "CUBICSPLINE");
  EXPECT_EQ(read_floats(document, second["samplers"][1]["output"]), decoded[1].curves[0].values);
  EXPECT_EQ(passthrough_difference(original, document, {{0, {0, 1}}, {1, {1}}}, {{0, {0, 1}}, {1, {1}}}), "");
}

TEST(RemoveCompression, RefusesACurveThatAChannelMovesToo) {
  Document document = make_document({1.0});
  CompressionEdit edit;
  edit.clip_sets = {{{{0, Path::rotation}}, {1, 2, 3}}};
  edit.taken = {{0, {0}, 0, 0, 0.25F, 1.0F}};
  apply_compression(document, edit);
  const std::vector<Animation> decoded = {{"", {{1, Path::translation, Interpolation::linear, 3, {0}, {1, 2, 3}}}}};
  EXPECT_THAT(message_of([&] { remove_compression(document, read_compression(document), decoded); }),
              HasSubstr("by a channel and by its compressed clip"));
}

TEST(RemoveCompression, AfterUnknownExtensionLeavesIndicesAlone) {
  Document original = make_document({1.0, 1.0});
  add_every_reference(original);
  original.json["extensionsUsed"] = {"ACME_secret"};
  Document document = original;
  const auto fake = make_fake_edit(document, Requirement::required, 1.0, 3);
  apply_compression(document, fake.edit);
  const Curve curve{0, Path::rotation, Interpolation::linear, 4, {0, 1}, {0, 0, 0, 1, 1, 0, 0, 0}};
  remove_compression(document, read_compression(document), {{"", {curve}}, {"", {curve}}});
  EXPECT_EQ(document.json["meshes"], original.json["meshes"]);
  EXPECT_EQ(document.json["extensionsUsed"], original.json["extensionsUsed"]);
  EXPECT_EQ(passthrough_difference(original, document, fake.taken, {{0, {0}}, {1, {0}}}), "");
}

}  // namespace
}  // namespace nmc::gltf
