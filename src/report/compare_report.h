// What `gltf-nmc compare` tells: a table for people, JSON and CSV for programs, a page with a plot.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "baselines/comparison.h"

namespace nmc::report {

struct CompareContext {
  std::string version;
  std::string input;
  std::size_t original_bytes = 0;  ///< of the keys in the file, that ratios are to
};

std::string compare_text(const baselines::Comparison& result, const CompareContext& context);
nlohmann::ordered_json compare_json(const baselines::Comparison& result, const CompareContext& context);

/// One row per encoding that was made; the columns' names in the first.
std::string compare_csv(const baselines::Comparison& result, const CompareContext& context);

/// A page without references to other files: the tables and a plot of error over bytes.
std::string compare_html(const baselines::Comparison& result, const CompareContext& context);

}  // namespace nmc::report
