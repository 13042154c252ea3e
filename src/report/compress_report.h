// What `gltf-nmc compress` tells about its work, as a table for people and as JSON for programs (docs/cli.md).
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "codec/compress.h"

namespace nmc::report {

/// What surrounds a CompressResult: where it came from and what became of the file.
struct CompressContext {
  std::string version;
  std::string input;
  std::string output;
  codec::Profile profile = codec::Profile::standard;
  std::size_t file_bytes_before = 0;  ///< with the buffers in other files
  std::size_t file_bytes_after = 0;
  double seconds = 0;                   ///< the whole run
  std::vector<std::string> node_names;  ///< by node index, for the worst joint
};

std::string compress_text(const codec::CompressResult& result, const CompressContext& context);
nlohmann::ordered_json compress_json(const codec::CompressResult& result, const CompressContext& context);

/// The text for a file whose result an earlier run made; `report` is what compress_json gave then.
std::string cached_text(const nlohmann::ordered_json& report);

/// "default" or "paper", as on the command line.
const char* profile_name(codec::Profile profile);

/// "compressed", "kept_over_tolerance", "kept_larger", "kept_nothing_to_take".
const char* outcome_name(codec::Outcome outcome);

/// An error report as JSON: lengths in world units and as fractions of `size`.
nlohmann::ordered_json error_json(const motion::ErrorReport& error, double size,
                                  const std::vector<std::string>& node_names);

/// The name of a node in messages: its name, else "node <index>"; "" for -1.
std::string node_label(const std::vector<std::string>& node_names, int node);

}  // namespace nmc::report
