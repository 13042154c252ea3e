// A glTF file as it is on disk: its JSON with key order kept, its buffers, its container. Reading and writing .glb and
// .gltf.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace nmc::gltf {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<std::uint8_t>;

/// A GLB chunk that is neither the JSON nor the BIN chunk; kept as it is.
struct ExtraChunk {
  std::uint32_t type = 0;
  Bytes data;
};

/// A whole file in memory. `buffers[i]` holds the bytes of buffer i (empty for a buffer that has no data of its own,
/// such as a meshopt fallback placeholder: `has_data[i]` is false).
struct Document {
  std::string name;              ///< the file's name for messages
  std::filesystem::path folder;  ///< where external files are looked up
  bool is_glb = false;
  Json json;
  std::vector<Bytes> buffers;
  std::vector<bool> has_data;
  std::vector<ExtraChunk> extra_chunks;
};

struct ReadOptions {
  bool allow_external = false;  ///< let URIs leave the input's folder
};

/// Reads a file. Throws Error: io (missing, unreadable), invalid_input (not glTF, truncated, out of range), unsupported
/// (glTF 1).
Document read_document(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same from bytes in memory (GLB, or glTF JSON whose buffers are data URIs or lie in `folder`).
Document parse_document(std::span<const std::uint8_t> bytes, const std::string& name,
                        const std::filesystem::path& folder, const ReadOptions& options = {});

/// Writes a file: GLB or .gltf + .bin by the extension of `path`. The target is replaced only when everything is
/// written and synced; on failure throws Error (io) and leaves the target as it was. Images and buffers that lie in
/// other files are referred to as before (relative URIs are kept; copied when the folder differs).
void write_document(const Document& document, const std::filesystem::path& path);

/// The GLB bytes of a document. Throws Error (unsupported) beyond 4 GiB.
Bytes to_glb(const Document& document);

/// The bytes of a bufferView as stored, checked against its buffer. Throws Error (invalid_input) naming the view.
std::span<const std::uint8_t> stored_view(const Document& document, std::size_t buffer_view);

}  // namespace nmc::gltf
