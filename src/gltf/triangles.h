// The surface of a character for drawing: triangles, and what moves their corners.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "gltf/asset.h"

namespace nmc::gltf {

/// What moves a vertex: a node, and the matrix that goes before its world transform.
struct Bone {
  int node = -1;
  std::array<double, 16> inverse_bind{};  ///< column-major; identity where a mesh moves with its node
};

struct Triangles {
  std::vector<Bone> bones;
  std::vector<std::array<float, 3>> positions;           ///< in mesh space
  std::vector<std::array<std::uint16_t, 4>> influences;  ///< per vertex: indices of bones, 0 where the weight is 0
  std::vector<std::array<float, 4>> weights;             ///< sum 1
  std::vector<std::uint32_t> indices;                    ///< three per triangle
};

/// The triangles of all nodes' meshes, without morph targets; of each vertex the four largest influences of its first
/// two sets. Left out: primitives that are no triangles, or packed by Draco. Nothing where there are none, or where
/// vertices or indices are more than the limits. Throws Error (invalid_input) as read_asset.
std::optional<Triangles> read_triangles(const Document& document, const Asset& asset, std::size_t most_vertices,
                                        std::size_t most_indices);

}  // namespace nmc::gltf
