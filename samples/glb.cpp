// Writes GLB files: collects bufferViews and accessors, then packs header, JSON chunk and BIN chunk.
#include "samples/glb.h"

namespace nmc::samples {
namespace {

void append_u32(std::vector<std::uint8_t>& bytes, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>((value >> shift) & 0xff));
}

void pad_to_4(std::vector<std::uint8_t>& bytes, std::uint8_t filler) {
  while (bytes.size() % 4 != 0) bytes.push_back(filler);
}

}  // namespace

GlbBuilder::GlbBuilder() { json["asset"] = {{"version", "2.0"}, {"generator", "gltf-nmc make_characters"}}; }

std::size_t GlbBuilder::add_view(std::span<const std::uint8_t> bytes, ViewTarget target, std::size_t stride) {
  pad_to_4(binary_, 0);
  Json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  if (target != ViewTarget::none) view["target"] = static_cast<int>(target);
  binary_.insert(binary_.end(), bytes.begin(), bytes.end());
  json["bufferViews"].push_back(std::move(view));
  return json["bufferViews"].size() - 1;
}

std::size_t GlbBuilder::add_accessor(std::size_t view, std::size_t byte_offset, const AccessorInfo& info) {
  Json accessor = {{"bufferView", view}};
  if (byte_offset != 0) accessor["byteOffset"] = byte_offset;
  accessor["componentType"] = static_cast<int>(info.component);
  if (info.normalized) accessor["normalized"] = true;
  accessor["count"] = info.count;
  accessor["type"] = info.type;
  if (!info.min.empty()) accessor["min"] = info.min;
  if (!info.max.empty()) accessor["max"] = info.max;
  json["accessors"].push_back(std::move(accessor));
  return json["accessors"].size() - 1;
}

std::vector<std::uint8_t> GlbBuilder::finish() {
  constexpr std::size_t magic = 0x46546C67, version = 2, json_type = 0x4E4F534A, binary_type = 0x004E4942;
  json["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
  const std::string text = json.dump();
  std::vector<std::uint8_t> json_chunk(text.begin(), text.end());
  pad_to_4(json_chunk, ' ');
  std::vector<std::uint8_t> binary_chunk = binary_;
  pad_to_4(binary_chunk, 0);

  std::vector<std::uint8_t> file;
  file.reserve(28 + json_chunk.size() + binary_chunk.size());
  append_u32(file, magic);
  append_u32(file, version);
  append_u32(file, 28 + json_chunk.size() + binary_chunk.size());
  append_u32(file, json_chunk.size());
  append_u32(file, json_type);
  file.insert(file.end(), json_chunk.begin(), json_chunk.end());
  append_u32(file, binary_chunk.size());
  append_u32(file, binary_type);
  file.insert(file.end(), binary_chunk.begin(), binary_chunk.end());
  return file;
}

}  // namespace nmc::samples
