// Checks nodes, their hierarchy, scenes and skins.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "gltf/json_text.h"
#include "gltf/validate.h"

namespace nmc::gltf {
namespace {

/// The Khronos validator's tolerance for the length of a rotation.
constexpr double unit_length_tolerance = 0.00769;

/// An array of `count` finite numbers; nullptr when absent.
const Json* find_numbers(const Json& object, const char* key, std::size_t count, const Where& where) {
  const Json* values = find_array(object, key, where);
  if (values == nullptr) return nullptr;
  bool good = values->size() == count;
  for (const Json& value : *values) good = good && value.is_number();
  if (!good) where.fail(fmt::format("has a {} that is not {} numbers", key, count));
  return values;
}

void check_matrix(const Json& values, const Where& where) {
  std::array<double, 16> m{};
  for (std::size_t i = 0; i < 16; ++i) m[i] = values[i].get<double>();
  const bool affine = m[3] == 0 && m[7] == 0 && m[11] == 0 && std::abs(m[15] - 1) < 1e-5;
  // Columns at right angles are what a product of rotation and scale has; files hold them in single precision or a few
  // digits.
  const auto skew = [&m](std::size_t a, std::size_t b) {
    double dot = 0, length_a = 0, length_b = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      dot += m[4 * a + i] * m[4 * b + i];
      length_a += m[4 * a + i] * m[4 * a + i];
      length_b += m[4 * b + i] * m[4 * b + i];
    }
    return std::abs(dot) > 1e-2 * std::sqrt(length_a * length_b);
  };
  if (!affine || skew(0, 1) || skew(0, 2) || skew(1, 2)) {
    where.fail("has a matrix that is not a product of translation, rotation and scale");
  }
}

void check_transform(const Json& node, const Where& where) {
  find_numbers(node, "translation", 3, where);
  find_numbers(node, "scale", 3, where);
  const Json* rotation = find_numbers(node, "rotation", 4, where);
  const Json* matrix = find_numbers(node, "matrix", 16, where);
  if (matrix != nullptr &&
      (rotation != nullptr || find(node, "translation") != nullptr || find(node, "scale") != nullptr)) {
    where.fail("has both a matrix and a translation, rotation or scale");
  }
  if (matrix != nullptr) check_matrix(*matrix, where);
  if (rotation == nullptr) return;
  double square = 0;
  for (const Json& value : *rotation) square += value.get<double>() * value.get<double>();
  if (!(std::abs(std::sqrt(square) - 1) <= unit_length_tolerance))
    where.fail("has a rotation that is not a unit quaternion");
}

std::size_t target_count(const Json& mesh) {
  const Json* targets = find(mesh["primitives"][0], "targets");
  return targets == nullptr ? 0 : targets->size();
}

bool has_joints(const Json& mesh) {
  for (const Json& primitive : mesh["primitives"]) {
    if (find(primitive["attributes"], "JOINTS_0") != nullptr) return true;
  }
  return false;
}

void check_mesh_of_node(const Document& document, const Json& node, const Where& where) {
  const std::optional<std::size_t> mesh =
      find_index(node, "mesh", list_size(document.json, "meshes", document.name), where);
  const std::optional<std::size_t> skin =
      find_index(node, "skin", list_size(document.json, "skins", document.name), where);
  const Json* weights = find_array(node, "weights", where);
  if (!mesh && (skin || weights != nullptr)) where.fail(fmt::format("has {} but no mesh", skin ? "a skin" : "weights"));
  if (!mesh) return;
  const Json& mesh_json = document.json["meshes"][*mesh];
  if (skin && !has_joints(mesh_json)) where.fail("has a skin, but its mesh has no joints");
  if (weights != nullptr) find_numbers(node, "weights", target_count(mesh_json), where);
}

/// Each node's parent, checked to be its only one.
std::vector<int> read_parents(const Document& document, const Json& nodes) {
  std::vector<int> parents(nodes.size(), -1);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Where where{document.name, fmt::format("nodes[{}]", i)};
    const Json* children = find_array(nodes[i], "children", where);
    if (children == nullptr) continue;
    if (children->empty()) where.fail("has empty children, which glTF forbids");
    for (const Json& child : *children) {
      const std::size_t index = as_index(child, nodes.size(), where, "child");
      if (parents[index] >= 0)
        where.fail(fmt::format("has the child {}, which nodes[{}] has already", index, parents[index]));
      parents[index] = static_cast<int>(i);
    }
  }
  return parents;
}

