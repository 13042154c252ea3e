// Reads a glTF document: container, JSON, and the bytes of its buffers.
#include "gltf/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <system_error>

#include "base/error.h"
#include "gltf/files.h"
#include "gltf/glb.h"
#include "gltf/json_text.h"
#include "gltf/uri.h"

namespace nmc::gltf {
namespace {

namespace fs = std::filesystem;

struct Version {
  std::uint64_t major = 0;
  std::uint64_t minor = 0;
};

/// "2.0" to numbers, as the schema's pattern ^[0-9]+\.[0-9]+$ says.
std::optional<Version> parse_version(const std::string& text) {
  const std::size_t dot = text.find('.');
  if (dot == std::string::npos) return std::nullopt;
  const auto number = [](const std::string& digits) -> std::optional<std::uint64_t> {
    if (digits.empty() || digits.size() > 9) return std::nullopt;
    if (!std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c) != 0; }))
      return std::nullopt;
    return std::stoull(digits);
  };
  const auto major = number(text.substr(0, dot));
  const auto minor = number(text.substr(dot + 1));
  if (!major || !minor) return std::nullopt;
  return Version{*major, *minor};
}

Version read_version(const Json& asset, const char* key, const Where& where) {
  const std::optional<std::string> text = find_string(asset, key, where);
  if (!text) where.fail(fmt::format("has no {}", key));
  const std::optional<Version> version = parse_version(*text);
  if (!version) where.fail(fmt::format("has the {} \"{}\", which is not of the form 2.0", key, *text));
  return *version;
}

void check_asset(const Json& json, const std::string& name) {
  if (!json.is_object()) throw Error(ErrorCode::invalid_input, fmt::format("{}: the JSON is not an object.", name));
  const Json* asset = find(json, "asset");
  if (asset == nullptr || !asset->is_object()) {
    throw Error(ErrorCode::invalid_input, fmt::format("{} is not a glTF file: its JSON has no asset object.", name));
  }
  const Where where{name, "asset"};
  const Version version = read_version(*asset, "version", where);
  if (version.major == 1) {
    throw Error(ErrorCode::unsupported, fmt::format("{} is a glTF 1 file; convert it to glTF 2.0 first.", name));
  }
  if (version.major != 2)
    throw Error(ErrorCode::unsupported, fmt::format("{} is a glTF {} file, not glTF 2.", name, version.major));
  if (find(*asset, "minVersion") == nullptr) return;
  const Version least = read_version(*asset, "minVersion", where);
  if (least.major > version.major || (least.major == version.major && least.minor > version.minor)) {
    where.fail("has a minVersion greater than its version");
  }
}

/// A meshopt fallback buffer says of itself that it has no bytes.
bool is_fallback(const Json& buffer) {
  const Json* extensions = find(buffer, "extensions");
  if (extensions == nullptr) return false;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const Json* extension = find(*extensions, name);
    const Json* fallback = extension == nullptr ? nullptr : find(*extension, "fallback");
    if (fallback != nullptr && fallback->is_boolean() && fallback->get<bool>()) return true;
  }
  return false;
}

Bytes read_external(const std::string& uri, const Document& document, std::uint64_t size, const ReadOptions& options,
                    const Where& where) {
  if (has_scheme(uri)) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: {} has the URI \"{}\"; only files beside the input and data URIs are read.",
                            document.name, where.object, uri.substr(0, 80)));
  }
  const std::optional<fs::path> path = resolve_uri(uri, document.folder, options.allow_external);
  if (!path) {
    if (uri.empty() || !percent_decode(uri)) where.fail(fmt::format("has the malformed URI \"{}\"", uri.substr(0, 80)));
    throw Error(
        ErrorCode::unsupported,
        fmt::format(
            "{}: {} has the URI \"{}\", which leads out of the input's folder; allow external files if you trust it.",
            document.name, where.object, uri.substr(0, 80)));
  }
  return read_file(*path, size);
}

void shorten_to(Bytes& bytes, std::uint64_t size, const Where& where) {
  if (bytes.size() < size) where.fail(fmt::format("needs {} bytes but its data has only {}", size, bytes.size()));
  bytes.resize(static_cast<std::size_t>(size));
}

