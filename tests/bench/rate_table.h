// The rate table in Markdown, and the geometric means over files.
#pragma once

#include <string>
#include <vector>

#include "rate_measurement.h"

namespace nmc::bench {

/// The rows of one file at one tolerance, in the order in which they were measured.
struct RateTable {
  std::string file;
  double tolerance_percent = 0;
  std::vector<Measurement> rows;
};

void print_head(const std::string& file, double tolerance_percent);
void print_row(const Measurement& row);

/// One line for each file and tolerance instead of a table: bytes of all methods beside each other. `efforts`: those of
/// the default that were measured, in their order; error, jitter and loop seam are of the last.
void print_brief_head(const std::vector<int>& efforts);
void print_brief_row(const RateTable& table, const std::vector<int>& efforts);

/// Per tolerance and effort the geometric mean over files of the default's bytes over those of DCT and of gltfpack.
/// A file counts where both methods reach the tolerance; at no more jitter: where the default has it at this tolerance
/// or at a smaller one that was measured.
void print_means(const std::vector<RateTable>& tables);

}  // namespace nmc::bench
