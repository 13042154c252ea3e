// What the commands share about files: early checks of the output, sizes on disk, names of nodes and animations.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "gltf/document.h"

namespace nmc::cli {

/// Refuses an output that could not be written before any work is done. Throws Error: usage (an extension other than
/// .glb and .gltf), io (its folder does not exist, or it is a folder itself).
void check_output(const std::string& path);

/// The bytes of a glTF file with the buffers that lie in other files.
std::size_t bytes_on_disk(const std::filesystem::path& path, const gltf::Document& document);

/// The size of a file, 0 where it cannot be seen.
std::size_t file_bytes(const std::filesystem::path& path);

/// Names by node index; "" where the file gives none.
std::vector<std::string> node_names(const gltf::Document& document);

/// Names by animation index; "#<index>" where the file gives none.
std::vector<std::string> animation_names(const gltf::Document& document);

/// JSON text for standard output.
std::string json_text(const nlohmann::ordered_json& json);

}  // namespace nmc::cli