void check_no_cycle(const Document& document, const std::vector<int>& parents) {
  enum State : char { unseen, on_path, good };
  std::vector<State> states(parents.size(), unseen);
  std::vector<std::size_t> path;
  for (std::size_t start = 0; start < parents.size(); ++start) {
    path.clear();
    std::size_t node = start;
    while (states[node] == unseen) {
      states[node] = on_path;
      path.push_back(node);
      if (parents[node] < 0) break;
      node = static_cast<std::size_t>(parents[node]);
    }
    if (states[node] == on_path && parents[node] >= 0) {
      Where{document.name, fmt::format("nodes[{}]", node)}.fail("is its own ancestor");
    }
    for (const std::size_t seen : path) states[seen] = good;
  }
}

void check_scenes(const Document& document, const std::vector<int>& parents) {
  const Json* scenes = find_list(document.json, "scenes", document.name);
  const std::size_t count = scenes == nullptr ? 0 : scenes->size();
  find_index(document.json, "scene", count, {document.name, "the file"});
  for (std::size_t i = 0; i < count; ++i) {
    const Where where{document.name, fmt::format("scenes[{}]", i)};
    const Json* nodes = find_array((*scenes)[i], "nodes", where);
    if (nodes == nullptr) continue;
    if (nodes->empty()) where.fail("has empty nodes, which glTF forbids");
    for (const Json& node : *nodes) {
      const std::size_t index = as_index(node, parents.size(), where, "node");
      if (parents[index] >= 0) where.fail(fmt::format("has the node {}, which is not a root", index));
    }
  }
}

void check_skin(const Document& document, std::size_t index, std::size_t node_count) {
  const Json& skin = document.json["skins"][index];
  const Where where{document.name, fmt::format("skins[{}]", index)};
  const Json* joints = find_array(skin, "joints", where);
  if (joints == nullptr || joints->empty()) where.fail("has no joints");
  std::set<std::size_t> seen;
  for (const Json& joint : *joints) {
    if (!seen.insert(as_index(joint, node_count, where, "joint")).second) where.fail("has the same joint twice");
  }
  find_index(skin, "skeleton", node_count, where);
  const std::size_t accessors = list_size(document.json, "accessors", document.name);
  const std::optional<std::size_t> matrices = find_index(skin, "inverseBindMatrices", accessors, where);
  if (!matrices) return;
  const Json& accessor = document.json["accessors"][*matrices];
  if (accessor["type"] != "MAT4" || accessor["componentType"].get<double>() != 5126) {
    where.fail("has inverseBindMatrices that are not 4 x 4 matrices of floats");
  }
  if (accessor["count"].get<double>() < static_cast<double>(joints->size()))
    where.fail("has fewer inverseBindMatrices than joints");
}

}  // namespace

void validate_nodes(const Document& document) {
  const Json* list = find_list(document.json, "nodes", document.name);
  const Json nothing = Json::array();
  const Json& nodes = list == nullptr ? nothing : *list;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Where where{document.name, fmt::format("nodes[{}]", i)};
    find_string(nodes[i], "name", where);
    check_transform(nodes[i], where);
    check_mesh_of_node(document, nodes[i], where);
  }
  const std::vector<int> parents = read_parents(document, nodes);
  check_no_cycle(document, parents);
  check_scenes(document, parents);
  const std::size_t skins = list_size(document.json, "skins", document.name);
  for (std::size_t i = 0; i < skins; ++i) check_skin(document, i, nodes.size());
}

}  // namespace nmc::gltf
