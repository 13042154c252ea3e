#include "cli/report_file.h"

#include <fmt/format.h>

#include <filesystem>

#include "base/error.h"
#include "gltf/files.h"
#include "report/html_report.h"

namespace nmc::cli {

namespace fs = std::filesystem;

void check_report(const std::string& path, const std::vector<std::string>& files) {
  if (path.empty()) return;
  const fs::path report(path);
  const std::string extension = report.extension().string();
  if (extension != ".html" && extension != ".htm")
    throw Error(ErrorCode::usage, fmt::format("--report: {} must end in .html.", path));
  std::error_code ignored;
  for (const std::string& file : files)
    if (fs::equivalent(report, file, ignored))
      throw Error(ErrorCode::usage, fmt::format("--report: {} is a file of the command line already.", path));
  if (fs::is_directory(report, ignored))
    throw Error(ErrorCode::io, fmt::format("--report: {} is a folder and cannot be written as a file.", path));
  const fs::path folder = report.has_parent_path() ? report.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored))
    throw Error(ErrorCode::io,
                fmt::format("--report: {} cannot be written: the folder {} does not exist.", path, folder.string()));
}

void write_report(const std::string& path, const nlohmann::ordered_json& report, const codec::Comparison& comparison) {
  const std::string page = report::html_report(report, comparison);
  gltf::FileReplacement file;
  file.add(path, {reinterpret_cast<const std::uint8_t*>(page.data()), page.size()});
  file.commit();
}

}  // namespace nmc::cli
