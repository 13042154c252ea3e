// gltf-nmc import: motion capture in BVH to an animated, skinned glTF file.
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "base/error.h"
#include "cli/command.h"
#include "cli/files.h"
#include "codec/import_bvh.h"
#include "gltf/files.h"
#include "motion/bvh.h"
#include "report/format.h"

namespace nmc::cli {
namespace {

struct Arguments {
  std::string input;
  std::string output;
  double frames_per_second = 0;
  double scale = 1;
  std::string name;
  bool quiet = false;
};

std::string read_text(const std::string& path) {
  const gltf::Bytes bytes = gltf::read_file(path);
  return {bytes.begin(), bytes.end()};
}

int run(const Arguments& a) {
  check_output(a.output);
  motion::BvhOptions options;
  options.scale = a.scale;
  options.frames_per_second = a.frames_per_second;
  options.clip_name = a.name.empty() ? std::filesystem::path(a.input).stem().string() : a.name;
  const motion::BvhClip bvh = motion::parse_bvh(read_text(a.input), a.input, options);
  const gltf::Document document = codec::import_bvh(bvh);
  gltf::write_document(document, a.output);
  if (a.quiet) return 0;
  const std::vector<float>& times = bvh.clip.times;
  print(fmt::format("{} -> {}: {} joints, {} frames, {}\n", report::printable(a.input), report::printable(a.output),
                    bvh.skeleton.joints.size(), times.size(), report::format_seconds(times.back())));
  return 0;
}

}  // namespace

Run import_command(CLI::App& app) {
  const auto a = std::make_shared<Arguments>();
  app.add_option("IN", a->input, "the motion: .bvh")->required();
  app.add_option("OUT", a->output, "the file to write: .glb, or .gltf with a .bin beside it")->required();
  app.add_option("--fps", a->frames_per_second,
                 "keep every n-th frame to come nearest to this rate, above 0\n(default all frames)")
      ->type_name("N")
      ->check(positive_number())
      ->group("Motion");
  app.add_option("--scale", a->scale, "metres per unit of the file, above 0 (default 1)")
      ->type_name("S")
      ->check(positive_number())
      ->group("Motion");
  app.add_option("--name", a->name, "the animation's name (default the file's name)")
      ->type_name("NAME")
      ->group("Motion");
  app.add_flag("-q,--quiet", a->quiet, "print nothing but errors")->group("Output");
  return [=] { return run(*a); };
}

}  // namespace nmc::cli
