#include "cli/outputs.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>

#include "base/error.h"

namespace nmc::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* try_help = "try gltf-nmc compress --help.";

[[noreturn]] void refuse(const std::string& sentence) { throw Error(ErrorCode::usage, sentence); }

bool is_model_name(const fs::path& path) { return path.extension() == ".glb" || path.extension() == ".gltf"; }

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

Outputs one_pair(const std::vector<std::string>& files) {
  if (files.empty()) refuse(fmt::format("a file is missing on the command line (IN is required); {}", try_help));
  if (files.size() == 1) {
    refuse(fmt::format("a file is missing on the command line (OUT is required): write {} OUT or {} -o OUT; {}",
                       files[0], files[0], try_help));
  }
  if (files.size() > 2) {
    refuse(fmt::format("the argument '{}' is one too many, and '{}' is no command: several inputs need -o FOLDER; {}",
                       files[2], files[0], try_help));
  }
  return {{{files[0], files[1]}}, ""};
}

}  // namespace

Outputs plan_outputs(const std::vector<std::string>& files, const std::string& output) {
  if (output.empty()) return one_pair(files);
  if (files.empty()) refuse(fmt::format("a file is missing on the command line (IN is required); {}", try_help));
  if (is_model_name(output) && !output.ends_with('/') && !is_folder(output)) {
    if (files.size() > 1) {
      refuse(fmt::format("-o: {} is one file and there are {} inputs; name a folder, such as out/.", output,
                         files.size()));
    }
    return {{{files[0], output}}, ""};
  }
  Outputs outputs;
  outputs.folder = output;
  std::map<std::string, std::string> inputs;
  for (const std::string& input : files) {
    const fs::path name = fs::path(input).filename();
    if (!is_model_name(name)) refuse(fmt::format("the input {} must end in .glb or .gltf.", input));
    const auto [other, is_new] = inputs.emplace(name.string(), input);
    if (!is_new) {
      refuse(fmt::format("{} and {} have the same name and would both become {}; compress them into two folders.",
                         other->second, input, (fs::path(output) / name).string()));
    }
    outputs.files.push_back({input, (fs::path(output) / name).string()});
  }
  return outputs;
}

void make_folder(const std::string& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (!is_folder(folder)) {
    throw Error(ErrorCode::io, fmt::format("the folder {} cannot be made: {}.", folder,
                                           failure ? failure.message() : "a file is in its place"));
  }
}

}  // namespace nmc::cli
