// The vertices of meshes with the joints that move them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "gltf/asset.h"
#include "gltf/typed_model.h"

namespace nmc::gltf {

/// A joint's share of a vertex.
struct Binding {
  int joint = 0;  ///< index in skin.joints
  double weight = 0.0;

  bool operator==(const Binding&) const = default;
};

/// Vertices in mesh space; vertex i is moved by bindings[first[i]] .. bindings[first[i + 1] - 1], whose weights sum
/// to 1.
struct Vertices {
  std::vector<std::array<float, 3>> positions;
  std::vector<std::size_t> first{0};
  std::vector<Binding> bindings;

  std::size_t size() const { return positions.size(); }
  std::span<const Binding> bindings_of(std::size_t vertex) const {
    return std::span(bindings).subspan(first[vertex], first[vertex + 1] - first[vertex]);
  }
};

/// Adds the vertices of a skinned mesh, all sets of JOINTS_n and WEIGHTS_n together. Left out: primitives without
/// joints, vertices without weight. Throws Error (invalid_input): a joint that the skin does not have, a negative
/// weight.
void add_skinned_vertices(const tinygltf::Model& model, int mesh, const Skin& skin, const std::string& file_name,
                          Vertices& vertices);

/// The vertices of a mesh that moves with its node: one binding to joint 0.
Vertices rigid_vertices(const tinygltf::Model& model, int mesh, const std::string& file_name);

/// The length of the longest POSITION delta of each morph target of a mesh.
std::vector<double> longest_deltas(const tinygltf::Model& model, int mesh, const std::string& file_name);

/// Indices of the first of each group of vertices that are the same in position and bindings, increasing.
std::vector<std::size_t> distinct_vertices(const Vertices& vertices);

/// Indices of the vertices that show best how far each joint moves the skin, increasing: in the joint's space the
/// outermost along 14 directions among those that it moves notably (a weight of 0.25, or its largest if that is less),
/// and the one where weight times distance is largest. `inverse_bind`: one per joint.
std::vector<std::size_t> extreme_vertices(const Vertices& vertices,
                                          std::span<const std::array<double, 16>> inverse_bind);

/// A column-major matrix times a point.
std::array<double, 3> transform(const std::array<double, 16>& matrix, const std::array<float, 3>& point);

}  // namespace nmc::gltf
