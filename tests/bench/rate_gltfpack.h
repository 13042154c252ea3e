// gltfpack at many settings: all results of a file once, then the smallest within each tolerance.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "rate_measurement.h"

namespace nmc::bench {

/// The program: `given`, or that of tests/node_modules; empty where it is not installed.
std::string find_gltfpack(const std::string& given);

/// What gltfpack -cz makes of one file with rates and bits of a grid. Errors are measured on its output with
/// EXT_meshopt_compression (-ce ext), which the library's reader unpacks. KHR_meshopt_compression (-ce khr) packs the
/// same numbers, mostly into fewer bytes: they are counted for the settings that are smallest with the other.
class Gltfpack {
 public:
  Gltfpack(std::string program, std::filesystem::path path);

  /// The row with the fewest bytes of keys within the tolerance (share of size); one that is not reached where there is
  /// none.
  Measurement best_within(double tolerance) const;

 private:
  std::vector<std::size_t> smallest_within(double tolerance) const;

  std::string program_;
  std::filesystem::path path_;
  std::vector<std::vector<std::string>> options_;  ///< per setting
  std::vector<Measurement> rows_;                  ///< per setting
};

}  // namespace nmc::bench
