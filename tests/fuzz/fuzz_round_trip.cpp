// Any animation of any small skeleton: compressed twice it is the same bytes, and what was compressed is decoded within
// the tolerance, by the tool's own measure over the two files.
#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "codec/compress.h"
#include "fuzz/require.h"
#include "support/tiny_glb.h"

namespace {

using namespace nmc;
using gltf::Json;

/// A document made of what the fuzzer says: a few nodes in a tree, some of them in a skin, and one to three animations.
class DocumentMaker {
 public:
  explicit DocumentMaker(FuzzedDataProvider& data) : data_(data) {}

  gltf::Document make() {
    const int nodes = data_.ConsumeIntegralInRange(1, 4);
    json_["nodes"] = Json::array();
    for (int i = 0; i < nodes; ++i) json_["nodes"].push_back(node());
    Json roots = Json::array({0});
    for (int i = 1; i < nodes; ++i) {
      const int parent = data_.ConsumeIntegralInRange(-1, i - 1);
      if (parent < 0) {
        roots.push_back(i);
      } else {
        json_["nodes"][static_cast<std::size_t>(parent)]["children"].push_back(i);
      }
    }
    json_["scenes"] = Json::array({{{"nodes", roots}}});
    if (data_.ConsumeBool()) {
      Json joints = Json::array();
      for (int i = 0; i < nodes; ++i) joints.push_back(i);
      json_["skins"] = Json::array({{{"joints", joints}}});
    }
    json_["animations"] = Json::array();
    const int animations = data_.ConsumeIntegralInRange(1, 3);
    for (int i = 0; i < animations; ++i) {
      Json made = animation(nodes);  // adds accessors, which moves the array
      json_["animations"].push_back(std::move(made));
    }
    return document();
  }

 private:
  float number(float most) { return data_.ConsumeFloatingPointInRange(-most, most); }

  Json node() {
    Json node = Json::object();
    if (data_.ConsumeBool()) node["translation"] = {number(2), number(2), number(2)};
    if (data_.ConsumeBool()) node["scale"] = {number(2), number(2), number(2)};
    if (data_.ConsumeBool()) node["rotation"] = rotation();
    return node;
  }

  std::vector<float> rotation() {
    std::vector<float> q{number(1), number(1), number(1), number(1)};
    float length = 0;
    for (const float x : q) length += x * x;
    length = std::sqrt(length);
    if (length < 1e-3f) return {0, 0, 0, 1};
    for (float& x : q) x /= length;
    return q;
  }

  std::size_t accessor(const char* type, std::size_t width, const std::vector<float>& values) {
    constexpr int floats = 5126;
    return nmc::test::add_accessor(json_, bin_, values, floats, type, width);
  }

  std::vector<float> times() {
    const int keys = data_.ConsumeIntegralInRange(1, 24);
    const bool uneven = data_.ConsumeBool();
    std::vector<float> times{data_.ConsumeBool() ? 0.0f : data_.ConsumeFloatingPointInRange(0.0f, 100.0f)};
    for (int i = 1; i < keys; ++i) {
      const float step = uneven ? data_.ConsumeFloatingPointInRange(0.001f, 1.0f) : 1.0f / 32;
      times.push_back(times.back() + step);
    }
    return times;
  }

  /// Values of keys: still, smooth, or anything.
  std::vector<float> values(std::size_t rows, bool rotations) {
    const int kind = data_.ConsumeIntegralInRange(0, 2);
    const float most = data_.ConsumeBool() ? 1.0f : 100.0f;
    std::vector<float> all, first;
    for (std::size_t i = 0; i < rows; ++i) {
      std::vector<float> row = rotations ? rotation() : std::vector<float>{number(most), number(most), number(most)};
      if (i == 0) first = row;
      if (kind == 0) row = first;
      if (kind == 1 && rotations) {
        const float angle = 0.1f * static_cast<float>(i) * first[0];
        row = {std::sin(angle), 0, 0, std::cos(angle)};
      } else if (kind == 1) {
        for (std::size_t a = 0; a < 3; ++a) row[a] = first[a] * std::sin(0.3f * static_cast<float>(i + a));
      }
      all.insert(all.end(), row.begin(), row.end());
    }
    return all;
  }

  Json animation(int nodes) {
    Json animation{{"channels", Json::array()}, {"samplers", Json::array()}};
    std::size_t input = 0, keys = 0;
    for (int node = 0; node < nodes; ++node) {
      for (const char* path : {"translation", "rotation", "scale"}) {
        const bool any = !animation["channels"].empty();
        if (any && data_.ConsumeBool()) continue;
        if (!any || data_.ConsumeIntegralInRange(0, 3) == 0) {
          const std::vector<float> seconds = times();
          keys = seconds.size();
          input = accessor("SCALAR", 1, seconds);
        }
        const bool rotations = path[0] == 'r';
        const char* interpolation = "LINEAR";
        std::size_t rows = keys;
        const int kind = data_.ConsumeIntegralInRange(0, 7);
        if (kind == 0) interpolation = "STEP";
        if (kind == 1 && keys > 1) {
          interpolation = "CUBICSPLINE";
          rows *= 3;
        }
        const std::size_t output = accessor(rotations ? "VEC4" : "VEC3", rotations ? 4 : 3, values(rows, rotations));
        animation["channels"].push_back(
            {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
        animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
      }
    }
    return animation;
  }

  gltf::Document document() {
    json_["buffers"] = Json::array({{{"byteLength", bin_.size()}}});
    gltf::Document document;
    document.name = "fuzz.glb";
    document.is_glb = true;
    document.json = json_;
    document.buffers = {bin_};
    document.has_data = {true};
    return gltf::parse_document(gltf::to_glb(document), "fuzz.glb", {});
  }

  FuzzedDataProvider& data_;
  Json json_ = {{"asset", {{"version", "2.0"}}}};
  gltf::Bytes bin_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  codec::CompressOptions options;
  options.effort = 1;
  options.threads = 1;
  options.tolerance.value = data.ConsumeBool() ? 0.001 : 0.05;
  gltf::Document document;
  try {
    document = DocumentMaker(data).make();
    gltf::read_asset(document);
  } catch (const Error& error) {
    fuzz::require(error.code() != ErrorCode::internal, error.what());
    return 0;  // such as a cubic rotation through zero
  }
  codec::CompressResult made;
  try {
    made = codec::compress(document, options);
  } catch (const Error& error) {
    fuzz::require(error.code() != ErrorCode::internal, error.what());
    return 0;
  }
  const gltf::Bytes packed = gltf::to_glb(made.document);
  options.threads = 2;
  fuzz::require(gltf::to_glb(codec::compress(document, options).document) == packed, "the same bytes come out twice");
  const gltf::Document plain = codec::expand(gltf::parse_document(packed, "packed.glb", {}));
  const codec::Verification error = codec::verify(document, plain);
  for (const codec::VerifiedClip& clip : error.clips)
    fuzz::require(clip.error.max <= 1.0001 * made.tolerance, "the tolerance is kept");
  return 0;
}
