// The valid-but-unusual and the invalid files of the shared data, the validator's reports, and the referee.
#pragma once

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/process.h"
#include "support/scratch.h"

namespace nmc::test {

/// The .glb and .gltf files below a folder of the shared data, in order of path; none where there is no such folder.
inline std::vector<std::string> corpus_files(const std::string& folder) {
  const std::filesystem::path root = std::filesystem::path(NMC_SHARED_DIR) / "data" / folder;
  std::vector<std::string> files;
  if (!std::filesystem::exists(root)) return files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    const auto extension = entry.path().extension();
    if (extension == ".glb" || extension == ".gltf") files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

inline bool has_validator() {
  return std::filesystem::exists(std::string(NMC_SOURCE_DIR) + "/tests/node_modules/gltf-validator");
}

/// The Khronos validator's verdict, {file: {numErrors, numWarnings, codes}}.
inline nlohmann::ordered_json validate(const std::vector<std::string>& files) {
  std::vector<std::string> arguments{"node", std::string(NMC_SOURCE_DIR) + "/tests/support/validate.mjs"};
  arguments.insert(arguments.end(), files.begin(), files.end());
  const ProcessResult result = run_process(arguments);
  if (result.exit_code != 0) throw std::runtime_error("validate.mjs: " + result.err);
  return nlohmann::ordered_json::parse(result.out);
}

inline const std::string& referee() {
  static const std::string path = std::string(NMC_SHARED_DIR) + "/tools/measure.py";
  return path;
}

inline bool has_referee() {
  return std::filesystem::exists(referee()) && run_process({"/usr/bin/python3", "-c", "import numpy"}).exit_code == 0;
}

}  // namespace nmc::test
