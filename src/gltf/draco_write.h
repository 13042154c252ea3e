// Packs the meshes of a document as KHR_draco_mesh_compression says.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>

#include "gltf/document.h"

namespace nmc::gltf {

/// Bits per number that float attributes are rounded to, of their largest extent. Integer attributes stay exact.
struct DracoBits {
  int position = 14;
  int normal = 10;
  int texcoord = 12;
  int color = 10;
  int weight = 14;
  int generic = 12;  ///< tangents and what applications add
};

/// How far a packed primitive is from what it was, over all its vertices.
struct DracoError {
  double position = 0;  ///< largest distance, in the mesh's units
  double weight = 0;    ///< largest sum of differences of a vertex's weights
};

struct DracoResult {
  std::size_t packed = 0;        ///< primitives
  std::size_t bytes_before = 0;  ///< of the attributes and indices of those
  std::size_t bytes_after = 0;
  std::map<std::string, std::size_t> left;  ///< why others stay (a clause such as "have morph targets"), and how many
};

/// Packs every primitive of triangles that becomes smaller. `fits(mesh, error)` says whether an error can be borne;
/// where it cannot, positions and weights get more bits, and a primitive that never fits stays as it is, as do those
/// with morph targets or sparse attributes, those that are not triangles, and packed ones. Throws Error as the readers
/// do.
DracoResult pack_meshes(Document& document, const DracoBits& bits,
                        const std::function<bool(std::size_t mesh, const DracoError& error)>& fits);

}  // namespace nmc::gltf
