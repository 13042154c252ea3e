// Unpacks the vertex attributes of primitives that KHR_draco_mesh_compression has packed.
#pragma once

#include <string>
#include <vector>

#include "gltf/json_text.h"

namespace nmc::gltf {

/// An attribute as floats: exact for floats and for integers up to 16 bits.
struct DracoAttribute {
  std::string semantic;
  int width = 0;              ///< numbers per vertex, as the accessor's type says
  std::vector<float> values;  ///< vertices * width; integers as they are, not normalized
};

/// Decodes the attributes whose semantics `wanted` accepts. tinygltf could decode Draco as well, but it trusts
/// attribute ids, component counts and strides of the stream. Throws Error (invalid_input) naming the primitive.
std::vector<DracoAttribute> unpack_draco(const Document& document, const Json& primitive,
                                         bool (*wanted)(const std::string& semantic), const Where& where);

}  // namespace nmc::gltf
