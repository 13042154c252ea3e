// The typed view: accessors of every kind, the node hierarchy, animations, and what is refused.
#include "gltf/asset.h"

#include <gmock/gmock.h>
#include <meshoptimizer.h>

#include <limits>

#include "gltf/model_builder.h"
#include "support/sanitized.h"

namespace {

using nmc::Curve;
using nmc::ErrorCode;
using nmc::Interpolation;
using nmc::Path;
using nmc::gltf::Asset;
using nmc::gltf::Json;
using nmc::gltf::read_asset;
using nmc::test::error_of;
using nmc::test::ModelBuilder;
using nmc::test::sanitized;
using testing::ElementsAre;
using testing::FloatEq;
using testing::HasSubstr;

/// A builder with one node and times 0, 1, ... of `keys` keys as accessor 0.
ModelBuilder with_times(std::size_t keys) {
  ModelBuilder model;
  model.add("nodes", Json::object());
  std::vector<float> times;
  for (std::size_t i = 0; i < keys; ++i) times.push_back(static_cast<float>(i));
  model.floats("SCALAR", 1, times);
  return model;
}

/// The only curve of a model.
Curve only_curve(const ModelBuilder& model) {
  const Asset asset = read_asset(model.build());
  EXPECT_EQ(asset.animations.size(), 1u);
  EXPECT_EQ(asset.animations.at(0).channels.size(), 1u);
  return asset.animations.at(0).channels.at(0).curve;
}

void expect_invalid(const ModelBuilder& model, const std::string& words) {
  const nmc::Error error = error_of([&] { read_asset(model.build()); });
  EXPECT_EQ(error.code(), ErrorCode::invalid_input) << error.what();
  EXPECT_THAT(error.what(), HasSubstr(words));
  EXPECT_THAT(error.what(), HasSubstr("built.glb"));
}

TEST(Asset, ReadsNormalizedIntegers) {
  // glTF 2.0, section 3.11: f = max(c / 127, -1), c / 255, max(c / 32767, -1), c / 65535.
  const auto rotation = [](int component_type, auto values) {
    ModelBuilder model = with_times(1);
    model.animate(0, "rotation", 0,
                  model.accessor(model.view(values), component_type, "VEC4", 1, {{"normalized", true}}));
    return only_curve(model).values;
  };
  EXPECT_THAT(rotation(5120, std::vector<std::int8_t>{-128, -127, 64, 127}),
              ElementsAre(-1.0f, -1.0f, FloatEq(64.0f / 127.0f), 1.0f));
  EXPECT_THAT(rotation(5121, std::vector<std::uint8_t>{0, 51, 128, 255}),
              ElementsAre(0.0f, FloatEq(0.2f), FloatEq(128.0f / 255.0f), 1.0f));
  EXPECT_THAT(rotation(5122, std::vector<std::int16_t>{-32768, -32767, 16384, 32767}),
              ElementsAre(-1.0f, -1.0f, FloatEq(16384.0f / 32767.0f), 1.0f));
  EXPECT_THAT(rotation(5123, std::vector<std::uint16_t>{0, 13107, 32768, 65535}),
              ElementsAre(0.0f, FloatEq(0.2f), FloatEq(32768.0f / 65535.0f), 1.0f));
}

TEST(Asset, ReadsInterleavedElementsAtAnOffset) {
  ModelBuilder model = with_times(2);
  const int view = model.view(std::vector<float>{9, 1, 2, 3, 9, 9, 4, 5, 6, 9}, 20);
  model.animate(0, "translation", 0, model.accessor(view, 5126, "VEC3", 2, {{"byteOffset", 4}}));
  EXPECT_THAT(only_curve(model).values, ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(Asset, ReadsSparseElementsOnZerosAndOnData) {
  for (const int type : {5121, 5123, 5125}) {
    ModelBuilder model = with_times(3);
    int indices = -1;
    if (type == 5121) indices = model.view(std::vector<std::uint8_t>{0, 2});
    if (type == 5123) indices = model.view(std::vector<std::uint16_t>{0, 2});
    if (type == 5125) indices = model.view(std::vector<std::uint32_t>{0, 2});
    const int values = model.view(std::vector<float>{1, 2, 3, 4, 5, 6});
    const Json sparse = {{"count", 2},
                         {"indices", {{"bufferView", indices}, {"componentType", type}}},
                         {"values", {{"bufferView", values}}}};
    model.animate(0, "translation", 0, model.accessor(-1, 5126, "VEC3", 3, {{"sparse", sparse}}));
    EXPECT_THAT(only_curve(model).values, ElementsAre(1, 2, 3, 0, 0, 0, 4, 5, 6));

    const int base = model.view(std::vector<float>{7, 7, 7, 8, 8, 8, 9, 9, 9});
    model.json.erase("animations");
    model.animate(0, "scale", 0, model.accessor(base, 5126, "VEC3", 3, {{"sparse", sparse}}));
    EXPECT_THAT(only_curve(model).values, ElementsAre(1, 2, 3, 8, 8, 8, 4, 5, 6));
  }
}

TEST(Asset, RefusesSparseIndicesOutOfOrderOrRange) {
  for (const std::vector<std::uint8_t>& bad : {std::vector<std::uint8_t>{1, 1}, {2, 0}, {0, 3}}) {
    ModelBuilder model = with_times(3);
    const int values = model.view(std::vector<float>(6));
    const Json sparse = {{"count", 2},
                         {"indices", {{"bufferView", model.view(bad)}, {"componentType", 5121}}},
                         {"values", {{"bufferView", values}}}};
    model.animate(0, "translation", 0, model.accessor(-1, 5126, "VEC3", 3, {{"sparse", sparse}}));
    expect_invalid(model, "sparse index");
  }
}

TEST(Asset, KeepsCubicSplinesRaw) {
  ModelBuilder model = with_times(2);
  std::vector<float> values;
  for (int i = 0; i < 18; ++i) values.push_back(static_cast<float>(i));
  model.animate(0, "translation", 0, model.floats("VEC3", 3, values), "CUBICSPLINE");
  const Curve curve = only_curve(model);
  EXPECT_EQ(curve.interpolation, Interpolation::cubic_spline);
  EXPECT_EQ(curve.values, values);
  EXPECT_EQ(curve.width, 3);
}

TEST(Asset, ReadsWeightsAndRestWeights) {
  ModelBuilder model = with_times(2);
  const int position = model.floats("VEC3", 3, {0, 0, 0});
  const Json primitive = {{"attributes", {{"POSITION", position}}},
                          {"targets", {{{"POSITION", position}}, {{"POSITION", position}}}}};
  model.add("meshes", {{"primitives", {primitive}}, {"weights", {0.25, 0.5}}});
  model.json["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"weights", {1, 0}}}};
  model.animate(0, "weights", 0, model.floats("SCALAR", 1, {0, 1, 2, 3}));
  const Curve curve = only_curve(model);
  EXPECT_EQ(curve.width, 2);
  EXPECT_EQ(curve.path, Path::weights);
  EXPECT_THAT(curve.values, ElementsAre(0, 1, 2, 3));
  const Asset asset = read_asset(model.build());
  EXPECT_THAT(asset.nodes[0].weights, ElementsAre(0.25, 0.5));
  EXPECT_THAT(asset.nodes[1].weights, ElementsAre(1, 0));
}

TEST(Asset, LeavesWhatItCannotTake) {
  ModelBuilder model = with_times(2);
  model.add("nodes", Json::object());
  const int moving = model.floats("VEC3", 3, {0, 0, 0, 1, 1, 1});
  const int still = model.floats("VEC3", 3, {2, 2, 2, 2, 2, 2});
  Json animation;
  animation["name"] = "walk";
  animation["samplers"] = {{{"input", 0}, {"output", moving}, {"interpolation", "STEP"}},
                           {{"input", 0}, {"output", still}, {"interpolation", "STEP"}},
                           {{"input", 0}, {"output", moving}},
                           {{"input", 0}, {"output", moving}, {"extensions", {{"EXT_x", Json::object()}}}},
                           {{"input", 0}, {"output", moving}, {"interpolation", "BOUNCE"}}};
  const auto channel = [](int sampler, Json target) {
    return Json{{"sampler", sampler}, {"target", std::move(target)}};
  };
  const Json pointer = {{"path", "pointer"},
                        {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/0/scale"}}}}}};
  animation["channels"] = {channel(2, pointer),
                           channel(0, {{"node", 0}, {"path", "translation"}}),
                           channel(1, {{"node", 0}, {"path", "scale"}}),
                           channel(2, {{"node", 1}, {"path", "translation"}}),
                           channel(3, {{"node", 1}, {"path", "scale"}}),
                           channel(2, {{"path", "scale"}}),
                           channel(2, {{"node", 1}, {"path", "visibility"}}),
                           channel(4, {{"node", 1}, {"path", "rotation"}})};
  model.add("animations", animation);
  const Asset asset = read_asset(model.build());
  ASSERT_EQ(asset.animations.size(), 1u);
  const auto& source = asset.animations[0];
  EXPECT_EQ(source.name, "walk");
  ASSERT_EQ(source.channels.size(), 2u);
  EXPECT_EQ(source.channels[0].channel, 2);
  EXPECT_EQ(source.channels[0].sampler, 1);
  EXPECT_EQ(source.channels[0].curve.interpolation, Interpolation::step);
  EXPECT_EQ(source.channels[1].channel, 3);
  EXPECT_EQ(source.channels[1].curve.node, 1);
  std::vector<int> untouched;
  for (const auto& left : source.untouched) untouched.push_back(left.channel);
  EXPECT_THAT(untouched, ElementsAre(0, 1, 4, 5, 6, 7));
  EXPECT_THAT(source.untouched[0].reason, HasSubstr("KHR_animation_pointer"));
  EXPECT_THAT(source.untouched[1].reason, HasSubstr("STEP"));
  EXPECT_THAT(source.untouched[4].reason, HasSubstr("visibility"));
}

TEST(Asset, RefusesBadTimesAndValues) {
  const auto with_input = [](const std::vector<float>& times) {
    ModelBuilder model;
    model.add("nodes", Json::object());
    model.animate(0, "translation", model.floats("SCALAR", 1, times),
                  model.floats("VEC3", 3, std::vector<float>(3 * times.size())));
    return model;
  };
  expect_invalid(with_input({0, 1, 1}), "animations[0].samplers[0] has times that do not increase at key 2");
  expect_invalid(with_input({-1, 0}), "negative time");
  expect_invalid(with_input({0, std::numeric_limits<float>::quiet_NaN()}), "not a finite number");
  expect_invalid(with_input({0, std::numeric_limits<float>::infinity()}), "not a finite number");

  const auto with_output = [](const char* path, const char* type, int width, const std::vector<float>& values,
                              const char* how = "LINEAR") {
    ModelBuilder model = with_times(2);
    model.animate(0, path, 0, model.floats(type, width, values), how);
    return model;
  };
  expect_invalid(with_output("translation", "VEC3", 3, std::vector<float>(9)),
                 "3 output elements where its 2 keys need 1");
  expect_invalid(with_output("translation", "VEC3", 3, std::vector<float>(6), "CUBICSPLINE"),
                 "2 output elements where its 2 keys need 3");
  expect_invalid(with_output("translation", "VEC4", 4, std::vector<float>(8)), "does not fit the channel's path");
  expect_invalid(with_output("rotation", "VEC4", 4, {0, 0, 0, 1, 0, 0, 0, 0}), "rotation of zero length at key 1");
  expect_invalid(with_output("weights", "SCALAR", 1, {0, 0}), "no morph targets");
  expect_invalid(with_output("scale", "VEC3", 3, {0, 0, 0, 0, 0, std::numeric_limits<float>::quiet_NaN()}),
                 "element 1");
}

TEST(Asset, RefusesBadTargets) {
  ModelBuilder model = with_times(2);
  const int output = model.floats("VEC3", 3, std::vector<float>(6));
  model.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  model.animate(0, "scale", 0, output);
  expect_invalid(model, "node that has a matrix");
  model.json["nodes"][0].erase("matrix");
  Json& channels = model.json["animations"][0]["channels"];
  channels.push_back(Json(channels[0]));
  expect_invalid(model, "animations[0].channels[1] moves the scale of node 0, as another channel");
}

TEST(Asset, RefusesBrokenStructure) {
  const auto edited = [](const char* pointer, const Json& value) {
    ModelBuilder model = with_times(2);
    model.animate(0, "translation", 0, model.floats("VEC3", 3, std::vector<float>(6)));
    model.json[Json::json_pointer(pointer)] = value;
    return model;
  };
  expect_invalid(edited("/accessors/1/count", 3), "accessors[1] needs 3 elements of 12 bytes");
  expect_invalid(edited("/accessors/1/count", 9007199254740991), "accessors[1] needs");
  expect_invalid(edited("/accessors/1/count", 0), "count of 0");
  expect_invalid(edited("/accessors/1/count", -1), "non-negative integer");
  expect_invalid(edited("/accessors/1/count", "2"), "non-negative integer");
  expect_invalid(edited("/accessors/1/byteOffset", 9007199254740991), "accessors[1] needs");
  expect_invalid(edited("/accessors/1/bufferView", 7), "bufferView 7, but there are only 2");
  expect_invalid(edited("/accessors/1/normalized", true), "normalized");
  expect_invalid(edited("/bufferViews/1/byteStride", 4), "more than the byteStride");
  expect_invalid(edited("/bufferViews/1/byteStride", 13), "not a multiple of 4");
  expect_invalid(edited("/bufferViews/1/byteLength", 99), "bufferViews[1] covers bytes");
  expect_invalid(edited("/bufferViews/1/buffer", 1), "bufferViews[1] refers to buffer 1");
  expect_invalid(edited("/animations/0/samplers/0/input", 9), "animations[0].samplers[0] refers to input 9");
  expect_invalid(edited("/animations/0/channels/0/sampler", 1), "animations[0].channels[0] refers to sampler 1");
  expect_invalid(edited("/animations/0/channels/0/target/node", 1), "node 1");
  expect_invalid(edited("/animations/0/channels", Json::array()), "animations[0] has no channels");
  expect_invalid(edited("/nodes/0/children", {0}), "nodes[0] is its own ancestor");
  expect_invalid(edited("/nodes/0/children", {5}), "refers to child 5");
  expect_invalid(edited("/nodes/0/rotation", {1, 1, 1, 1}), "unit quaternion");
  expect_invalid(edited("/nodes/0/scale", {1, 1}), "not 3 numbers");
  expect_invalid(edited("/nodes/0/mesh", 0), "refers to mesh 0");
  expect_invalid(edited("/nodes", Json::array()), "empty");
  expect_invalid(edited("/skins", {{{"joints", {3}}}}), "skins[0] refers to joint 3");
  expect_invalid(edited("/skins", {{{"joints", {0}}, {"inverseBindMatrices", 1}}}), "inverseBindMatrices that are not");
}

TEST(Asset, OrdersAVeryDeepHierarchyAndRefusesItsCycle) {
  ModelBuilder model;
  constexpr int count = sanitized ? 40000 : 100000;  // a recursion's frames are larger with sanitizers
  for (int i = 0; i < count; ++i) model.add("nodes", i == 0 ? Json::object() : Json{{"children", {i - 1}}});
  const Asset asset = read_asset(model.build());
  ASSERT_EQ(asset.order.size(), static_cast<std::size_t>(count));
  EXPECT_EQ(asset.order.front(), count - 1);
  EXPECT_EQ(asset.order.back(), 0);
  EXPECT_EQ(asset.nodes[0].parent, 1);
  model.json["nodes"][0]["children"] = {count - 1};
  expect_invalid(model, "its own ancestor");
}

TEST(Asset, RefusesANodeWithTwoParents) {
  ModelBuilder model;
  model.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, Json::object()};
  expect_invalid(model, "nodes[1] has the child 2, which nodes[0] has already");
}

TEST(Asset, UnpacksMeshopt) {
  constexpr std::size_t keys = 100;
  std::vector<float> values;
  for (std::size_t i = 0; i < 4 * keys; ++i) values.push_back(0.001f * static_cast<float>((i * 7919) % 1000) + 0.1f);
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(keys, 16));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), values.data(), keys, 16));

  ModelBuilder model = with_times(keys);
  const int view = model.view(packed);
  Json& json = model.json["bufferViews"][static_cast<std::size_t>(view)];
  const Json extension = {{"buffer", 0},
                          {"byteOffset", json["byteOffset"]},
                          {"byteLength", packed.size()},
                          {"byteStride", 16},
                          {"count", keys},
                          {"mode", "ATTRIBUTES"}};
  // The view itself lies in a placeholder buffer without bytes.
  json = {{"buffer", 1}, {"byteLength", 16 * keys}, {"extensions", {{"EXT_meshopt_compression", extension}}}};
  model.animate(0, "rotation", 0, model.accessor(view, 5126, "VEC4", keys));
  nmc::gltf::Document document;
  {
    ModelBuilder without = model;
    without.json.erase("bufferViews");
    document = without.build();
    document.json["bufferViews"] = model.json["bufferViews"];
    document.json["buffers"].push_back({{"byteLength", 16 * keys}});
    document.buffers.emplace_back();
    document.has_data.push_back(false);
  }
  EXPECT_EQ(read_asset(document).animations.at(0).channels.at(0).curve.values, values);

  auto broken = [&](const char* key, const Json& value) {
    nmc::gltf::Document copy = document;
    copy.json["bufferViews"][static_cast<std::size_t>(view)]["extensions"]["EXT_meshopt_compression"][key] = value;
    return error_of([&] { read_asset(copy); });
  };
  EXPECT_THAT(broken("count", 1000000000).what(), HasSubstr("bufferViews[1] unpacks to"));
  EXPECT_THAT(broken("byteLength", packed.size() - 9).what(), HasSubstr("does not decode"));
  EXPECT_THAT(broken("byteStride", 6).what(), HasSubstr("byteStride"));
  EXPECT_THAT(broken("byteOffset", 1000000).what(), HasSubstr("outside buffers[0]"));
  EXPECT_THAT(broken("filter", "OCTAHEDRAL").what(), HasSubstr("does not fit its mode and filter"));
  EXPECT_EQ(broken("mode", "WAVELETS").code(), ErrorCode::unsupported);
}

}  // namespace
