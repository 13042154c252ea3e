// The points at which error is seen, on meshes made by hand.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "gltf/asset.h"
#include "gltf/model_builder.h"

namespace {

using nmc::ErrorCode;
using nmc::Influence;
using nmc::Points;
using nmc::gltf::Json;
using nmc::gltf::read_asset;
using nmc::test::error_of;
using nmc::test::ModelBuilder;
using testing::HasSubstr;

/// A point as node -> (weight, offset), for comparison in any order.
using Point = std::vector<std::array<double, 5>>;

Point point(const Points& points, std::size_t index) {
  Point out;
  for (std::size_t i = points.first[index]; i < points.first[index + 1]; ++i) {
    const Influence& influence = points.influences[i];
    out.push_back({static_cast<double>(influence.node), influence.weight, influence.offset[0], influence.offset[1],
                   influence.offset[2]});
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<Point> all_points(const Points& points) {
  std::vector<Point> out;
  for (std::size_t i = 0; i < points.size(); ++i) out.push_back(point(points, i));
  std::sort(out.begin(), out.end());
  return out;
}

Points find_points(const nmc::gltf::Document& document, bool all_vertices = false) {
  return skin_points(document, read_asset(document), all_vertices);
}

/// Two joints, nodes 1 and 2 (2 at (1, 0, 0) below 1), and a mesh on node 0 whose skin has them.
struct Arm {
  ModelBuilder model;
  Json attributes;

  explicit Arm(const std::vector<float>& positions, const std::vector<std::uint8_t>& joints,
               const std::vector<float>& weights) {
    const std::size_t count = positions.size() / 3;
    model.json["nodes"] = {
        {{"mesh", 0}, {"skin", 0}, {"translation", {50, 60, 70}}}, {{"children", {2}}}, {{"translation", {1, 0, 0}}}};
    const int matrices = model.floats(
        "MAT4", 16, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1});
    model.add("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", matrices}});
    attributes["POSITION"] = model.floats("VEC3", 3, positions);
    attributes["JOINTS_0"] = model.accessor(model.view(joints), 5121, "VEC4", count);
    attributes["WEIGHTS_0"] = model.floats("VEC4", 4, weights);
  }

  nmc::gltf::Document build() {
    model.json["meshes"] = {{{"primitives", {{{"attributes", attributes}}}}}};
    return model.build();
  }
};

const Point joint_1{{1, 1, 0, 0, 0}};
const Point joint_2{{2, 1, 0, 0, 0}};

TEST(SkinPoints, HoldJointsAndVerticesWithAllInfluences) {
  Arm arm({0, 1, 0, 1, 1, 0, 2, 1, 0}, {0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0},
          {1, 0, 0, 0, 0.75f, 0.25f, 0, 0, 2, 0, 0, 0});
  const std::vector<Point> points = all_points(find_points(arm.build()));
  // The second vertex is at (1, 1, 0) for joint 1 and at (0, 1, 0) for joint 2; the third has its weight of 2
  // normalised.
  const std::vector<Point> expected{
      joint_1, {{1, 0.75, 1, 1, 0}, {2, 0.25, 0, 1, 0}}, {{1, 1, 0, 1, 0}}, joint_2, {{2, 1, 1, 1, 0}}};
  std::vector<Point> sorted = expected;
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(points, sorted);
}

TEST(SkinPoints, OutermostVerticesStandForTheRest) {
  // A ball of vertices on joint 1: those on the axes are outermost along them.
  std::vector<float> positions{3, 0, 0, -3, 0, 0, 0, 3, 0, 0, -3, 0, 0, 0, 3, 0, 0, -3};
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        for (const int value : {x, y, z}) positions.push_back(static_cast<float>(value) * 0.5f);
      }
    }
  }
  const std::size_t count = positions.size() / 3;
  std::vector<float> weights;
  for (std::size_t i = 0; i < count; ++i) weights.insert(weights.end(), {1, 0, 0, 0});
  Arm arm(positions, std::vector<std::uint8_t>(4 * count, 0), weights);
  const nmc::gltf::Document document = arm.build();
  const std::vector<Point> points = all_points(find_points(document));
  EXPECT_EQ(points.size(), 2u + 6u);
  for (std::size_t i = 0; i < 18; i += 3) {
    const Point vertex{{1, 1, positions[i], positions[i + 1], positions[i + 2]}};
    EXPECT_TRUE(std::find(points.begin(), points.end(), vertex) != points.end()) << i / 3;
  }
  EXPECT_EQ(find_points(document, true).size(), 2 + count);
}

