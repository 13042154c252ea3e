// Prints what the published method reaches on real clips: error and compression ratio for each number of frequencies.
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

#include "codec/paper_profile.h"
#include "codec/source.h"
#include "gltf/document.h"

namespace {

using namespace nmc::codec;

/// A Markdown table of one clip. The ratio is the paper's: numbers in Y over numbers in alpha.
void print_clip(const Source& source, std::size_t index, const CompressOptions& options) {
  const PaperClip result = encode_paper(source, index, options);
  const ClipSource& clip = source.clips[index];
  fmt::print("| K | largest joint error, % of size | ratio | seconds so far |\n| ---: | ---: | ---: | ---: |\n");
  for (const PaperStep& step : result.steps)
    fmt::print("| {} | {:.2f} | {:.2f} | {:.1f} |\n", step.frequencies, 100 * step.joint_error / source.size,
               static_cast<double>(result.values) / static_cast<double>(step.parameters), step.seconds);
  fmt::print("\n{} frames, {} numbers in Y, stream with the least error {} bytes.\n\n", clip.clip.times.size(),
             result.values, result.set.stream.size());
  std::fflush(stdout);
}

void print_file(const std::filesystem::path& path, const CompressOptions& options) {
  const Source source = read_source(nmc::gltf::read_document(path), options);
  for (std::size_t i = 0; i < source.clips.size(); ++i) {
    fmt::print("### {}: {}\n\n", path.stem().string(), source.clips[i].name);
    print_clip(source, i, options);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "usage: bench_paper_results MAX_FREQUENCIES FILE.glb...\n");
    return 1;
  }
  CompressOptions options;
  options.profile = Profile::paper;
  options.max_frequencies = std::atoi(argv[1]);
  options.tolerance.value = 0;  // never reached: every clip runs to the most frequencies
  try {
    for (int i = 2; i < argc; ++i) print_file(argv[i], options);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
