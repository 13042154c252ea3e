#include "rate_table.h"

#include <fmt/format.h>

#include <algorithm>
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

/// A loop seam as per cent of the size.
std::string seam_text(const Measurement& row, const char* format) {
  return row.loop_seam < 0 ? "-" : fmt::format(fmt::runtime(format), 100 * row.loop_seam);
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

const Measurement* row_of(const RateTable& table, const std::string& start) {
  const auto found = std::find_if(table.rows.begin(), table.rows.end(),
                                  [&](const Measurement& row) { return row.reached && row.method.starts_with(start); });
  return found == table.rows.end() ? nullptr : &*found;
}

template <typename Value>
std::string cell(const Measurement* row, const Value& value, const char* format = "{}") {
  return row ? fmt::format(fmt::runtime(format), value(*row)) : "-";
}

struct Means {
  Mean dct_keys, gltfpack_keys, gltfpack_all, smooth_keys;
};

/// The fewest bytes of a method within a tolerance with no more jitter than another's; 0 where there are none.
std::size_t fewest_as_smooth(const std::vector<RateTable>& tables, const RateTable& table, const std::string& method,
                             double jitter) {
  std::size_t fewest = 0;
  for (const RateTable& other : tables) {
    if (other.file != table.file || other.tolerance_percent > table.tolerance_percent) continue;
    for (const Measurement& row : other.rows)
      if (row.method == method && row.reached && row.jitter <= jitter && (fewest == 0 || row.key_bytes < fewest))
        fewest = row.key_bytes;
  }
  return fewest;
}

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
    fmt::print("| {} | {} | {} | {} | {:.4g} | {} | {:.4g} | {} | {} | {} |\n", row.method, row.key_bytes,
               row.json_bytes, error_text(row), 100 * row.jitter, seam_text(row, "{:.4g}"), 100 * row.contact_drift,
               seconds_text(row), memory_text(row), row.note);
  else
    fmt::print("| {} | - | - | - | - | - | - | - | - | {} |\n", row.method, row.note);
  std::fflush(stdout);
}

void print_brief_head(const std::vector<int>& efforts) {
  std::string head = "| file | tolerance, % |", line = "| --- | ---: |";
  for (const int effort : efforts) {
    head += fmt::format(" effort {0}: keys | seconds | MB |", effort);
    line += " ---: | ---: | ---: |";
  }
  head +=
      " JSON | error, % | jitter, % | seam, % | DCT: keys | gltfpack: keys | JSON | error, % | jitter, % | seam, % |";
  for (int i = 0; i < 10; ++i) line += " ---: |";
  fmt::print("\n{}\n{}\n", head, line);
  std::fflush(stdout);
}

void print_brief_row(const RateTable& table, const std::vector<int>& efforts) {
  const auto keys = [](const Measurement& row) { return row.key_bytes; };
  const auto json = [](const Measurement& row) { return row.json_bytes; };
  const auto error = [](const Measurement& row) { return 100 * row.error; };
  const auto jitter = [](const Measurement& row) { return 100 * row.jitter; };
  const auto seam = [](const Measurement& row) { return seam_text(row, "{:.3f}"); };
  const Measurement* ours = nullptr;
  fmt::print("| {} | {} |", report::printable(table.file), table.tolerance_percent);
  for (const int effort : efforts) {
    ours = row_of(table, default_method(effort));
    fmt::print(" {} | {} | {} |", cell(ours, keys), cell(ours, seconds_text), cell(ours, memory_text));
  }
  const Measurement* gltfpack = row_of(table, "gltfpack");
  fmt::print(" {} | {} | {} | {} | {} |", cell(ours, json), cell(ours, error, "{:.4f}"), cell(ours, jitter, "{:.3f}"),
             cell(ours, seam), cell(row_of(table, "DCT"), keys));
  fmt::print(" {} | {} | {} | {} | {} |\n", cell(gltfpack, keys), cell(gltfpack, json), cell(gltfpack, error, "{:.4f}"),
             cell(gltfpack, jitter, "{:.3f}"), cell(gltfpack, seam));
  std::fflush(stdout);
}

void print_means(const std::vector<RateTable>& tables) {
  std::map<std::pair<double, std::string>, Means> means;
  for (const RateTable& table : tables)
    for (const Measurement& row : table.rows) {
      if (!row.reached || !row.method.starts_with("default")) continue;
      Means& mean = means[{table.tolerance_percent, row.method}];
      for (const Measurement& other : table.rows) {
        if (!other.reached) continue;
        add(row, other, mean);
        if (other.method.starts_with("gltfpack"))
          mean.smooth_keys.add(fewest_as_smooth(tables, table, row.method, other.jitter), other.key_bytes);
      }
    }
  fmt::print("\n### Geometric means over files (in brackets: how many)\n\n");
  fmt::print(
      "| tolerance, % | method | keys / DCT | keys / gltfpack | keys + JSON / gltfpack "
      "| keys at no more jitter / gltfpack |\n");
  fmt::print("| ---: | --- | ---: | ---: | ---: | ---: |\n");
  for (const auto& [key, mean] : means)
    fmt::print("| {} | {} | {} | {} | {} | {} |\n", key.first, key.second, mean.dct_keys.text(),
               mean.gltfpack_keys.text(), mean.gltfpack_all.text(), mean.smooth_keys.text());
}

}  // namespace nmc::bench
