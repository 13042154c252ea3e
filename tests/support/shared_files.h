// The real files that lie beside the repository, where they are.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace nmc::test {

/// The .glb and .gltf files of the shared data (valid ones: game, mocap, odd) up to a size; in order of path.
inline std::vector<std::filesystem::path> shared_files(std::uintmax_t most_bytes) {
  std::vector<std::filesystem::path> files;
  for (const char* folder : {"game", "mocap", "odd"}) {
    const std::filesystem::path root = std::filesystem::path(NMC_SHARED_DIR) / "data" / folder;
    if (!std::filesystem::exists(root)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      const auto extension = entry.path().extension();
      if ((extension == ".glb" || extension == ".gltf") && entry.file_size() <= most_bytes)
        files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace nmc::test