void read_buffer(Document& document, std::size_t index, const std::optional<std::span<const std::uint8_t>>& bin,
                 const ReadOptions& options) {
  const Json& buffer = document.json["buffers"][index];
  const Where where{document.name, fmt::format("buffers[{}]", index)};
  const std::uint64_t size = get_unsigned(buffer, "byteLength", where);
  if (size == 0) where.fail("has a byteLength of 0");
  const std::optional<std::string> uri = find_string(buffer, "uri", where);
  Bytes& bytes = document.buffers[index];
  if (uri && is_data_uri(*uri)) {
    std::optional<Bytes> data = decode_data_uri(*uri);
    if (!data) where.fail("has a malformed data URI");
    bytes = std::move(*data);
  } else if (uri) {
    bytes = read_external(*uri, document, size, options, where);
  } else if (index == 0 && bin) {
    bytes.assign(bin->begin(), bin->end());
  } else {
    if (index == 0 && document.is_glb && !is_fallback(buffer)) where.fail("has no uri, and the file has no BIN chunk");
    return;
  }
  shorten_to(bytes, size, where);
  document.has_data[index] = true;
}

void read_buffers(Document& document, const std::optional<std::span<const std::uint8_t>>& bin,
                  const ReadOptions& options) {
  const Json* list = find_list(document.json, "buffers", document.name);
  const std::size_t count = list == nullptr ? 0 : list->size();
  document.buffers.resize(count);
  document.has_data.resize(count, false);
  for (std::size_t i = 0; i < count; ++i) read_buffer(document, i, bin, options);
  const bool bin_is_used = count > 0 && find(document.json["buffers"][0], "uri") == nullptr;
  if (bin && !bin_is_used)
    document.extra_chunks.insert(document.extra_chunks.begin(), {glb_bin_chunk, Bytes(bin->begin(), bin->end())});
}

}  // namespace

Document parse_document(std::span<const std::uint8_t> bytes, const std::string& name, const fs::path& folder,
                        const ReadOptions& options) {
  if (bytes.empty()) throw Error(ErrorCode::invalid_input, fmt::format("{} is empty.", name));
  Document document;
  document.name = name;
  document.folder = folder;
  document.is_glb = is_glb(bytes) || fs::path(name).extension() == ".glb";
  GlbChunks chunks;
  if (document.is_glb) {
    chunks = split_glb(bytes, name);
  } else {
    chunks.json = {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
    const std::size_t start = chunks.json.find_first_not_of(" \t\r\n");
    const std::string_view first = start == std::string_view::npos ? "" : chunks.json.substr(start, 1);
    // A byte order mark gets its own sentence from the parser.
    if (first != "{" && first != "[" && first != "\xEF") {
      throw Error(ErrorCode::invalid_input, fmt::format("{} is neither a GLB file nor glTF JSON.", name));
    }
  }
  document.json = parse_json(chunks.json, name);
  document.extra_chunks = std::move(chunks.extra);
  check_asset(document.json, name);
  read_buffers(document, chunks.bin, options);
  return document;
}

Document read_document(const fs::path& path, const ReadOptions& options) {
  const Bytes bytes = read_file(path);
  return parse_document(bytes, path.filename().string(), path.parent_path(), options);
}

std::span<const std::uint8_t> stored_view(const Document& document, std::size_t buffer_view) {
  const Where where{document.name, fmt::format("bufferViews[{}]", buffer_view)};
  const Json* views = find_list(document.json, "bufferViews", document.name);
  if (views == nullptr || buffer_view >= views->size()) where.fail("does not exist");
  const Json& view = (*views)[buffer_view];
  const std::size_t buffer = get_index(view, "buffer", document.buffers.size(), where);
  const std::uint64_t offset = find_unsigned(view, "byteOffset", where).value_or(0);
  const std::uint64_t length = get_unsigned(view, "byteLength", where);
  if (!document.has_data[buffer]) where.fail(fmt::format("lies in buffers[{}], which has no data", buffer));
  const Bytes& bytes = document.buffers[buffer];
  if (length == 0) where.fail("has a byteLength of 0");
  if (offset > bytes.size() || length > bytes.size() - offset) {
    where.fail(fmt::format("covers bytes {} to {} of buffers[{}], which has only {}", offset, offset + length, buffer,
                           bytes.size()));
  }
  return std::span(bytes).subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

}  // namespace nmc::gltf
