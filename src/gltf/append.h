// Adds bytes, bufferViews and float accessors to the end of a document.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "gltf/document.h"

namespace nmc::gltf {

/// Adds a bufferView with these bytes, on a multiple of four, to the first buffer that has data; makes buffer 0 if
/// there is none. Returns its index. Throws Error (unsupported) for a GLB whose buffers all have no data.
std::size_t append_view(Document& document, std::span<const std::uint8_t> bytes);

/// Float accessors that share one new bufferView. Equal accessors are written once.
class FloatBlock {
 public:
  /// The accessors are added to `document` at once, the bufferView by finish(); until then nobody else may add a
  /// bufferView.
  explicit FloatBlock(Document& document);

  /// An accessor of `type` ("SCALAR", "VEC3", "VEC4") with the given values; returns its index.
  std::size_t add(const std::string& type, std::span<const float> values);

  /// A SCALAR accessor of key times with min and max (glTF 3.11 asks for them); not empty, increasing. Returns its
  /// index.
  std::size_t add_times(std::span<const float> times);

  /// Writes the bufferView. Call once, after the last add.
  void finish();

 private:
  std::size_t add(const std::string& type, std::span<const float> values, bool with_bounds);

  Document& document_;
  std::size_t view_;
  Bytes bytes_;
  std::map<std::pair<std::string, Bytes>, std::size_t> known_;
};

}  // namespace nmc::gltf
