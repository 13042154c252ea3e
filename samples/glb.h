// Writes GLB files: collects bufferViews and accessors, then packs header, JSON chunk and BIN chunk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

namespace nmc::samples {

using Json = nlohmann::ordered_json;

/// glTF component types (glTF 2.0, 5.1.3).
enum class ComponentType { u8 = 5121, u16 = 5123, f32 = 5126 };

/// What an accessor says about its data.
struct AccessorInfo {
  ComponentType component = ComponentType::f32;
  std::string type = "SCALAR";  ///< "SCALAR", "VEC3", "VEC4", "MAT4"
  std::size_t count = 0;
  bool normalized = false;
  std::vector<double> min, max;  ///< left out when empty
};

/// bufferView targets (glTF 2.0, 5.11.5); 0 means none.
enum class ViewTarget { none = 0, vertices = 34962, indices = 34963 };

/// A GLB file under construction. `json` is the document; the builder appends to its bufferViews and accessors only.
class GlbBuilder {
 public:
  GlbBuilder();

  Json json;

  /// Appends bytes as a new bufferView that starts at a multiple of 4. Returns its index.
  std::size_t add_view(std::span<const std::uint8_t> bytes, ViewTarget target = ViewTarget::none,
                       std::size_t stride = 0);

  /// Adds an accessor on a view. Returns its index.
  std::size_t add_accessor(std::size_t view, std::size_t byte_offset, const AccessorInfo& info);

  /// The finished file.
  std::vector<std::uint8_t> finish();

 private:
  std::vector<std::uint8_t> binary_;
};

/// The bytes of a contiguous array of plain values, as they lie in memory (little endian).
template <typename T>
std::vector<std::uint8_t> to_bytes(const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
  return {first, first + bytes.size()};
}

}  // namespace nmc::samples