TEST(SkinPoints, AJointWithSmallWeightsOnlyStillHasItsVertices) {
  Arm arm({0, 1, 0, 1, 5, 0}, {0, 1, 0, 0, 0, 1, 0, 0}, {0.9f, 0.1f, 0, 0, 0.95f, 0.05f, 0, 0});
  // Joint 2 moves nothing by 0.25; the vertex that it moves most and the one where weight times distance is largest
  // count.
  EXPECT_EQ(find_points(arm.build()).size(), 4u);
}

TEST(SkinPoints, SeamsAndSharedMeshesCountOnce) {
  Arm arm({0, 1, 0, 0, 1, 0, 0, 1, 0}, std::vector<std::uint8_t>(12, 0), {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  arm.model.add("nodes", {{"mesh", 0}, {"skin", 0}});
  EXPECT_EQ(find_points(arm.build()).size(), 3u);
  EXPECT_EQ(find_points(arm.build(), true).size(), 3u);
}

TEST(SkinPoints, ReadMoreThanFourInfluencesAndQuantisedMeshes) {
  Arm arm({0, 1, 0}, {0, 0, 0, 0}, {0.5f, 0, 0, 0});
  arm.model.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  arm.attributes["POSITION"] = arm.model.accessor(arm.model.view(std::vector<std::int16_t>{32767, -32768, 0, 0}), 5122,
                                                  "VEC3", 1, {{"normalized", true}});
  arm.attributes["JOINTS_1"] =
      arm.model.accessor(arm.model.view(std::vector<std::uint16_t>{1, 0, 0, 0}), 5123, "VEC4", 1);
  arm.attributes["WEIGHTS_1"] = arm.model.accessor(arm.model.view(std::vector<std::uint8_t>{255, 0, 0, 0}), 5121,
                                                   "VEC4", 1, {{"normalized", true}});
  const std::vector<Point> points = all_points(find_points(arm.build()));
  ASSERT_EQ(points.size(), 3u);
  const Point& vertex = points[0] == joint_1 ? points[1] : points[0];
  ASSERT_EQ(vertex.size(), 2u);
  EXPECT_EQ(vertex[0], (std::array<double, 5>{1, 0.5 / 1.5, 1, -1, 0}));
  EXPECT_EQ(vertex[1], (std::array<double, 5>{2, 1 / 1.5, 0, -1, 0}));
}

TEST(SkinPoints, RefuseJointsThatTheSkinDoesNotHave) {
  Arm arm({0, 1, 0}, {2, 0, 0, 0}, {1, 0, 0, 0});
  const nmc::Error error = error_of([&] { find_points(arm.build()); });
  EXPECT_EQ(error.code(), ErrorCode::invalid_input);
  EXPECT_THAT(error.what(), HasSubstr("meshes[0].primitives[0] binds vertex 0 to joint 2 of a skin with 2"));
}

/// Node 0 moves, node 1 is below it with a mesh, node 2 is still with the same mesh.
ModelBuilder rigid_model() {
  ModelBuilder model;
  model.json["nodes"] = {{{"children", {1}}}, {{"mesh", 0}}, {{"mesh", 0}}};
  const int position = model.floats("VEC3", 3, {1, 2, 3, -1, -2, -3, 0, 0, 0, 0.5f, 1, 1.5f});
  const int deltas = model.floats("VEC3", 3, {0, 0, 0, 3, 4, 0, 0, 0, 1, 0, 0, 0});
  const int sparse_deltas = model.accessor(
      -1, 5126, "VEC3", 4,
      {{"sparse",
        {{"count", 1},
         {"indices", {{"bufferView", model.view(std::vector<std::uint8_t>{3})}, {"componentType", 5121}}},
         {"values", {{"bufferView", model.view(std::vector<float>{0, -2, 0})}}}}}});
  model.add("meshes", {{"primitives",
                        {{{"attributes", {{"POSITION", position}}},
                          {"targets", {{{"POSITION", deltas}}, {{"POSITION", sparse_deltas}}}}}}}});
  model.animate(0, "translation", model.floats("SCALAR", 1, {0, 1}), model.floats("VEC3", 3, {0, 0, 0, 1, 0, 0}));
  return model;
}

TEST(SkinPoints, WithoutASkinAnimatedNodesAndTheirMeshesAreThePoints) {
  const nmc::gltf::Document document = rigid_model().build();
  const std::vector<Point> points = all_points(find_points(document));
  const std::vector<Point> corners{{{0, 1, 0, 0, 0}}, {{1, 1, -1, -2, -3}}, {{1, 1, 0, 0, 0}}, {{1, 1, 1, 2, 3}}};
  for (const Point& corner : corners) EXPECT_TRUE(std::find(points.begin(), points.end(), corner) != points.end());
  for (const Point& found : points) EXPECT_NE(found[0][0], 2) << "the still node";
  EXPECT_EQ(find_points(document, true).size(), 2u + 4u);
}

TEST(SkinPoints, TellHowFarMorphTargetsReach) {
  const Points points = find_points(rigid_model().build());
  ASSERT_EQ(points.morphs.size(), 4u);
  EXPECT_EQ(points.morphs[0].node, 1);
  EXPECT_EQ(points.morphs[0].target, 0);
  EXPECT_DOUBLE_EQ(points.morphs[0].reach, 5.0);
  EXPECT_EQ(points.morphs[1].target, 1);
  EXPECT_DOUBLE_EQ(points.morphs[1].reach, 2.0);
  EXPECT_EQ(points.morphs[2].node, 2);
}

TEST(SkinPoints, MorphsOfAQuantisedSkinReachAsFarAsTheSkinMovesThem) {
  Arm arm({0, 1, 0}, {0, 0, 0, 0}, {1, 0, 0, 0});
  const int deltas = arm.model.floats("VEC3", 3, {0, 2, 0});
  const int matrices = arm.model.floats("MAT4", 16, {10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 1,
                                                     10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 1});
  arm.model.json["skins"][0]["inverseBindMatrices"] = matrices;
  arm.model.json["nodes"][0]["scale"] = {4, 4, 4};
  arm.model.json["meshes"] = {
      {{"primitives", {{{"attributes", arm.attributes}, {"targets", {{{"POSITION", deltas}}}}}}}}};
  const Points points = find_points(arm.model.build());
  ASSERT_EQ(points.morphs.size(), 1u);
  // World length 2 * 10; the node's scale of 4 turns the reach into that.
  EXPECT_DOUBLE_EQ(points.morphs[0].reach, 5.0);
}

/// The arm's mesh as a Draco stream; the attribute ids are 0 (POSITION), 1 (JOINTS_0), 2 (WEIGHTS_0).
std::vector<std::uint8_t> draco_stream(const std::vector<float>& positions, const std::vector<std::uint8_t>& joints,
                                       const std::vector<float>& weights, int method) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int joint = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_UINT8);
  const int weight = builder.AddAttribute(draco::GeometryAttribute::GENERIC, 4, draco::DT_FLOAT32);
  const draco::FaceIndex face(0);
  builder.SetAttributeValuesForFace(position, face, &positions[0], &positions[3], &positions[6]);
  builder.SetAttributeValuesForFace(joint, face, &joints[0], &joints[4], &joints[8]);
  builder.SetAttributeValuesForFace(weight, face, &weights[0], &weights[4], &weights[8]);
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

/// The arm with its attributes in a Draco stream, as files have it: accessors without a bufferView.
Arm packed_arm(const std::vector<float>& positions, const std::vector<std::uint8_t>& joints,
               const std::vector<float>& weights, int method) {
  Arm arm(positions, joints, weights);
  const int view = arm.model.view(draco_stream(positions, joints, weights, method));
  for (auto& [semantic, accessor] : arm.attributes.items()) {
    arm.model.json["accessors"][accessor.get<std::size_t>()].erase("bufferView");
  }
  arm.model.json["meshes"] = {
      {{"primitives",
        {{{"attributes", arm.attributes},
          {"extensions",
           {{"KHR_draco_mesh_compression",
             {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"JOINTS_0", 1}, {"WEIGHTS_0", 2}}}}}}}}}}}};
  return arm;
}

