// What `gltf-nmc compress` tells about several files: one table of a row per file, one JSON document (docs/cli.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace nmc::report {

enum class FileStatus {
  compressed,
  from_cache,
  failed,
  would_compress,    ///< --dry-run
  would_take_cache,  ///< --dry-run
};

/// "compressed", "from_cache", "failed", "would_compress", "would_take_cache".
const char* status_name(FileStatus status);

struct BatchFile {
  std::string input;
  std::string output;
  FileStatus status = FileStatus::failed;
  int exit_code = 0;
  std::string error;              ///< one sentence where it failed
  nlohmann::ordered_json report;  ///< as compress_json gives it; null where nothing was compressed
  bool cache_damaged = false;     ///< an entry was there and could not be used
  std::size_t animations = 0;     ///< --dry-run: in the input
};

struct BatchContext {
  std::string version;
  std::string folder;
  bool dry_run = false;
  bool has_cache = false;
  double seconds = 0;
};

/// The highest exit code of the files.
int worst_exit_code(const std::vector<BatchFile>& files);

std::string batch_text(const std::vector<BatchFile>& files, const BatchContext& context);
nlohmann::ordered_json batch_json(const std::vector<BatchFile>& files, const BatchContext& context);

}  // namespace nmc::report
