// An entry is DIR/<2 digits>/<30 digits>.nmc: a magic, the XXH3-128 of what follows, and a CBOR object.
#include "cli/cache.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>

#include "base/error.h"
#include "base/platform.h"
#include "cli/command.h"
#include "cli/outputs.h"
#include "gltf/files.h"
#include "gltf/json_text.h"

namespace nmc::cli {
namespace {

namespace fs = std::filesystem;
using gltf::Bytes;
using gltf::Json;

constexpr std::string_view magic = "NMCcach1";
constexpr std::size_t digest_bytes = 16;

using Digest = std::array<std::uint8_t, digest_bytes>;

/// XXH3-128 (Collet) of bytes that come in pieces; every piece counts with its length.
class Hash {
 public:
  Hash() : state_(XXH3_createState(), XXH3_freeState) {
    if (!state_) throw std::bad_alloc();
    XXH3_128bits_reset(state_.get());
  }
  void add(std::span<const std::uint8_t> bytes) {
    const std::uint64_t size = bytes.size();
    std::array<std::uint8_t, 8> length{};
    for (std::size_t i = 0; i < length.size(); ++i) length[i] = static_cast<std::uint8_t>(size >> (8 * i));
    XXH3_128bits_update(state_.get(), length.data(), length.size());
    XXH3_128bits_update(state_.get(), bytes.data(), bytes.size());
  }
  void add(std::string_view text) { add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}); }
  Digest digest() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
    Digest digest{};
    std::copy(std::begin(canonical.digest), std::end(canonical.digest), digest.begin());
    return digest;
  }

 private:
  std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

Digest hash_of(std::span<const std::uint8_t> bytes) {
  Hash hash;
  hash.add(bytes);
  return hash.digest();
}

/// The program's own bytes: two builds of one version may differ in the last bits of their arithmetic.
const Digest& build_digest() {
  static const Digest digest = [] {
    std::ifstream file(program_path(), std::ios::binary);
    const Bytes bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    return hash_of(bytes);
  }();
  return digest;
}

std::string entry_name(const std::string& folder, const std::string& key) {
  return (fs::path(folder) / key.substr(0, 2) / (key.substr(2) + ".nmc")).string();
}

Json to_json(const std::string& key, const gltf::Document& document, const Json& report, const Json& tried) {
  Json entry{
      {"key", key}, {"is_glb", document.is_glb}, {"json", document.json.dump()}, {"report", report}, {"tried", tried}};
  entry["buffers"] = Json::array();
  for (std::size_t i = 0; i < document.buffers.size(); ++i)
    entry["buffers"].push_back(document.has_data[i] ? Json::binary(document.buffers[i]) : Json(nullptr));
  entry["extra_chunks"] = Json::array();
  for (const gltf::ExtraChunk& chunk : document.extra_chunks)
    entry["extra_chunks"].push_back({{"type", chunk.type}, {"data", Json::binary(chunk.data)}});
  return entry;
}

CachedResult from_json(Json&& entry) {
  CachedResult result;
  result.report = std::move(entry.at("report"));
  result.tried = std::move(entry.at("tried"));
  gltf::Document& document = result.document;
  document.is_glb = entry.at("is_glb").get<bool>();
  document.json = gltf::parse_json(entry.at("json").get_ref<const std::string&>(), "the cache");
  for (Json& buffer : entry.at("buffers")) {
    document.has_data.push_back(buffer.is_binary());
    document.buffers.push_back(buffer.is_binary() ? Bytes(std::move(buffer.get_binary())) : Bytes());
  }
  for (Json& chunk : entry.at("extra_chunks"))
    document.extra_chunks.push_back(
        {chunk.at("type").get<std::uint32_t>(), Bytes(std::move(chunk.at("data").get_binary()))});
  return result;
}

}  // namespace

Cache::Cache(std::string folder, bool look_only) : folder_(std::move(folder)) {
  if (!look_only) make_folder(folder_);
}

std::string Cache::key(const std::string& settings, std::span<const std::uint8_t> file,
                       const gltf::Document& document) {
  Hash hash;
  hash.add(magic);
  hash.add(version);
  hash.add(build_digest());
  hash.add(settings);
  hash.add(file);
  for (const Bytes& buffer : document.buffers) hash.add(buffer);
  std::string digits;
  for (const std::uint8_t byte : hash.digest()) digits += fmt::format("{:02x}", byte);
  return digits;
}

Cache::Found Cache::find(const std::string& key, CachedResult& result) const {
  const std::string name = entry_name(folder_, key);
  std::error_code ignored;
  if (!fs::exists(name, ignored)) return Found::nothing;
  try {
    const Bytes bytes = gltf::read_file(name);
    if (bytes.size() < magic.size() + digest_bytes || !std::equal(magic.begin(), magic.end(), bytes.begin()))
      return Found::damaged;
    const std::span<const std::uint8_t> payload = std::span(bytes).subspan(magic.size() + digest_bytes);
    const Digest digest = hash_of(payload);
    if (!std::equal(digest.begin(), digest.end(), bytes.begin() + magic.size())) return Found::damaged;
    Json entry = Json::from_cbor(payload.begin(), payload.end());
    if (entry.at("key") != key) return Found::damaged;
    result = from_json(std::move(entry));
    return Found::entry;
  } catch (const Error&) {
    return Found::damaged;  // unreadable is as good as damaged: the work is done again
  } catch (const Json::exception&) {
    return Found::damaged;
  }
}

void Cache::store(const std::string& key, const gltf::Document& document, const Json& report, const Json& tried) const {
  Bytes bytes(magic.begin(), magic.end());
  bytes.resize(magic.size() + digest_bytes);
  Json::to_cbor(to_json(key, document, report, tried), bytes);
  const Digest digest = hash_of(std::span(bytes).subspan(magic.size() + digest_bytes));
  std::copy(digest.begin(), digest.end(), bytes.begin() + magic.size());
  const std::string name = entry_name(folder_, key);
  make_folder(fs::path(name).parent_path().string());
  gltf::FileReplacement file;
  file.add(name, bytes);
  file.commit();
}

}  // namespace nmc::cli
