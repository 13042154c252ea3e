// What `gltf-nmc inspect` tells: what is inside a compressed file, where its bits went, and what else was tried.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "codec/compress.h"

namespace nmc::report {

struct InspectContext {
  std::string version;
  std::string file;
  std::size_t file_bytes = 0;
  std::vector<std::string> animation_names;  ///< all animations of the file
  std::vector<codec::KeptRecord> kept;       ///< why some are not compressed, where the file says so
};

std::string inspect_text(const std::vector<codec::InspectedSet>& sets, const InspectContext& context);
nlohmann::ordered_json inspect_json(const std::vector<codec::InspectedSet>& sets, const InspectContext& context);

}  // namespace nmc::report
