// The HTML report as a file: checked before any work, written at the end.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "codec/comparison.h"

namespace nmc::cli {

/// Refuses a report that could not be written, or would replace one of `files`. Nothing where `path` is empty. Throws
/// Error: usage (no .html, one of the files), io (its folder does not exist, or it is a folder itself).
void check_report(const std::string& path, const std::vector<std::string>& files);

/// Throws Error (io).
void write_report(const std::string& path, const nlohmann::ordered_json& report, const codec::Comparison& comparison);

}  // namespace nmc::cli
