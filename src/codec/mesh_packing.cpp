#include "codec/mesh_packing.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>
#include <set>
#include <span>

#include "gltf/asset.h"
#include "motion/pose.h"

namespace nmc::codec {
namespace {

/// What poses make of errors in meshes.
struct Reach {
  std::vector<double> growth;  ///< per mesh: world units per unit of the mesh
  double spread = 0;           ///< how far a vertex is from where one of its joints alone would have it, world units
};

double largest_scale(const glm::dmat4& m) {
  return std::max({glm::length(glm::dvec3(m[0])), glm::length(glm::dvec3(m[1])), glm::length(glm::dvec3(m[2]))});
}

/// A box that is sheared by scaled ancestors grows by less than this in any direction, by largest_scale's measure.
constexpr double shear = 1.7320508075688772;

void raise_growth(const gltf::Asset& asset, std::span<const glm::dmat4> world, Reach& reach) {
  for (std::size_t n = 0; n < asset.nodes.size(); ++n) {
    const gltf::Node& node = asset.nodes[n];
    if (node.mesh < 0) continue;
    double& growth = reach.growth[static_cast<std::size_t>(node.mesh)];
    if (node.skin < 0) {
      growth = std::max(growth, shear * largest_scale(world[n]));
      continue;
    }
    const gltf::Skin& skin = asset.skins[static_cast<std::size_t>(node.skin)];
    for (std::size_t j = 0; j < skin.joints.size(); ++j) {
      const glm::dmat4 bind = glm::make_mat4(skin.inverse_bind[j].data());
      growth = std::max(growth, shear * largest_scale(world[static_cast<std::size_t>(skin.joints[j])] * bind));
    }
  }
}

void raise_spread(const Points& points, std::span<const glm::dmat4> world, Reach& reach) {
  std::vector<glm::dvec3> places;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const std::span all(points.influences);
    const auto influences = all.subspan(points.first[p], points.first[p + 1] - points.first[p]);
    if (influences.size() < 2) continue;
    places.clear();
    glm::dvec3 blended(0.0);
    for (const Influence& influence : influences) {
      const glm::dvec4 offset(influence.offset[0], influence.offset[1], influence.offset[2], 1.0);
      places.emplace_back(world[static_cast<std::size_t>(influence.node)] * offset);
      blended += influence.weight * places.back();
    }
    for (const glm::dvec3& place : places) reach.spread = std::max(reach.spread, glm::distance(place, blended));
  }
}

/// Every vertex where the work allows it, else the outermost of each joint.
Points points_for(const gltf::Document& document, const gltf::Asset& asset) {
  constexpr std::size_t most_work = 200'000'000;
  std::size_t keys = 1;
  for (const gltf::AnimationSource& animation : asset.animations) {
    std::size_t most = 0;
    for (const gltf::Channel& channel : animation.channels) most = std::max(most, channel.curve.times.size());
    keys += most;
  }
  Points all = gltf::skin_points(document, asset, true);
  return all.influences.size() * keys <= most_work ? all : gltf::skin_points(document, asset);
}

Reach reach_of(const gltf::Document& document, const gltf::Asset& asset) {
  const motion::Skeleton skeleton = make_skeleton(asset);
  const Points points = points_for(document, asset);
  Reach reach;
  reach.growth.assign(document.json.contains("meshes") ? document.json["meshes"].size() : 0, 0.0);
  const auto raise = [&](std::span<const glm::dmat4> world) {
    raise_growth(asset, world, reach);
    raise_spread(points, world, reach);
  };
  const Animation rest;
  raise(motion::PoseReader(skeleton, rest).world());
  for (const gltf::AnimationSource& source : asset.animations) {
    Animation animation;
    std::set<float> times;
    const auto add = [&](const Curve& curve) {
      if (curve.node < 0) return;
      animation.curves.push_back(curve);
      times.insert(curve.times.begin(), curve.times.end());
    };
    for (const gltf::Channel& channel : source.channels) add(channel.curve);
    for (const gltf::UntouchedChannel& channel : source.untouched) add(channel.curve);
    motion::PoseReader reader(skeleton, animation);
    for (const float t : times) {
      reader.read(static_cast<double>(t));
      raise(reader.world());
    }
  }
  return reach;
}

}  // namespace

void pack_meshes(const gltf::Document& original, const gltf::DracoBits& bits, CompressResult& result) {
  result.tolerance /= 1 - mesh_share;
  const gltf::Asset asset = gltf::read_asset(original);
  const Reach reach = reach_of(original, asset);
  double largest = 0;
  const auto fits = [&](std::size_t mesh, const gltf::DracoError& error) {
    const double moved = reach.growth[mesh] * error.position + reach.spread * error.weight;
    if (!(moved <= mesh_share * result.tolerance)) return false;
    largest = std::max(largest, moved);
    return true;
  };
  const gltf::DracoResult packed = gltf::pack_meshes(result.document, bits, fits);
  result.notes.push_back(
      fmt::format("{} primitives of meshes packed with Draco, {} to {} bytes; that moves no vertex by "
                  "more than {:.3g}% of the tolerance",
                  packed.packed, packed.bytes_before, packed.bytes_after, 100 * largest / result.tolerance));
  for (const auto& [reason, count] : packed.left)
    result.notes.push_back(fmt::format("{} primitives of meshes {} and stay as they are", count, reason));
}

}  // namespace nmc::codec
