// bench_comparison FOLDER [PART]: the papers' own experiments on the clips in FOLDER, as tables in Markdown
// (docs/comparison.md). PART: tojo, liu or lin alone.
#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "base/error.h"
#include "comparison_measures.h"

namespace {

using Files = std::vector<std::filesystem::path>;

Files in_folder(const std::filesystem::path& folder, std::initializer_list<const char*> names) {
  Files files;
  for (const char* name : names)
    if (std::filesystem::exists(folder / (std::string(name) + ".glb")))
      files.push_back(folder / (std::string(name) + ".glb"));
    else
      fmt::print(stderr, "bench_comparison: {} is not in {}, it is left out\n", name, folder.string());
  return files;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    fmt::print(stderr, "usage: bench_comparison FOLDER [tojo|liu|lin]\n");
    return 1;
  }
  const std::filesystem::path folder = argv[1];
  const std::string part = argc > 2 ? argv[2] : "";
  try {
    if (part.empty() || part == "tojo")
      nmc::bench::print_tojo(in_folder(folder, {"cmuamc_02_01", "cmuamc_02_03", "cmuamc_35_01", "cmuamc_49_18",
                                                "cmufbx_49_08", "cmubvh_05_06", "cmuamc_02_05", "cmuamc_02_01_30hz",
                                                "cmuamc_49_18_30hz", "keijiro30_85_12"}),
                             10);
    if (part.empty() || part == "liu")
      nmc::bench::print_liu(
          in_folder(folder, {"cmuamc_01_06", "cmubvh_06_13", "cmuamc_02_05", "cmubvh43_indian_04", "keijiro30_85_12"}));
    if (part.empty() || part == "lin")
      nmc::bench::print_lin(in_folder(folder, {"cmuamc_02_01", "cmuamc_35_01", "cmuamc_02_03", "cmuamc_49_18",
                                               "cmubvh_05_06", "cmuamc_02_05", "cmuamc_01_06", "cmubvh_06_13"}),
                            in_folder(folder, {"cmuamc_02_01_30hz", "cmuamc_49_18_30hz", "keijiro30_85_12"}));
  } catch (const nmc::Error& error) {
    fmt::print(stderr, "bench_comparison: {}\n", error.what());
    return 1;
  }
  return 0;
}
