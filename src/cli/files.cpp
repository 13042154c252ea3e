#include "cli/files.h"

#include <fmt/format.h>

#include "base/error.h"

namespace nmc::cli {
namespace {

namespace fs = std::filesystem;

std::string string_member(const gltf::Json& object, const char* key) {
  if (!object.is_object() || !object.contains(key) || !object[key].is_string()) return {};
  return object[key].get<std::string>();
}

std::vector<std::string> member_names(const gltf::Json& root, const char* list) {
  std::vector<std::string> names;
  if (!root.is_object() || !root.contains(list) || !root[list].is_array()) return names;
  for (const gltf::Json& item : root[list]) names.push_back(string_member(item, "name"));
  return names;
}

}  // namespace

void check_output(const std::string& path) {
  const fs::path output(path);
  const std::string extension = output.extension().string();
  if (extension != ".glb" && extension != ".gltf") {
    throw Error(ErrorCode::usage, fmt::format("the output {} must end in .glb or .gltf.", path));
  }
  std::error_code ignored;
  if (fs::is_directory(output, ignored)) {
    throw Error(ErrorCode::io, fmt::format("{} is a folder and cannot be written as a file.", path));
  }
  const fs::path folder = output.has_parent_path() ? output.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    throw Error(ErrorCode::io,
                fmt::format("{} cannot be written: the folder {} does not exist.", path, folder.string()));
  }
}

std::size_t file_bytes(const fs::path& path) {
  std::error_code failure;
  const std::uintmax_t bytes = fs::file_size(path, failure);
  return failure ? 0 : static_cast<std::size_t>(bytes);
}

std::size_t bytes_on_disk(const fs::path& path, const gltf::Document& document) {
  std::size_t bytes = file_bytes(path);
  const gltf::Json& root = document.json;
  if (!root.is_object() || !root.contains("buffers") || !root["buffers"].is_array()) return bytes;
  for (std::size_t i = 0; i < root["buffers"].size() && i < document.buffers.size(); ++i) {
    const std::string uri = string_member(root["buffers"][i], "uri");
    if (!uri.empty() && !uri.starts_with("data:")) bytes += document.buffers[i].size();
  }
  return bytes;
}

std::vector<std::string> node_names(const gltf::Document& document) { return member_names(document.json, "nodes"); }

std::vector<std::string> animation_names(const gltf::Document& document) {
  std::vector<std::string> names = member_names(document.json, "animations");
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) names[i] = fmt::format("#{}", i);
  }
  return names;
}

std::string json_text(const nlohmann::ordered_json& json) {
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace nmc::cli
