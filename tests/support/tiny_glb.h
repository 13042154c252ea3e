// A small valid animated character made in memory, whose parts a test can break one at a time.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "support/scratch.h"

namespace nmc::test {

using Json = nlohmann::ordered_json;

inline constexpr std::uint32_t json_chunk = 0x4E4F534A;
inline constexpr std::uint32_t bin_chunk = 0x004E4942;

inline void append_u32(Bytes& bytes, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(value >> shift));
}

/// GLB bytes (glTF 2.0, section 4.4) of JSON and BIN.
inline Bytes make_glb(const Json& json, const Bytes& bin) {
  std::string text = json.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  Bytes data = bin;
  data.resize((data.size() + 3) / 4 * 4);
  Bytes out;
  append_u32(out, 0x46546C67);
  append_u32(out, 2);
  append_u32(out, static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + data.size()));
  append_u32(out, static_cast<std::uint32_t>(text.size()));
  append_u32(out, json_chunk);
  out.insert(out.end(), text.begin(), text.end());
  append_u32(out, static_cast<std::uint32_t>(data.size()));
  append_u32(out, bin_chunk);
  out.insert(out.end(), data.begin(), data.end());
  return out;
}

struct GlbParts {
  Json json;
  Bytes bin;
};

/// The parts of a well-formed GLB with both chunks.
inline GlbParts split_glb(const Bytes& glb) {
  const auto u32 = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, glb.data() + at, 4);
    return value;
  };
  const std::size_t json_bytes = u32(12);
  GlbParts parts;
  parts.json = Json::parse(glb.begin() + 20, glb.begin() + static_cast<std::ptrdiff_t>(20 + json_bytes));
  if (20 + json_bytes < glb.size())
    parts.bin.assign(glb.begin() + static_cast<std::ptrdiff_t>(28 + json_bytes), glb.end());
  return parts;
}

/// Adds numbers to BIN with a bufferView and an accessor; returns the accessor.
template <typename Number>
std::size_t add_accessor(Json& json, Bytes& bin, const std::vector<Number>& numbers, int component_type,
                         const std::string& type, std::size_t width) {
  bin.resize((bin.size() + 3) / 4 * 4);
  const std::size_t offset = bin.size();
  bin.resize(offset + numbers.size() * sizeof(Number));
  std::memcpy(bin.data() + offset, numbers.data(), numbers.size() * sizeof(Number));
  json["bufferViews"].push_back(
      {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", numbers.size() * sizeof(Number)}});
  json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                               {"componentType", component_type},
                               {"count", numbers.size() / width},
                               {"type", type}});
  return json["accessors"].size() - 1;
}

/// Two joints ("root" and "tip", one metre apart), a skinned strip along them, and the animation "wave": both joints
/// turn smoothly for `frames` frames at 30 Hz, the root also moves. Change `json` and `bin` and ask for bytes().
class TinyGlb {
 public:
  explicit TinyGlb(std::size_t frames = 61) {
    json = {{"asset", {{"version", "2.0"}, {"generator", "tests"}}},
            {"scene", 0},
            {"scenes", {{{"name", "stage"}, {"nodes", {0, 2}}}}},
            {"nodes",
             {{{"name", "root"}, {"children", {1}}},
              {{"name", "tip"}, {"translation", {0, 1, 0}}},
              {{"name", "body"}, {"mesh", 0}, {"skin", 0}}}},
            {"meshes", Json::array()},
            {"skins", Json::array()},
            {"animations", Json::array()},
            {"accessors", Json::array()},
            {"bufferViews", Json::array()},
            {"extras", {{"kept", {1, 2.5, "three", nullptr}}}}};
    add_mesh();
    add_animation(frames);
  }

  /// Adds numbers as add_accessor does.
  template <typename Number>
  std::size_t add(const std::vector<Number>& numbers, int component_type, const std::string& type, std::size_t width) {
    return add_accessor(json, bin, numbers, component_type, type, width);
  }

  /// Where the data of an accessor lie in BIN.
  std::size_t offset_of(std::size_t accessor) const {
    return json["bufferViews"][json["accessors"][accessor]["bufferView"].get<std::size_t>()]["byteOffset"]
        .get<std::size_t>();
  }

  Bytes bytes() const {
    Json whole = json;
    whole["buffers"] = Json::array({{{"byteLength", (bin.size() + 3) / 4 * 4}}});
    return make_glb(whole, bin);
  }

