// Results of earlier runs, found again by what they were made from: input bytes, options, the tool itself.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "gltf/document.h"

namespace nmc::cli {

/// What a run made of a file.
struct CachedResult {
  gltf::Document document;  ///< without the name and folder of the input
  nlohmann::ordered_json report;
  nlohmann::ordered_json tried;  ///< what else a page tells; as it was given to `store`
};

/// A folder of entries. Several processes may use it at the same time: an entry appears whole or not at all.
class Cache {
 public:
  enum class Found { nothing, entry, damaged };

  /// Makes the folder where it is missing unless `look_only`. Throws Error (io).
  Cache(std::string folder, bool look_only);

  /// The key of a result: XXH3-128 over the tool's version and its own bytes, `settings`, the file's bytes and the
  /// bytes of its buffers in other files. 32 hexadecimal digits.
  static std::string key(const std::string& settings, std::span<const std::uint8_t> file,
                         const gltf::Document& document);

  /// Reads an entry into `result`. A file that is not what `store` wrote is `damaged`.
  Found find(const std::string& key, CachedResult& result) const;

  /// Writes an entry beside its place and renames it. Throws Error (io).
  void store(const std::string& key, const gltf::Document& document, const nlohmann::ordered_json& report,
             const nlohmann::ordered_json& tried) const;

 private:
  std::string folder_;
};

}  // namespace nmc::cli
