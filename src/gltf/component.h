// Sizes of accessor components and elements (glTF 2.0, sections 3.6.2.2 and 3.6.2.4).
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace nmc::gltf {

/// accessor.componentType
enum ComponentType : int {
  signed_byte = 5120,
  unsigned_byte = 5121,
  signed_short = 5122,
  unsigned_short = 5123,
  unsigned_int = 5125,
  float_32 = 5126,
};

/// Bytes of a component; 0 for a type that glTF does not know.
constexpr std::uint64_t component_bytes(std::uint64_t component_type) {
  switch (component_type) {
    case signed_byte:
    case unsigned_byte:
      return 1;
    case signed_short:
    case unsigned_short:
      return 2;
    case unsigned_int:
    case float_32:
      return 4;
    default:
      return 0;
  }
}

/// Numbers per element of accessor.type; 0 for a type that glTF does not know.
constexpr int component_count(std::string_view type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4" || type == "MAT2") return 4;
  if (type == "MAT3") return 9;
  if (type == "MAT4") return 16;
  return 0;
}

/// Bytes of an element; columns of matrices start at multiples of four bytes. 0 when either type is unknown.
constexpr std::uint64_t element_bytes(std::string_view type, std::uint64_t component_type) {
  const std::uint64_t component = component_bytes(component_type);
  const std::uint64_t columns = type == "MAT2" ? 2 : type == "MAT3" ? 3 : type == "MAT4" ? 4 : 0;
  if (columns == 0) return component * static_cast<std::uint64_t>(component_count(type));
  return columns * ((columns * component + 3) / 4 * 4);
}

}  // namespace nmc::gltf