  Json json;
  Bytes bin;
  std::size_t times = 0;          ///< accessor of the key times
  std::size_t root_rotation = 0;  ///< accessor of the root's rotation keys

 private:
  static constexpr int f32 = 5126;

  void add_mesh() {
    std::vector<float> positions;
    std::vector<std::uint8_t> joints;
    std::vector<float> weights;
    for (int i = 0; i <= 4; ++i) {
      const float y = 0.5F * static_cast<float>(i);
      const float share = std::min(1.0F, std::max(0.0F, y - 0.5F));
      for (const float x : {-0.1F, 0.1F}) {
        positions.insert(positions.end(), {x, y, 0.0F});
        joints.insert(joints.end(), {0, 1, 0, 0});
        weights.insert(weights.end(), {1 - share, share, 0.0F, 0.0F});
      }
    }
    for (std::size_t v = 0; v < joints.size() / 4; ++v) {
      if (weights[4 * v + 1] == 0.0F) joints[4 * v + 1] = 0;
    }
    std::vector<std::uint16_t> indices;
    for (std::uint16_t i = 0; i < 4; ++i) {
      const auto v = static_cast<std::uint16_t>(2 * i);
      for (const int k : {0, 1, 2, 2, 1, 3}) indices.push_back(static_cast<std::uint16_t>(v + k));
    }
    const std::size_t position = add(positions, f32, "VEC3", 3);
    json["accessors"][position]["min"] = {positions[0], 0, 0};
    json["accessors"][position]["max"] = {positions[3], 2, 0};
    const std::size_t joint = add(joints, 5121, "VEC4", 4);
    const std::size_t weight = add(weights, f32, "VEC4", 4);
    const std::size_t index = add(indices, 5123, "SCALAR", 1);
    for (const std::size_t a : {position, joint, weight}) json["bufferViews"][a]["target"] = 34962;
    json["bufferViews"][index]["target"] = 34963;
    Json primitive{{"attributes", {{"POSITION", position}, {"JOINTS_0", joint}, {"WEIGHTS_0", weight}}},
                   {"indices", index}};
    json["meshes"].push_back({{"name", "strip"}, {"primitives", Json::array({primitive})}});
    const std::vector<float> bind{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,  //
                                  1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
    const std::size_t inverse_bind = add(bind, f32, "MAT4", 16);
    json["skins"].push_back({{"inverseBindMatrices", inverse_bind}, {"joints", {0, 1}}});
  }

  void add_animation(std::size_t frames) {
    std::vector<float> seconds, root_turn, tip_turn, root_move;
    for (std::size_t i = 0; i < frames; ++i) {
      const double t = static_cast<double>(i) / 30;
      const double phase = 2 * std::numbers::pi * t;
      const double a = 0.4 * std::sin(phase);
      const double b = 0.6 * std::sin(2 * phase + 0.5);
      seconds.push_back(static_cast<float>(t));
      for (const double v : {0.0, 0.0, std::sin(a / 2), std::cos(a / 2)}) root_turn.push_back(static_cast<float>(v));
      for (const double v : {std::sin(b / 2), 0.0, 0.0, std::cos(b / 2)}) tip_turn.push_back(static_cast<float>(v));
      for (const double v : {0.3 * std::sin(phase / 2), 0.05 * std::cos(phase), 0.1 * t})
        root_move.push_back(static_cast<float>(v));
    }
    times = add(seconds, f32, "SCALAR", 1);
    json["accessors"][times]["min"] = {seconds.front()};
    json["accessors"][times]["max"] = {seconds.back()};
    root_rotation = add(root_turn, f32, "VEC4", 4);
    const std::size_t tip_rotation = add(tip_turn, f32, "VEC4", 4);
    const std::size_t root_translation = add(root_move, f32, "VEC3", 3);
    Json animation{{"name", "wave"}, {"channels", Json::array()}, {"samplers", Json::array()}};
    const auto channel = [&](int node, const char* path, std::size_t output) {
      animation["channels"].push_back(
          {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
      animation["samplers"].push_back({{"input", times}, {"interpolation", "LINEAR"}, {"output", output}});
    };
    channel(0, "rotation", root_rotation);
    channel(1, "rotation", tip_rotation);
    channel(0, "translation", root_translation);
    json["animations"].push_back(std::move(animation));
  }
};

}  // namespace nmc::test
