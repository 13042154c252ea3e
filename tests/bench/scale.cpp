// bench_scale TOOL [NAME...]: makes very large files (clips, joints, long, large), compresses each at effort 1 and
// prints time and memory beside the limit of four times the file and 500 MB, and how they grow from a quarter of it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "gltf/document.h"
#include "rate_process.h"
#include "support/tiny_glb.h"

namespace {

using nmc::gltf::Json;

constexpr double mega = 1e6;

struct Shape {
  std::string name;
  std::size_t clips = 1;
  std::size_t joints = 10;
  std::size_t frames = 61;
  double rate = 30;
  std::size_t other_bytes = 0;
  std::size_t Shape::*grows = nullptr;  ///< what makes it large
};

/// A chain of joints that sway, with bytes of no meaning beside them.
class Maker {
 public:
  explicit Maker(const Shape& shape) : shape_(shape) {
    json_["nodes"] = Json::array();
    Json joints = Json::array();
    for (std::size_t i = 0; i < shape.joints; ++i) {
      // Branches of ten keep the skeleton within bounds however many joints there are.
      Json node{{"translation", {0, 0.1, 0}}};
      if (i > 0) parent_of(i)["children"].push_back(i);
      json_["nodes"].push_back(std::move(node));
      joints.push_back(i);
    }
    json_["scenes"] = {{{"nodes", {0}}}};
    json_["skins"] = {{{"joints", joints}}};
    std::vector<float> times;
    for (std::size_t i = 0; i < shape.frames; ++i)
      times.push_back(static_cast<float>(static_cast<double>(i) / shape.rate));
    const std::size_t input = add(times, "SCALAR", 1);
    json_["accessors"][input]["min"] = {times.front()};
    json_["accessors"][input]["max"] = {times.back()};
    for (std::size_t clip = 0; clip < shape.clips; ++clip) add_clip(clip, times, input);
    if (shape.other_bytes > 0) add_noise();
  }

  void write(const std::string& path) {
    nmc::gltf::Document document;
    document.name = "scale.glb";
    document.is_glb = true;
    json_["buffers"] = Json::array({{{"byteLength", bin_.size()}}});
    document.json = std::move(json_);
    document.buffers = {std::move(bin_)};
    document.has_data = {true};
    nmc::gltf::write_document(document, path);
  }

 private:
  Json& parent_of(std::size_t joint) { return json_["nodes"][joint % 10 == 0 ? 0 : joint - 1]; }

  std::size_t add(const std::vector<float>& values, const char* type, std::size_t width) {
    constexpr int floats = 5126;
    return nmc::test::add_accessor(json_, bin_, values, floats, type, width);
  }

  void add_clip(std::size_t clip, const std::vector<float>& times, std::size_t input) {
    Json animation{{"name", fmt::format("clip {}", clip)}, {"channels", Json::array()}, {"samplers", Json::array()}};
    for (std::size_t joint = 0; joint < shape_.joints; ++joint) {
      std::vector<float> turns;
      const double speed = 1.0 + static_cast<double>((joint * 7 + clip * 3) % 11) / 5.0;
      for (const float t : times) {
        const double angle = 0.15 * std::sin(speed * static_cast<double>(t) + static_cast<double>(joint));
        turns.insert(turns.end(), {static_cast<float>(std::sin(angle)), 0, 0, static_cast<float>(std::cos(angle))});
      }
      animation["channels"].push_back({{"sampler", joint}, {"target", {{"node", joint}, {"path", "rotation"}}}});
      animation["samplers"].push_back({{"input", input}, {"output", add(turns, "VEC4", 4)}});
    }
    json_["animations"].push_back(std::move(animation));
  }

  void add_noise() {
    const std::size_t offset = bin_.size();
    bin_.resize(offset + shape_.other_bytes);
    std::uint32_t state = 1;
    for (std::size_t i = offset; i < bin_.size(); ++i) {
      state = state * 1664525 + 1013904223;
      bin_[i] = static_cast<std::uint8_t>(state >> 24);
    }
    json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", shape_.other_bytes}});
  }

  const Shape& shape_;
  Json json_ = {{"asset", {{"version", "2.0"}}}};
  nmc::gltf::Bytes bin_;
};

nmc::bench::ProgramRun measure(const std::string& tool, const Shape& shape, const std::filesystem::path& folder) {
  const std::string in = (folder / (shape.name + ".glb")).string(), out = (folder / (shape.name + "-out.glb")).string();
  Maker(shape).write(in);
  const auto bytes = static_cast<double>(std::filesystem::file_size(in));
  const nmc::bench::ProgramRun run = nmc::bench::run_program({tool, in, out, "--effort", "1", "--quiet"});
  const double limit = 4 * bytes + 500 * mega;
  fmt::print(
      "{:<8} {:>6} clips {:>6} joints {:>7} frames {:>8.1f} MB {:>8.1f} s {:>8.0f} MB of memory, limit {:>6.0f} MB: "
      "{}\n",
      shape.name, shape.clips, shape.joints, shape.frames, bytes / mega, run.seconds,
      static_cast<double>(run.peak_bytes) / mega, limit / mega,
      run.exit_code != 0                             ? "FAILED"
      : static_cast<double>(run.peak_bytes) <= limit ? "within"
                                                     : "OVER");
  std::fflush(stdout);
  for (const std::string& file : {in, out}) std::filesystem::remove(file);
  return run;
}

/// A quarter of it first, for how time and memory grow.
void measure_growth(const std::string& tool, const Shape& shape, const std::filesystem::path& folder) {
  Shape quarter = shape;
  quarter.*shape.grows /= 4;
  const nmc::bench::ProgramRun small = measure(tool, quarter, folder), whole = measure(tool, shape, folder);
  fmt::print("{:<8} four times as much takes {:.1f} times the time and {:.1f} times the memory\n", shape.name,
             whole.seconds / small.seconds,
             static_cast<double>(whole.peak_bytes) / static_cast<double>(small.peak_bytes));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "bench_scale TOOL [clips|joints|long|large ...]\n");
    return 1;
  }
  const std::vector<Shape> shapes{{.name = "clips", .clips = 1000, .joints = 20, .frames = 31, .grows = &Shape::clips},
                                  {.name = "joints", .joints = 2000, .grows = &Shape::joints},
                                  {.name = "long", .frames = 30 * 60 * 120, .rate = 120, .grows = &Shape::frames},
                                  {.name = "large", .other_bytes = 1'500'000'000, .grows = &Shape::other_bytes}};
  const std::vector<std::string> wanted(argv + 2, argv + argc);
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "nmc-bench-scale";
  std::filesystem::create_directories(folder);
  for (const Shape& shape : shapes) {
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), shape.name) != wanted.end())
      measure_growth(argv[1], shape, folder);
  }
  std::filesystem::remove_all(folder);
  return 0;
}