const std::vector<float> triangle{0, 1, 0, 1, 1, 0.25f, 2, 1, 0};
const std::vector<std::uint8_t> triangle_joints{0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0};
const std::vector<float> triangle_weights{1, 0, 0, 0, 0.75f, 0.25f, 0, 0, 1, 0, 0, 0};

TEST(SkinPoints, UnpackDracoMeshes) {
  const std::vector<Point> expected =
      all_points(find_points(Arm(triangle, triangle_joints, triangle_weights).build(), true));
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    Arm arm = packed_arm(triangle, triangle_joints, triangle_weights, method);
    EXPECT_EQ(all_points(find_points(arm.model.build(), true)), expected) << method;
  }
}

TEST(SkinPoints, RefuseDracoThatDoesNotFit) {
  Arm arm = packed_arm(triangle, triangle_joints, triangle_weights, draco::MESH_EDGEBREAKER_ENCODING);
  const nmc::gltf::Document document = arm.model.build();
  const auto broken = [&](auto edit) {
    nmc::gltf::Document copy = document;
    edit(copy, copy.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]);
    const nmc::Error error = error_of([&] { find_points(copy); });
    EXPECT_EQ(error.code(), ErrorCode::invalid_input) << error.what();
    EXPECT_THAT(error.what(), HasSubstr("meshes[0].primitives[0]"));
    return std::string(error.what());
  };
  EXPECT_THAT(broken([](auto&, Json& draco) { draco["attributes"]["POSITION"] = 7; }),
              HasSubstr("attribute 7, which does not exist"));
  EXPECT_THAT(broken([](auto&, Json& draco) { draco["attributes"]["POSITION"] = 1; }),
              HasSubstr("4 numbers per vertex"));
  EXPECT_THAT(broken([](auto&, Json& draco) { draco["bufferView"] = 99; }), HasSubstr("bufferView 99"));
  EXPECT_THAT(broken([](auto& copy, Json&) {
                for (Json& accessor : copy.json["accessors"]) {
                  if (!accessor.contains("bufferView")) accessor["count"] = 4;
                }
              }),
              HasSubstr("3 vertices in its Draco data, but its accessors have 4"));
  const std::size_t view =
      document.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["bufferView"];
  const std::size_t start = document.json["bufferViews"][view]["byteOffset"];
  const std::size_t end = document.buffers[0].size();
  // Whatever byte changes: a sentence or points, never a crash.
  for (std::size_t at = start; at < end; ++at) {
    for (const int flip : {1, 128, 255}) {
      nmc::gltf::Document copy = document;
      copy.buffers[0][at] = static_cast<std::uint8_t>(copy.buffers[0][at] ^ flip);
      try {
        find_points(copy);
      } catch (const nmc::Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::invalid_input) << error.what();
      }
    }
  }
}

TEST(SkinPoints, RealCharactersHaveSkin) {
  const std::filesystem::path data = std::filesystem::path(NMC_SHARED_DIR) / "data";
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no shared data";
  for (const char* name :
       {"game/fox.glb", "game/knight_76clips.glb", "odd/Fox_cc_af0.glb", "odd/MorphStressTest.glb"}) {
    const nmc::gltf::Document document = nmc::gltf::read_document(data / name);
    const nmc::gltf::Asset asset = read_asset(document);
    const Points points = skin_points(document, asset);
    const Points all = skin_points(document, asset, true);
    std::size_t joints = 0;
    for (const auto& skin : asset.skins) joints += skin.joints.size();
    EXPECT_GE(points.size(), joints + (joints > 0 ? 20 : 0)) << name;
    EXPECT_LE(points.size(), joints + 15 * asset.nodes.size()) << name;
    EXPECT_GE(all.size(), points.size()) << name;
    for (std::size_t i = 0; i < all.size(); ++i) {
      double sum = 0;
      for (std::size_t k = all.first[i]; k < all.first[i + 1]; ++k) sum += all.influences[k].weight;
      ASSERT_NEAR(sum, 1.0, 1e-12);
    }
  }
}

}  // namespace
