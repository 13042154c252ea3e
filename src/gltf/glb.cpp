// Reads and writes the GLB container with checked arithmetic.
#include "gltf/glb.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/error.h"

namespace nmc::gltf {
namespace {

constexpr std::uint64_t header_bytes = 12;
constexpr std::uint64_t chunk_header_bytes = 8;
constexpr std::uint64_t largest_file_bytes = 0xFFFFFFFFu;

[[noreturn]] void fail(const std::string& name, const std::string& what) {
  throw Error(ErrorCode::invalid_input, fmt::format("{} is not a valid GLB file: {}.", name, what));
}

std::uint32_t read_u32(std::span<const std::uint8_t> bytes, std::uint64_t at) {
  const std::uint8_t* p = bytes.data() + at;
  return static_cast<std::uint32_t>(p[0]) | static_cast<std::uint32_t>(p[1]) << 8 |
         static_cast<std::uint32_t>(p[2]) << 16 | static_cast<std::uint32_t>(p[3]) << 24;
}

void append_u32(Bytes& out, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

std::uint64_t padded(std::uint64_t size) { return (size + 3) / 4 * 4; }

void append_chunk(Bytes& out, std::uint32_t type, std::span<const std::uint8_t> data, std::uint8_t padding) {
  append_u32(out, static_cast<std::uint32_t>(padded(data.size())));
  append_u32(out, type);
  out.insert(out.end(), data.begin(), data.end());
  out.insert(out.end(), static_cast<std::size_t>(padded(data.size()) - data.size()), padding);
}

/// The declared length of the file, after checks of the header.
std::uint64_t check_header(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.size() < header_bytes) {
    if (bytes.size() >= 4 && !is_glb(bytes)) fail(name, "it does not start with the letters glTF");
    fail(name, fmt::format("it ends after {} bytes, inside the 12-byte header", bytes.size()));
  }
  if (!is_glb(bytes)) fail(name, "it does not start with the letters glTF");
  const std::uint32_t version = read_u32(bytes, 4);
  if (version == 1) {
    throw Error(ErrorCode::unsupported, fmt::format("{} is a glTF 1 file; convert it to glTF 2.0 first.", name));
  }
  if (version != 2) fail(name, fmt::format("its container version is {}, not 2", version));
  const std::uint64_t length = read_u32(bytes, 8);
  if (length < header_bytes + chunk_header_bytes)
    fail(name, fmt::format("its declared length of {} bytes is too small", length));
  if (length > bytes.size()) {
    fail(name, fmt::format("its header declares a length of {} bytes but the file is truncated after {}", length,
                           bytes.size()));
  }
  return length;
}

}  // namespace

bool is_glb(std::span<const std::uint8_t> bytes) { return bytes.size() >= 4 && read_u32(bytes, 0) == glb_magic; }

GlbChunks split_glb(std::span<const std::uint8_t> bytes, const std::string& name) {
  const std::uint64_t length = check_header(bytes, name);
  GlbChunks chunks;
  std::uint64_t at = header_bytes;
  for (std::size_t index = 0; at < length; ++index) {
    if (length - at < chunk_header_bytes) fail(name, fmt::format("it ends inside the header of chunk {}", index));
    const std::uint64_t size = read_u32(bytes, at);
    const std::uint32_t type = read_u32(bytes, at + 4);
    at += chunk_header_bytes;
    if (size > length - at) {
      fail(name, fmt::format("chunk {} of {} bytes is truncated: {} bytes are left", index, size, length - at));
    }
    if (size % 4 != 0) fail(name, fmt::format("the length {} of chunk {} is not aligned to 4 bytes", size, index));
    const auto data = bytes.subspan(static_cast<std::size_t>(at), static_cast<std::size_t>(size));
    at += size;
    if ((index == 0) != (type == glb_json_chunk)) {
      fail(name, index == 0 ? "its first chunk is not the JSON chunk" : "it has a duplicate JSON chunk");
    }
    if (index == 0) {
      if (data.empty()) fail(name, "its JSON chunk is empty");
      chunks.json = {reinterpret_cast<const char*>(data.data()), data.size()};
    } else if (type == glb_bin_chunk) {
      if (chunks.bin) fail(name, "it has a duplicate BIN chunk");
      if (index != 1) fail(name, "its BIN chunk is not the second chunk");
      chunks.bin = data;
    } else {
      chunks.extra.push_back({type, Bytes(data.begin(), data.end())});
    }
  }
  return chunks;
}

Bytes join_glb(std::string_view json, std::optional<std::span<const std::uint8_t>> bin,
               const std::vector<ExtraChunk>& extra, const std::string& name) {
  std::uint64_t length = header_bytes + chunk_header_bytes + padded(json.size());
  if (bin) length += chunk_header_bytes + padded(bin->size());
  for (const ExtraChunk& chunk : extra) length += chunk_header_bytes + padded(chunk.data.size());
  if (length > largest_file_bytes) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} would be {} bytes, more than the 4 GiB a GLB file can hold; write a .gltf instead.",
                            name, length));
  }
  Bytes out;
  out.reserve(static_cast<std::size_t>(length));
  append_u32(out, glb_magic);
  append_u32(out, 2);
  append_u32(out, static_cast<std::uint32_t>(length));
  append_chunk(out, glb_json_chunk, {reinterpret_cast<const std::uint8_t*>(json.data()), json.size()}, ' ');
  if (bin) append_chunk(out, glb_bin_chunk, *bin, 0);
  for (const ExtraChunk& chunk : extra) append_chunk(out, chunk.type, chunk.data, 0);
  return out;
}

}  // namespace nmc::gltf
