// Finds the points at which error is seen: joints, the skin, and what hangs on animated nodes.
#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <map>
#include <set>

#include "base/error.h"
#include "gltf/asset.h"
#include "gltf/json_text.h"
#include "gltf/typed_model.h"
#include "gltf/vertices.h"

namespace nmc::gltf {
namespace {

constexpr std::array<double, 16> identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// Nodes can share meshes, so that a small file could ask for any number of points.
constexpr std::size_t most_influences = std::size_t{1} << 26;

/// Everything that the search reads, and the points that it has found.
struct Search {
  const Document& document;
  const Asset& asset;
  const tinygltf::Model& model;
  bool all_vertices = false;
  Points points;
};

void add_point(Search& search, const std::vector<Influence>& influences) {
  if (search.points.influences.size() + influences.size() > most_influences) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: the meshes on animated nodes have too many vertices.", search.document.name));
  }
  search.points.add(influences.data(), influences.data() + influences.size());
}

std::vector<std::size_t> choose(const Search& search, const Vertices& vertices,
                                std::span<const std::array<double, 16>> inverse_bind) {
  return search.all_vertices ? distinct_vertices(vertices) : extreme_vertices(vertices, inverse_bind);
}

void add_joint_origins(Search& search) {
  std::set<int> seen;
  for (const Skin& skin : search.asset.skins) {
    for (const int joint : skin.joints) {
      if (seen.insert(joint).second) add_point(search, {{joint, {0, 0, 0}, 1.0}});
    }
  }
}

/// The meshes that a skin moves, each once: where the nodes are makes no difference to a skinned mesh (glTF 2.0,
/// section 3.7.3.3).
std::set<int> meshes_of_skin(const Asset& asset, int skin) {
  std::set<int> meshes;
  for (const Node& node : asset.nodes) {
    if (node.skin == skin && node.mesh >= 0) meshes.insert(node.mesh);
  }
  return meshes;
}

void add_skin_vertices(Search& search, std::size_t skin_index) {
  const Skin& skin = search.asset.skins[skin_index];
  Vertices vertices;
  for (const int mesh : meshes_of_skin(search.asset, static_cast<int>(skin_index))) {
    add_skinned_vertices(search.model, mesh, skin, search.document.name, vertices);
  }
  std::vector<Influence> influences;
  for (const std::size_t vertex : choose(search, vertices, skin.inverse_bind)) {
    influences.clear();
    for (const Binding& binding : vertices.bindings_of(vertex)) {
      const auto joint = static_cast<std::size_t>(binding.joint);
      influences.push_back(
          {skin.joints[joint], transform(skin.inverse_bind[joint], vertices.positions[vertex]), binding.weight});
    }
    add_point(search, influences);
  }
}

/// Nodes that a channel moves, taken by the asset or left untouched, and all below them.
std::vector<bool> find_moving(const Document& document, const Asset& asset) {
  std::vector<bool> moving(asset.nodes.size(), false);
  const Json* animations = find(document.json, "animations");
  for (std::size_t a = 0; a < asset.animations.size(); ++a) {
    for (const Json& channel : (*animations)[a]["channels"]) {
      const Json& target = channel["target"];
      const Json* node = find(target, "node");
      if (node != nullptr && target["path"] != "weights") moving[static_cast<std::size_t>(node->get<double>())] = true;
    }
  }
  for (const int node : asset.order) {
    const int parent = asset.nodes[static_cast<std::size_t>(node)].parent;
    if (parent >= 0 && moving[static_cast<std::size_t>(parent)]) moving[static_cast<std::size_t>(node)] = true;
  }
  return moving;
}

void add_rigid_points(Search& search) {
  const std::vector<bool> moving = find_moving(search.document, search.asset);
  std::map<int, std::vector<std::array<double, 3>>> offsets_of_mesh;
  for (std::size_t i = 0; i < moving.size(); ++i) {
    if (!moving[i]) continue;
    const Node& node = search.asset.nodes[i];
    const int index = static_cast<int>(i);
    if (search.asset.skins.empty()) add_point(search, {{index, {0, 0, 0}, 1.0}});
    if (node.mesh < 0 || node.skin >= 0) continue;
    const auto [offsets, is_new] = offsets_of_mesh.try_emplace(node.mesh);
    if (is_new) {
      const Vertices vertices = rigid_vertices(search.model, node.mesh, search.document.name);
      for (const std::size_t vertex : choose(search, vertices, {&identity, 1})) {
        offsets->second.push_back(transform(identity, vertices.positions[vertex]));
      }
    }
    for (const std::array<double, 3>& offset : offsets->second) add_point(search, {{index, offset, 1.0}});
  }
}

glm::dmat4 local_matrix(const Node& node) {
  if (node.has_matrix) return glm::make_mat4(node.matrix.data());
  const glm::dquat rotation(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
  const glm::dmat4 translation = glm::translate(glm::dmat4(1.0), glm::make_vec3(node.translation.data()));
  return translation * glm::mat4_cast(rotation) * glm::scale(glm::dmat4(1.0), glm::make_vec3(node.scale.data()));
}

std::vector<glm::dmat4> rest_world(const Asset& asset) {
  std::vector<glm::dmat4> world(asset.nodes.size(), glm::dmat4(1.0));
  for (const int index : asset.order) {
    const auto i = static_cast<std::size_t>(index);
    const int parent = asset.nodes[i].parent;
    world[i] = (parent < 0 ? glm::dmat4(1.0) : world[static_cast<std::size_t>(parent)]) * local_matrix(asset.nodes[i]);
  }
  return world;
}

double largest_scale(const glm::dmat4& m) {
  return std::max({glm::length(glm::dvec3(m[0])), glm::length(glm::dvec3(m[1])), glm::length(glm::dvec3(m[2]))});
}

/// How much longer a mesh's delta is in the node's local units. A skin moves the mesh in place of the node, and in
/// quantised files its matrices also hold the size of the mesh; the reach is told as if the node moved it, so that the
/// node's scale gives world units.
double delta_scale(const Asset& asset, const std::vector<glm::dmat4>& world, std::size_t node) {
  if (asset.nodes[node].skin < 0) return 1.0;
  const Skin& skin = asset.skins[static_cast<std::size_t>(asset.nodes[node].skin)];
  double largest = 0;
  for (std::size_t j = 0; j < skin.joints.size(); ++j) {
    const glm::dmat4 inverse_bind = glm::make_mat4(skin.inverse_bind[j].data());
    largest = std::max(largest, largest_scale(world[static_cast<std::size_t>(skin.joints[j])] * inverse_bind));
  }
  const double node_scale = largest_scale(world[node]);
  return node_scale > 0 ? largest / node_scale : largest;
}

void add_morphs(Search& search) {
  const std::vector<glm::dmat4> world = rest_world(search.asset);
  std::map<int, std::vector<double>> deltas_of_mesh;
  for (std::size_t i = 0; i < search.asset.nodes.size(); ++i) {
    const Node& node = search.asset.nodes[i];
    if (node.mesh < 0 || node.weights.empty()) continue;
    const auto [deltas, is_new] = deltas_of_mesh.try_emplace(node.mesh);
    if (is_new) deltas->second = longest_deltas(search.model, node.mesh, search.document.name);
    const double scale = delta_scale(search.asset, world, i);
    for (std::size_t t = 0; t < deltas->second.size(); ++t) {
      search.points.morphs.push_back({static_cast<int>(i), static_cast<int>(t), scale * deltas->second[t]});
    }
  }
}

}  // namespace

Points skin_points(const Document& document, const Asset& asset, bool all_vertices) {
  const TypedModel typed = typed_model(document, Contents::meshes);
  Search search{document, asset, typed.model, all_vertices, {}};
  add_joint_origins(search);
  for (std::size_t skin = 0; skin < asset.skins.size(); ++skin) add_skin_vertices(search, skin);
  add_rigid_points(search);
  add_morphs(search);
  return std::move(search.points);
}

}  // namespace nmc::gltf
