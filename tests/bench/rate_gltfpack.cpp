#include "rate_gltfpack.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "rate_codec.h"
#include "rate_process.h"
#include "rate_reference.h"

namespace nmc::bench {
namespace {

namespace fs = std::filesystem;

struct Setting {
  int rate_hz = 30;        ///< -af; 0: no resampling
  int rotation_bits = 12;  ///< -ar
  int value_bits = 16;     ///< -at and -as
};

/// Settings that are run again in the other container.
constexpr std::size_t candidates = 6;

/// A folder of its own that goes with the object.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("bench_rate_{}", getpid())) { fs::create_directory(path_); }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  fs::path file(std::size_t index) const { return path_ / fmt::format("{}.glb", index); }

 private:
  fs::path path_;
};

std::vector<Setting> settings_for(double key_rate_hz) {
  std::set<int> rates{0, 15, 30, 60, 120, std::max(1, static_cast<int>(std::lround(key_rate_hz)))};
  std::erase_if(rates, [&](int rate) { return rate > 2 * key_rate_hz && rate > 15; });  // more keys, no less error
  std::vector<Setting> settings;
  for (const int rate : rates)
    for (const int rotation : {8, 9, 10, 11, 12, 14})
      for (const int value : {8, 10, 13, 16}) settings.push_back({rate, rotation, value});
  return settings;
}

std::vector<std::string> options_of(const Setting& setting) {
  const std::string bits = std::to_string(setting.value_bits);
  return {"-cz", "-af", std::to_string(setting.rate_hz), "-ar", std::to_string(setting.rotation_bits), "-at", bits,
          "-as", bits};
}

/// `extension`: ext or khr.
ProgramRun run_setting(const std::string& program, const fs::path& in, const fs::path& out,
                       const std::vector<std::string>& options, const char* extension) {
  std::vector<std::string> arguments{program, "-i", in.string(), "-o", out.string(), "-kn", "-ke"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  arguments.insert(arguments.end(), {"-ce", extension});  // after -cz, which would undo it
  return run_program(arguments);
}

Measurement start_row(const std::vector<std::string>& options, const ProgramRun& run) {
  Measurement row;
  row.method = "gltfpack";
  row.seconds = run.seconds;
  row.peak_bytes = run.peak_bytes;
  row.reached = run.exit_code == 0;
  row.note = fmt::format("{}", fmt::join(options, " "));
  return row;
}

/// Bytes and errors of the files that were made.
nlohmann::json measure_files(const fs::path& original, const Folder& folder, std::vector<Measurement> rows) {
  const Reference reference(original);
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].reached) measure_result(reference, gltf::read_document(folder.file(i)), rows[i]);
  return rows;
}

}  // namespace

std::string find_gltfpack(const std::string& given) {
  if (!given.empty()) return given;
  const fs::path installed = fs::path(NMC_SOURCE_DIR) / "tests/node_modules/.bin/gltfpack";
  return fs::exists(installed) ? installed.string() : "";
}

Gltfpack::Gltfpack(std::string program, fs::path path) : program_(std::move(program)), path_(std::move(path)) {
  const double rate = run_apart([&] { return Reference(path_).key_rate_hz(); }).get<double>();
  const Folder folder;
  std::vector<Measurement> rows;
  for (const Setting& setting : settings_for(rate)) {
    const std::vector<std::string> options = options_of(setting);
    rows.push_back(start_row(options, run_setting(program_, path_, folder.file(rows.size()), options, "ext")));
    options_.push_back(options);
  }
  rows_ = run_apart([&] { return measure_files(path_, folder, rows); }).get<std::vector<Measurement>>();
}

std::vector<std::size_t> Gltfpack::smallest_within(double tolerance) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < rows_.size(); ++i)
    if (rows_[i].reached && rows_[i].error <= tolerance) found.push_back(i);
  std::sort(found.begin(), found.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(rows_[a].key_bytes, a) < std::pair(rows_[b].key_bytes, b);
  });
  found.resize(std::min(found.size(), candidates));
  return found;
}

Measurement Gltfpack::best_within(double tolerance) const {
  Measurement best;
  best.method = "gltfpack";
  best.note = "no setting is within the tolerance";
  const Folder folder;
  for (const std::size_t i : smallest_within(tolerance)) {
    Measurement row = rows_[i];
    const ProgramRun run = run_setting(program_, path_, folder.file(i), options_[i], "khr");
    if (run.exit_code == 0) {
      const auto cost = run_apart([&] { return nlohmann::json(measure_cost(folder.file(i))); }).get<Measurement>();
      if (cost.key_bytes < row.key_bytes) {
        row.key_bytes = cost.key_bytes;
        row.json_bytes = cost.json_bytes;
        row.note += " -ce khr";
      }
    }
    if (!best.reached || row.key_bytes < best.key_bytes) best = row;
  }
  return best;
}

}  // namespace nmc::bench
