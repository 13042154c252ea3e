// Meshes packed with Draco: the tolerance holds over mesh and animation together, measured by skinning both files'
// meshes with both files' animations; what cannot be packed stays.
#include "codec/mesh_packing.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <span>

#include "motion/pose.h"
#include "samples/characters.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using codec::CompressResult;

/// A sample character with its first `animations` alone.
gltf::Document character(std::size_t animations) {
  gltf::Document document = gltf::parse_document(samples::make_character("humanoid_30hz.glb"), "humanoid.glb", {});
  gltf::Json& list = document.json["animations"];
  while (list.size() > animations) list.erase(list.size() - 1);
  if (list.empty()) document.json.erase("animations");
  return document;
}

CompressResult pack(const gltf::Document& document, double tolerance, const gltf::DracoBits& bits = {}) {
  codec::CompressOptions options;
  options.effort = 1;
  options.tolerance.value = (1 - codec::mesh_share) * tolerance;
  CompressResult result = codec::compress(document, options);
  codec::pack_meshes(document, bits, result);
  return result;
}

struct Body {
  motion::Skeleton skeleton;
  Points points;
  std::vector<Animation> animations;
};

Body body_of(const gltf::Document& document) {
  const gltf::Asset asset = gltf::read_asset(document);
  return {codec::make_skeleton(asset), gltf::skin_points(document, asset, true),
          codec::all_animations(document, asset)};
}

std::vector<glm::dvec3> places(const Points& points, std::span<const glm::dmat4> world) {
  std::vector<glm::dvec3> places(points.size(), glm::dvec3(0.0));
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (std::uint32_t i = points.first[p]; i < points.first[p + 1]; ++i) {
      const Influence& influence = points.influences[i];
      const glm::dvec4 offset(influence.offset[0], influence.offset[1], influence.offset[2], 1.0);
      places[p] += influence.weight * glm::dvec3(world[static_cast<std::size_t>(influence.node)] * offset);
    }
  }
  return places;
}

/// For each point of `from` the nearest of `to`, and the largest distance.
std::pair<std::vector<std::size_t>, double> nearest(const std::vector<glm::dvec3>& from,
                                                    const std::vector<glm::dvec3>& to) {
  std::vector<std::size_t> found;
  double largest = 0;
  for (const glm::dvec3& point : from) {
    std::size_t best = 0;
    double least = std::numeric_limits<double>::max();
    // Written out: the functions of a vector take most of a test's time where nothing is optimised.
    for (std::size_t i = 0; i < to.size(); ++i) {
      const glm::dvec3& other = to[i];
      const double x = other.x - point.x, y = other.y - point.y, z = other.z - point.z;
      const double square = x * x + y * y + z * z;
      if (square >= least) continue;
      least = square;
      best = i;
    }
    found.push_back(best);
    largest = std::max(largest, std::sqrt(least));
  }
  return {found, largest};
}

TEST(MeshPacking, TheToleranceHoldsOverMeshAndAnimation) {
  const gltf::Document original = character(1);
  constexpr double tolerance = 0.01;
  const CompressResult result = pack(original, tolerance);
  EXPECT_NEAR(result.tolerance, tolerance * result.size, 1e-9);
  const gltf::Document packed = gltf::parse_document(gltf::to_glb(result.document), "packed.glb", {});
  ASSERT_THAT(gltf::to_glb(packed).size(), testing::Lt(gltf::to_glb(original).size()));
  const Body before = body_of(original), after = body_of(packed);
  const motion::PoseReader rest_before(before.skeleton, {}), rest_after(after.skeleton, {});
  const auto [match, at_rest] =
      nearest(places(before.points, rest_before.world()), places(after.points, rest_after.world()));
  EXPECT_GT(at_rest, 0.0);
  EXPECT_LE(at_rest, codec::mesh_share * result.tolerance);
  double largest = 0;
  for (std::size_t a = 0; a < before.animations.size(); ++a) {
    motion::PoseReader one(before.skeleton, before.animations[a]), two(after.skeleton, after.animations[a]);
    for (const float t : before.animations[a].curves.front().times) {
      one.read(static_cast<double>(t));
      two.read(static_cast<double>(t));
      const auto x = places(before.points, one.world()), y = places(after.points, two.world());
      for (std::size_t p = 0; p < x.size(); ++p) largest = std::max(largest, glm::distance(x[p], y[match[p]]));
    }
  }
  EXPECT_GT(largest, at_rest);
  EXPECT_LE(largest, result.tolerance);
}

TEST(MeshPacking, TakesMoreBitsWhereTheyAreNeeded) {
  gltf::DracoBits coarse;
  coarse.position = 2;
  coarse.weight = 2;
  const gltf::Document original = character(0);
  const CompressResult result = pack(original, 0.01, coarse);
  const Body before = body_of(original), after = body_of(result.document);
  const motion::PoseReader rest_before(before.skeleton, {}), rest_after(after.skeleton, {});
  const double moved =
      nearest(places(before.points, rest_before.world()), places(after.points, rest_after.world())).second;
  EXPECT_LE(moved, codec::mesh_share * result.tolerance);
}

TEST(MeshPacking, LeavesMorphTargetsAndSmallMeshesAlone) {
  TinyGlb small;
  small.json["nodes"][2].erase("skin");
  for (const char* semantic : {"JOINTS_0", "WEIGHTS_0"})
    small.json["meshes"][0]["primitives"][0]["attributes"].erase(semantic);
  const gltf::Document tiny = gltf::parse_document(small.bytes(), "tiny.glb", {});
  const CompressResult kept = pack(tiny, 0.01);
  EXPECT_EQ(kept.document.json["meshes"], tiny.json["meshes"]);
  EXPECT_THAT(kept.notes, testing::Contains(testing::HasSubstr("would not become smaller")));

  TinyGlb morphed;
  const std::size_t delta = morphed.add(std::vector<float>(30, 0.1F), 5126, "VEC3", 3);
  morphed.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", delta}}};
  const CompressResult result = pack(gltf::parse_document(morphed.bytes(), "morphed.glb", {}), 0.01);
  EXPECT_THAT(result.notes, testing::Contains(testing::HasSubstr("have morph targets")));
  EXPECT_FALSE(result.document.json["meshes"][0]["primitives"][0].contains("extensions"));
}

TEST(MeshPacking, IsTheSameEachTime) {
  const gltf::Document original = character(0);
  EXPECT_EQ(gltf::to_glb(pack(original, 0.05).document), gltf::to_glb(pack(original, 0.05).document));
}

}  // namespace
}  // namespace nmc::test
