// The one small channel that an animation keeps when all its channels went into a clip set.
#include "gltf/stub.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "gltf/json_tools.h"

namespace nmc::gltf {
namespace {

const Json* node_at(const Json& root, int index) {
  const Json* nodes = find_member(root, "nodes");
  if (!nodes || index < 0 || static_cast<std::size_t>(index) >= array_size(root, "nodes")) return nullptr;
  return &(*nodes)[static_cast<std::size_t>(index)];
}

std::vector<double> numbers_of(const Json* array) {
  std::vector<double> numbers;
  if (!array || !array->is_array()) return numbers;
  for (const auto& value : *array) numbers.push_back(value.is_number() ? value.get<double>() : 0.0);
  return numbers;
}

/// The rest value of a node property, `fallback` where the file gives none.
std::vector<double> rest_numbers(const Json* node, const char* key, std::vector<double> fallback) {
  auto numbers = node ? numbers_of(find_member(*node, key)) : std::vector<double>();
  return numbers.size() == fallback.size() ? numbers : fallback;
}

std::vector<double> rest_rotation(const Json* node) {
  auto q = rest_numbers(node, "rotation", {0, 0, 0, 1});
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(norm > 1e-6) || !std::isfinite(norm)) return {0, 0, 0, 1};
  for (auto& value : q) value /= norm;
  return q;
}

/// The node's weights, else its mesh's, else a zero for each morph target.
std::vector<double> rest_weights(const Json& root, const Json* node) {
  if (!node) return {0};
  auto weights = numbers_of(find_member(*node, "weights"));
  if (!weights.empty()) return weights;
  const auto mesh_index = index_member(*node, "mesh");
  if (!mesh_index || *mesh_index >= array_size(root, "meshes")) return {0};
  const Json& mesh = root["meshes"][*mesh_index];
  weights = numbers_of(find_member(mesh, "weights"));
  if (!weights.empty()) return weights;
  if (array_size(mesh, "primitives") == 0) return {0};
  return std::vector<double>(std::max<std::size_t>(1, array_size(mesh["primitives"][0], "targets")), 0.0);
}

std::vector<double> rest_value(const Json& root, const Target& target) {
  const Json* node = node_at(root, target.node);
  switch (target.path) {
    case Path::translation:
      return rest_numbers(node, "translation", {0, 0, 0});
    case Path::rotation:
      return rest_rotation(node);
    case Path::scale:
      return rest_numbers(node, "scale", {1, 1, 1});
    case Path::weights:
      return rest_weights(root, node);
  }
  return {};
}

const char* accessor_type(Path path) {
  if (path == Path::weights) return "SCALAR";
  return path == Path::rotation ? "VEC4" : "VEC3";
}

}  // namespace

Target choose_stub_target(const Json& root, const std::vector<Target>& set_targets, const std::vector<Target>& taken) {
  const auto is_taken = [&](const Target& target) {
    return std::find(taken.begin(), taken.end(), target) != taken.end();
  };
  const auto moves_plain_node = [&](const Target& target) {
    const Json* node = node_at(root, target.node);
    return target.path != Path::weights && node && !find_member(*node, "matrix");
  };
  std::optional<Target> any;
  for (const auto& target : set_targets) {
    if (!is_taken(target)) continue;
    if (moves_plain_node(target)) return target;
    if (!any) any = target;
  }
  return any.value_or(taken.front());
}

Json make_stub_sampler(const Json& root, const Stub& stub, FloatBlock& block) {
  std::vector<float> times{stub.start_seconds};
  if (stub.end_seconds > stub.start_seconds) times.push_back(stub.end_seconds);
  std::vector<float> values;
  const auto rest = rest_value(root, stub.target);
  for (std::size_t key = 0; key < times.size(); ++key) {
    for (const double number : rest) values.push_back(static_cast<float>(number));
  }
  const auto input = block.add_times(times);
  return Json{{"input", input}, {"output", block.add(accessor_type(stub.target.path), values)}};
}

}  // namespace nmc::gltf
