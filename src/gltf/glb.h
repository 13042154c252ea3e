// The GLB container (glTF 2.0, section 4.4): chunks out of bytes and back. Knows no JSON.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gltf/document.h"

namespace nmc::gltf {

inline constexpr std::uint32_t glb_magic = 0x46546C67;       // "glTF"
inline constexpr std::uint32_t glb_json_chunk = 0x4E4F534A;  // "JSON"
inline constexpr std::uint32_t glb_bin_chunk = 0x004E4942;   // "BIN\0"

/// The chunks of a GLB as views into its bytes.
struct GlbChunks {
  std::string_view json;
  std::optional<std::span<const std::uint8_t>> bin;
  std::vector<ExtraChunk> extra;
};

/// True when the bytes start with the GLB magic.
bool is_glb(std::span<const std::uint8_t> bytes);

/// Takes a GLB apart. Throws Error: invalid_input for a broken container, unsupported for glTF 1; `name` is the file's
/// name in the sentence. Bytes after the declared length are ignored, as the Khronos validator only warns of them.
GlbChunks split_glb(std::span<const std::uint8_t> bytes, const std::string& name);

/// Puts a GLB together: JSON padded with spaces, BIN with zeros, extra chunks after them in their order.
/// Throws Error (unsupported) beyond 4 GiB.
Bytes join_glb(std::string_view json, std::optional<std::span<const std::uint8_t>> bin,
               const std::vector<ExtraChunk>& extra, const std::string& name);

}  // namespace nmc::gltf
