#include "report/batch_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "report/format.h"
#include "report/table.h"

namespace nmc::report {
namespace {

using Json = nlohmann::ordered_json;

struct Totals {
  std::size_t animations = 0, compressed = 0, bytes_before = 0, bytes_after = 0;
  std::size_t file_bytes_before = 0, file_bytes_after = 0;
  double max_fraction = 0;

  void add(const Json& report) {
    const Json& sums = report["totals"];
    animations += sums["animations"].get<std::size_t>();
    compressed += sums["compressed"].get<std::size_t>();
    bytes_before += sums["bytes_before"].get<std::size_t>();
    bytes_after += sums["bytes_after"].get<std::size_t>();
    file_bytes_before += report["file_bytes_before"].get<std::size_t>();
    file_bytes_after += report["file_bytes_after"].get<std::size_t>();
    max_fraction = std::max(max_fraction, sums["max_fraction_of_size"].get<double>());
  }

  std::vector<std::string> cells() const {
    return {fmt::format("{}/{}", compressed, animations),
            format_bytes(bytes_before),
            format_bytes(bytes_after),
            format_ratio(bytes_before, bytes_after),
            format_bytes(file_bytes_before),
            format_bytes(file_bytes_after),
            compressed > 0 ? format_percent(max_fraction) : ""};
  }
};

bool is_done(const BatchFile& file) {
  return file.status == FileStatus::compressed || file.status == FileStatus::from_cache;
}

Totals sum(const std::vector<BatchFile>& files) {
  Totals totals;
  for (const BatchFile& file : files)
    if (is_done(file)) totals.add(file.report);
  return totals;
}

std::size_t count(const std::vector<BatchFile>& files, FileStatus status) {
  return static_cast<std::size_t>(
      std::count_if(files.begin(), files.end(), [&](const BatchFile& f) { return f.status == status; }));
}

std::vector<std::string> row(const BatchFile& file) {
  std::vector<std::string> cells{std::filesystem::path(file.input).filename().string()};
  if (is_done(file)) {
    Totals totals;
    totals.add(file.report);
    const std::vector<std::string> numbers = totals.cells();
    cells.insert(cells.end(), numbers.begin(), numbers.end());
    cells.push_back(file.status == FileStatus::from_cache ? "cache"
                                                          : format_seconds(file.report["seconds_spent"].get<double>()));
  } else {
    cells.resize(8);
    cells.push_back("FAILED");
  }
  return cells;
}

std::string dry_line(const BatchFile& file) {
  switch (file.status) {
    case FileStatus::would_compress:
      return fmt::format("would compress {} animations: {} -> {}\n", file.animations, printable(file.input),
                         printable(file.output));
    case FileStatus::would_take_cache:
      return fmt::format("would take from the cache: {} -> {}\n", printable(file.input), printable(file.output));
    default:
      return fmt::format("would fail: {}\n", printable(file.input));
  }
}

std::string table_text(const std::vector<BatchFile>& files, const BatchContext& context) {
  Table table({{"file", Align::left},
               {"clips"},
               {"animations"},
               {"after"},
               {"ratio"},
               {"file"},
               {"after"},
               {"max error"},
               {"spent"}});
  for (const BatchFile& file : files) table.add_row(row(file));
  table.add_rule();
  std::vector<std::string> cells{"total"};
  const std::vector<std::string> numbers = sum(files).cells();
  cells.insert(cells.end(), numbers.begin(), numbers.end());
  cells.push_back(format_seconds(context.seconds));
  table.add_row(std::move(cells));
  return table.text();
}

Json file_json(const BatchFile& file) {
  Json json{{"input", file.input},
            {"output", file.output},
            {"status", status_name(file.status)},
            {"exit_code", file.exit_code}};
  if (!file.error.empty()) json["error"] = file.error;
  if (file.cache_damaged) json["cache_entry_damaged"] = true;
  if (file.status == FileStatus::would_compress) json["animations"] = file.animations;
  if (is_done(file)) json["report"] = file.report;
  return json;
}

}  // namespace

const char* status_name(FileStatus status) {
  switch (status) {
    case FileStatus::compressed:
      return "compressed";
    case FileStatus::from_cache:
      return "from_cache";
    case FileStatus::failed:
      return "failed";
    case FileStatus::would_compress:
      return "would_compress";
    case FileStatus::would_take_cache:
      return "would_take_cache";
  }
  throw std::logic_error("a status without a name");
}

int worst_exit_code(const std::vector<BatchFile>& files) {
  int worst = 0;
  for (const BatchFile& file : files) worst = std::max(worst, file.exit_code);
  return worst;
}

std::string batch_text(const std::vector<BatchFile>& files, const BatchContext& context) {
  std::string out;
  if (context.dry_run) {
    for (const BatchFile& file : files) out += dry_line(file);
    out += "nothing was written\n";
  } else {
    out = table_text(files, context);
  }
  const auto damaged = std::count_if(files.begin(), files.end(), [](const BatchFile& f) { return f.cache_damaged; });
  out += fmt::format("{} files: {} {}", files.size(),
                     count(files, FileStatus::compressed) + count(files, FileStatus::would_compress),
                     context.dry_run ? "to compress" : "compressed");
  if (context.has_cache) {
    out += fmt::format(", {} from the cache",
                       count(files, FileStatus::from_cache) + count(files, FileStatus::would_take_cache));
  }
  out += fmt::format(", {} failed\n", count(files, FileStatus::failed));
  if (damaged > 0) out += fmt::format("note: {} damaged cache entries were not used\n", damaged);
  for (const BatchFile& file : files) {
    if (!is_done(file)) continue;
    for (const Json& note : file.report["notes"])
      out += fmt::format("note: {}: {}\n", printable(file.input), printable(note.get_ref<const std::string&>()));
  }
  return out;
}

Json batch_json(const std::vector<BatchFile>& files, const BatchContext& context) {
  const Totals totals = sum(files);
  Json json{{"command", "compress"},      {"version", context.version},       {"folder", context.folder},
            {"dry_run", context.dry_run}, {"seconds_spent", context.seconds}, {"exit_code", worst_exit_code(files)}};
  json["totals"] = {{"files", files.size()},
                    {"compressed_files", count(files, FileStatus::compressed)},
                    {"from_cache", count(files, FileStatus::from_cache)},
                    {"failed", count(files, FileStatus::failed)},
                    {"animations", totals.animations},
                    {"compressed", totals.compressed},
                    {"bytes_before", totals.bytes_before},
                    {"bytes_after", totals.bytes_after},
                    {"file_bytes_before", totals.file_bytes_before},
                    {"file_bytes_after", totals.file_bytes_after},
                    {"max_fraction_of_size", totals.max_fraction}};
  json["files"] = Json::array();
  for (const BatchFile& file : files) json["files"].push_back(file_json(file));
  return json;
}

}  // namespace nmc::report
