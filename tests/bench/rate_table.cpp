#include "rate_table.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

#include "report/format.h"

namespace nmc::bench {
namespace {

std::string error_text(const Measurement& row) {
  if (!row.joints_only) return fmt::format("{:.4g}", 100 * row.error);
  return fmt::format("{:.4g} on joints alone, {:.4g} with skin", 100 * row.joint_error, 100 * row.error);
}

std::string seconds_text(const Measurement& row) { return row.seconds > 0 ? fmt::format("{:.2f}", row.seconds) : "-"; }

std::string memory_text(const Measurement& row) {
  return row.peak_bytes > 0 ? fmt::format("{:.0f}", static_cast<double>(row.peak_bytes) / 1e6) : "-";
}

/// Geometric means of one line.
class Mean {
 public:
  void add(std::size_t bytes, std::size_t others) {
    if (bytes == 0 || others == 0) return;
    logs_ += std::log(static_cast<double>(bytes) / static_cast<double>(others));
    ++count_;
  }
  std::string text() const { return count_ ? fmt::format("{:.3f} ({})", std::exp(logs_ / count_), count_) : "-"; }

 private:
  double logs_ = 0;
  int count_ = 0;
};

struct Means {
  Mean dct_keys, gltfpack_keys, gltfpack_all;
};

void add(const Measurement& row, const Measurement& other, Means& means) {
  if (other.method.starts_with("DCT")) means.dct_keys.add(row.key_bytes, other.key_bytes);
  if (!other.method.starts_with("gltfpack")) return;
  means.gltfpack_keys.add(row.key_bytes, other.key_bytes);
  means.gltfpack_all.add(row.key_bytes + row.json_bytes, other.key_bytes + other.json_bytes);
}

}  // namespace

void print_head(const std::string& file, double tolerance_percent) {
  fmt::print("\n### {}, {} %\n\n", report::printable(file), tolerance_percent);
  fmt::print(
      "| method | keys, bytes | JSON, bytes | largest error, % of size | jitter, % | loop seam, % | drift, % | seconds "
      "| peak MB "
      "| |\n");
  fmt::print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | --- |\n");
  std::fflush(stdout);
}

void print_row(const Measurement& row) {
  if (row.reached)
    fmt::print("| {} | {} | {} | {} | {:.4g} | {:.4g} | {:.4g} | {} | {} | {} |\n", row.method, row.key_bytes,
               row.json_bytes, error_text(row), 100 * row.jitter, 100 * row.loop_seam, 100 * row.contact_drift,
               seconds_text(row), memory_text(row), row.note);
  else
    fmt::print("| {} | - | - | - | - | - | - | - | - | {} |\n", row.method, row.note);
  std::fflush(stdout);
}

void print_means(const std::vector<RateTable>& tables) {
  std::map<std::pair<double, std::string>, Means> means;
  for (const RateTable& table : tables)
    for (const Measurement& row : table.rows) {
      if (!row.reached || !row.method.starts_with("default")) continue;
      for (const Measurement& other : table.rows)
        if (other.reached) add(row, other, means[{table.tolerance_percent, row.method}]);
    }
  fmt::print("\n### Geometric means over files (in brackets: how many)\n\n");
  fmt::print("| tolerance, % | method | keys / DCT | keys / gltfpack | keys + JSON / gltfpack |\n");
  fmt::print("| ---: | --- | ---: | ---: | ---: |\n");
  for (const auto& [key, mean] : means)
    fmt::print("| {} | {} | {} | {} | {} |\n", key.first, key.second, mean.dct_keys.text(), mean.gltfpack_keys.text(),
               mean.gltfpack_all.text());
}

}  // namespace nmc::bench
