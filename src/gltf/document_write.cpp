// Writes a glTF document: GLB, or .gltf with its buffers and images beside it.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <system_error>

#include "base/error.h"
#include "gltf/document.h"
#include "gltf/files.h"
#include "gltf/glb.h"
#include "gltf/json_text.h"
#include "gltf/uri.h"

namespace nmc::gltf {
namespace {

namespace fs = std::filesystem;

std::optional<std::string> uri_of(const Json& object) {
  const Json* uri = find(object, "uri");
  if (uri == nullptr || !uri->is_string()) return std::nullopt;
  return uri->get<std::string>();
}

fs::path or_here(const fs::path& folder) { return folder.empty() ? fs::path(".") : folder; }

bool same_path(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::weakly_canonical(fs::absolute(a, error), error) == fs::weakly_canonical(fs::absolute(b, error), error) &&
         !error;
}

bool starts_with(std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> start) {
  return bytes.size() >= start.size() && std::equal(start.begin(), start.end(), bytes.begin());
}

bool is_existing_file(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

/// Bytes that go into a buffer's data URI; a URI that says the same already stays as it is.
void set_data_uri(Json& buffer, const Bytes& bytes) {
  const std::optional<std::string> uri = uri_of(buffer);
  if (uri && is_data_uri(*uri)) {
    const std::optional<Bytes> old_bytes = decode_data_uri(*uri);
    if (old_bytes && starts_with(*old_bytes, bytes)) return;
  }
  buffer["uri"] = encode_data_uri(bytes);
}

/// True when the buffer lies in another file beside the input, and that file holds the buffer's bytes still.
bool lies_outside_unchanged(const Json& buffer, const Bytes& bytes, const fs::path& folder) {
  const std::optional<std::string> uri = uri_of(buffer);
  if (!uri) return false;
  const std::optional<fs::path> path = resolve_uri(*uri, folder, false);
  return path && is_existing_file(*path) && starts_with(read_file(*path, bytes.size()), bytes);
}

Json& buffer_json(Json& json, std::size_t index) { return json["buffers"][index]; }

void check_buffers(const Document& document) {
  const std::size_t count = list_size(document.json, "buffers", document.name);
  if (document.buffers.size() != count || document.has_data.size() != count) {
    throw Error(ErrorCode::internal,
                fmt::format("{}: the buffers of the document do not match its JSON.", document.name));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Where where{document.name, fmt::format("buffers[{}]", i)};
    if (document.has_data[i] &&
        get_unsigned(document.json["buffers"][i], "byteLength", where) != document.buffers[i].size()) {
      throw Error(ErrorCode::internal,
                  fmt::format("{}: buffers[{}] has a byteLength that is not its size.", document.name, i));
    }
  }
}

/// The JSON of the document as a GLB: buffer 0 in the BIN chunk, every other buffer in a data URI, except for a GLB's
/// external buffers that nobody has changed. `outside` collects the URIs of those.
Json glb_json(const Document& document, std::vector<std::string>& outside) {
  Json json = document.json;
  for (std::size_t i = 0; i < document.buffers.size(); ++i) {
    if (!document.has_data[i]) continue;
    Json& buffer = buffer_json(json, i);
    if (i == 0) {
      buffer.erase("uri");
    } else if (document.is_glb && lies_outside_unchanged(buffer, document.buffers[i], document.folder)) {
      outside.push_back(*uri_of(buffer));
    } else {
      set_data_uri(buffer, document.buffers[i]);
    }
  }
  return json;
}

Bytes glb_bytes(const Document& document, const Json& json) {
  const bool has_bin = !document.buffers.empty() && document.has_data[0];
  std::vector<ExtraChunk> extra = document.extra_chunks;
  // A BIN chunk that no buffer used can stay only while the place of the BIN chunk is free.
  if (has_bin) std::erase_if(extra, [](const ExtraChunk& chunk) { return chunk.type == glb_bin_chunk; });
  std::optional<std::span<const std::uint8_t>> bin;
  if (has_bin) bin = document.buffers[0];
  return join_glb(json.dump(), bin, extra, document.name);
}

/// A file that the output refers to by a relative URI, to be found beside the output as well.
struct Companion {
  fs::path source;
  fs::path target;
};

/// Files beside the input that `uris` name, with their places beside the output. URIs that lead out of either folder
/// are not followed, and files that do not exist are no worse missing from the output than from the input.
std::vector<Companion> find_companions(const Document& document, const std::vector<std::string>& uris,
                                       const fs::path& folder) {
  std::vector<Companion> companions;
  if (same_path(or_here(document.folder), or_here(folder))) return companions;
  for (const std::string& uri : uris) {
    const std::optional<fs::path> source = resolve_uri(uri, document.folder, false);
    const std::optional<fs::path> target = resolve_uri(uri, folder, false);
    if (source && target && is_existing_file(*source)) companions.push_back({*source, *target});
  }
  return companions;
}

std::vector<std::string> image_uris(const Document& document) {
  std::vector<std::string> uris;
  const Json* images = find(document.json, "images");
  if (images == nullptr || !images->is_array()) return uris;
  for (const Json& image : *images) {
    const std::optional<std::string> uri = uri_of(image);
    if (uri && !has_scheme(*uri)) uris.push_back(*uri);
  }
  return uris;
}

void add_companions(FileReplacement& files, const std::vector<Companion>& companions) {
  for (const Companion& companion : companions) {
    const Bytes bytes = read_file(companion.source);
    std::error_code error;
    if (fs::exists(companion.target, error)) {
      if (is_existing_file(companion.target) && read_file(companion.target) == bytes) continue;
      throw Error(ErrorCode::io, fmt::format("{} exists already and differs from {}; choose another output folder.",
                                             companion.target.string(), companion.source.string()));
    }
    fs::create_directories(or_here(companion.target.parent_path()), error);
    files.add(companion.target, bytes);
  }
}

/// Refuses to write a buffer over a file that the input needs under that name, when the input itself stays.
void protect_input(const Document& document, const fs::path& output, const fs::path& buffer_file) {
  if (same_path(document.folder / document.name, output)) return;
  std::vector<std::string> uris = image_uris(document);
  for (const Json& buffer : document.json["buffers"]) {
    if (const std::optional<std::string> uri = uri_of(buffer)) uris.push_back(*uri);
  }
  for (const std::string& uri : uris) {
    const std::optional<fs::path> path = resolve_uri(uri, document.folder, false);
    if (path && is_existing_file(*path) && same_path(*path, buffer_file)) {
      throw Error(ErrorCode::io,
                  fmt::format("{} belongs to the input {} and would be overwritten; choose another output name.",
                              buffer_file.string(), document.name));
    }
  }
}

/// 32 bits of FNV-1a, as eight digits.
std::string short_hash(std::span<const std::uint8_t> bytes) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 1099511628211ULL;
  return fmt::format("{:08x}", static_cast<std::uint32_t>(hash >> 32 ^ hash));
}

/// The stem of the names of a document's buffer files: "small.gltf" has "small.bin", its second buffer "small_1.bin".
std::string buffer_stem(const fs::path& document, std::size_t index) {
  return document.stem().string() + (index == 0 ? std::string() : fmt::format("_{}", index));
}

/// A name for a buffer's file that takes no other file's place: until the new .gltf is in its place the old one needs
/// its own buffers.
std::string buffer_name(const fs::path& document, std::size_t index, const Bytes& bytes) {
  const std::string stem = buffer_stem(document, index);
  const fs::path folder = document.parent_path();
  const auto is_free = [&](const std::string& name) {
    std::error_code error;
    if (!fs::exists(fs::symlink_status(folder / name, error))) return true;
    return is_existing_file(folder / name) && fs::file_size(folder / name, error) == bytes.size() && !error &&
           read_file(folder / name) == bytes;
  };
  std::string name = stem + ".bin";
  if (is_free(name)) return name;
  const std::string hash = short_hash(bytes);
  name = fmt::format("{}.{}.bin", stem, hash);
  for (int more = 2; !is_free(name); ++more) name = fmt::format("{}.{}.{}.bin", stem, hash, more);
  return name;
}

/// The buffer files of the .gltf that stands where `path` will be written, as far as this program has named them.
std::vector<fs::path> old_buffer_files(const fs::path& path) {
  std::vector<fs::path> files;
  if (!is_existing_file(path)) return files;
  const Bytes bytes = read_file(path);
  const Json json = Json::parse(bytes.begin(), bytes.end(), nullptr, false);
  const Json* buffers = json.is_object() ? find(json, "buffers") : nullptr;
  if (buffers == nullptr || !buffers->is_array()) return files;
  for (std::size_t i = 0; i < buffers->size(); ++i) {
    const std::optional<std::string> uri = uri_of((*buffers)[i]);
    const std::optional<std::string> name = uri ? percent_decode(*uri) : std::nullopt;
    const std::string stem = buffer_stem(path, i) + ".";
    if (name && name->find('/') == std::string::npos && name->starts_with(stem) && name->ends_with(".bin"))
      files.push_back(path.parent_path() / *name);
  }
  return files;
}

/// Removes files that the .gltf just replaced has needed and that the new one does not.
void remove_files(const std::vector<fs::path>& old_files, const Json& json, const fs::path& folder) {
  for (const fs::path& file : old_files) {
    bool needed = false;
    for (const Json& buffer : json["buffers"]) {
      const std::optional<std::string> uri = uri_of(buffer);
      if (const auto name = uri ? percent_decode(*uri) : std::nullopt) needed = needed || folder / *name == file;
    }
    std::error_code ignored;
    if (!needed && is_existing_file(file)) fs::remove(file, ignored);
  }
}

/// The document as .gltf: data URIs stay data URIs, every other buffer gets a file of its own beside the output.
Json add_gltf_buffers(const Document& document, const fs::path& path, FileReplacement& files) {
  Json json = document.json;
  for (std::size_t i = 0; i < document.buffers.size(); ++i) {
    if (!document.has_data[i]) continue;
    Json& buffer = buffer_json(json, i);
    const std::optional<std::string> uri = uri_of(buffer);
    if (uri && is_data_uri(*uri)) {
      set_data_uri(buffer, document.buffers[i]);
      continue;
    }
    protect_input(document, path, path.parent_path() / (buffer_stem(path, i) + ".bin"));
    const std::string name = buffer_name(path, i, document.buffers[i]);
    if (!is_existing_file(path.parent_path() / name)) files.add(path.parent_path() / name, document.buffers[i]);
    buffer["uri"] = percent_encode(name);
  }
  return json;
}

std::span<const std::uint8_t> as_bytes(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

Bytes to_glb(const Document& document) {
  check_buffers(document);
  std::vector<std::string> outside;
  return glb_bytes(document, glb_json(document, outside));
}

void write_document(const Document& document, const fs::path& path) {
  check_buffers(document);
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".glb" && extension != ".gltf") {
    throw Error(ErrorCode::usage, fmt::format("{} must end in .glb or .gltf.", path.string()));
  }
  FileReplacement files;
  std::vector<std::string> outside = image_uris(document);
  if (extension == ".glb") {
    const Json json = glb_json(document, outside);
    add_companions(files, find_companions(document, outside, path.parent_path()));
    files.add(path, glb_bytes(document, json));
    files.commit();
    return;
  }
  const FolderLock lock(path.parent_path());
  add_companions(files, find_companions(document, outside, path.parent_path()));
  const Json json = add_gltf_buffers(document, path, files);
  files.add(path, as_bytes(json.dump(document.is_glb ? -1 : 2)));
  const std::vector<fs::path> old_files = old_buffer_files(path);
  files.commit();
  remove_files(old_files, json, path.parent_path());
}

}  // namespace nmc::gltf
