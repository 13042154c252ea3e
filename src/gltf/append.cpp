// Adds bytes, bufferViews and float accessors to the end of a document.
#include "gltf/append.h"

#include "base/bits.h"
#include "base/error.h"
#include "gltf/json_tools.h"

namespace nmc::gltf {
namespace {

std::size_t find_data_buffer(Document& document) {
  for (std::size_t buffer = 0; buffer < document.buffers.size(); ++buffer) {
    if (document.has_data[buffer]) return buffer;
  }
  if (document.is_glb && !document.buffers.empty()) {
    throw Error(ErrorCode::unsupported,
                document.name + " has no buffer with data that could take more; convert it to .gltf first");
  }
  array_member(document.json, "buffers").push_back(Json::object({{"byteLength", 0}}));
  document.buffers.emplace_back();
  document.has_data.push_back(true);
  return document.buffers.size() - 1;
}

Bytes little_endian(std::span<const float> values) {
  Bytes bytes;
  bytes.reserve(values.size() * 4);
  for (const float value : values) {
    const auto bits = bit_cast<std::uint32_t>(value);
    for (const unsigned shift : {0U, 8U, 16U, 24U}) bytes.push_back(static_cast<std::uint8_t>(bits >> shift));
  }
  return bytes;
}

std::size_t components_of(const std::string& type) {
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 1;
}

}  // namespace

std::size_t append_view(Document& document, std::span<const std::uint8_t> bytes) {
  const std::size_t buffer = find_data_buffer(document);
  Bytes& data = document.buffers[buffer];
  data.resize((data.size() + 3) / 4 * 4);
  Json view = Json::object({{"buffer", buffer}});
  if (!data.empty()) view["byteOffset"] = data.size();
  view["byteLength"] = bytes.size();
  data.insert(data.end(), bytes.begin(), bytes.end());
  document.json["buffers"][buffer]["byteLength"] = data.size();
  Json& views = array_member(document.json, "bufferViews");
  views.push_back(std::move(view));
  return views.size() - 1;
}

FloatBlock::FloatBlock(Document& document) : document_(document), view_(array_size(document.json, "bufferViews")) {}

std::size_t FloatBlock::add(const std::string& type, std::span<const float> values) { return add(type, values, false); }

std::size_t FloatBlock::add_times(std::span<const float> times) { return add("SCALAR", times, true); }

std::size_t FloatBlock::add(const std::string& type, std::span<const float> values, bool with_bounds) {
  Bytes bytes = little_endian(values);
  auto key = std::pair(type + (with_bounds ? " times" : ""), std::move(bytes));
  Json& accessors = array_member(document_.json, "accessors");
  const auto [entry, is_new] = known_.try_emplace(std::move(key), accessors.size());
  if (!is_new) return entry->second;
  Json accessor = Json::object({{"bufferView", view_}});
  if (!bytes_.empty()) accessor["byteOffset"] = bytes_.size();
  accessor["componentType"] = 5126;
  accessor["count"] = values.size() / components_of(type);
  accessor["type"] = type;
  if (with_bounds) {
    accessor["min"] = Json::array({shortest_number(values.front())});
    accessor["max"] = Json::array({shortest_number(values.back())});
  }
  accessors.push_back(std::move(accessor));
  const Bytes& added = entry->first.second;
  bytes_.insert(bytes_.end(), added.begin(), added.end());
  return entry->second;
}

void FloatBlock::finish() {
  if (!bytes_.empty()) append_view(document_, bytes_);
}

}  // namespace nmc::gltf
