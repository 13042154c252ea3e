#include "corpus/features.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using Row = std::vector<float>;
using Function = std::function<Row(double)>;

constexpr int float32 = 5126;
constexpr double pi = std::numbers::pi;

std::vector<float> frames(std::size_t count, double start = 0, double rate = 30) {
  std::vector<float> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(static_cast<float>(start + static_cast<double>(i) / rate));
  return times;
}

Row turn_x(double angle) {
  return {static_cast<float>(std::sin(angle / 2)), 0, 0, static_cast<float>(std::cos(angle / 2))};
}

Row turn_z(double angle) {
  return {0, 0, static_cast<float>(std::sin(angle / 2)), static_cast<float>(std::cos(angle / 2))};
}

Row place(double x, double y, double z) {
  return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
}

std::vector<float> rows_of(const std::vector<float>& times, const Function& value) {
  std::vector<float> rows;
  for (const float t : times) {
    const Row row = value(static_cast<double>(t));
    rows.insert(rows.end(), row.begin(), row.end());
  }
  return rows;
}

/// The tiny character of two joints and a skinned strip, with animations of the test's own.
class Maker : public TinyGlb {
 public:
  Maker() {
    json["animations"].clear();
    animation("clip");
  }

  /// Channels that follow belong to a new animation.
  Maker& animation(const std::string& name) {
    Json animation{{"channels", Json::array()}, {"samplers", Json::array()}};
    if (!name.empty()) animation["name"] = name;
    json["animations"].push_back(animation);
    return *this;
  }

  Maker& drop_animations() {
    json.erase("animations");
    return *this;
  }

  Json& last_animation() { return json["animations"].back(); }

  std::size_t add_times(const std::vector<float>& seconds) {
    const std::size_t index = add(seconds, float32, "SCALAR", 1);
    json["accessors"][index]["min"] = {seconds.front()};
    json["accessors"][index]["max"] = {seconds.back()};
    return index;
  }

  std::size_t add_sampler(std::size_t input, std::size_t output, const char* interpolation = "LINEAR") {
    last_animation()["samplers"].push_back({{"input", input}, {"interpolation", interpolation}, {"output", output}});
    return last_animation()["samplers"].size() - 1;
  }

  void add_channel(std::size_t sampler, std::size_t node, const char* path) {
    last_animation()["channels"].push_back({{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
  }

  std::size_t add_values(const char* path, const std::vector<float>& values) {
    const bool rotation = std::string(path) == "rotation";
    if (std::string(path) == "weights") return add(values, float32, "SCALAR", 1);
    return add(values, float32, rotation ? "VEC4" : "VEC3", rotation ? 4 : 3);
  }

  Maker& move(std::size_t node, const char* path, const std::vector<float>& seconds, const Function& value,
              const char* interpolation = "LINEAR") {
    const std::size_t input = add_times(seconds);
    add_channel(add_sampler(input, add_values(path, rows_of(seconds, value)), interpolation), node, path);
    return *this;
  }

  /// A second of dense motion, so that there is something to compress whatever else the file holds.
  Maker& wave(std::size_t node = 1, std::size_t count = 61, double start = 0) {
    return move(node, "rotation", frames(count, start),
                [start](double t) { return turn_x(0.6 * std::sin(2 * pi * (t - start))); });
  }

  /// A node without skin: a small triangle as mesh.
  std::size_t prop(const Json& properties = Json::object()) {
    const std::vector<float> corners{0, 0, 0, 0.2F, 0, 0, 0, 0.2F, 0};
    const std::size_t position = add(corners, float32, "VEC3", 3);
    json["accessors"][position]["min"] = {0, 0, 0};
    json["accessors"][position]["max"] = {0.2F, 0.2F, 0};
    json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", position}}}}}}});
    Json node{{"name", "prop"}, {"mesh", json["meshes"].size() - 1}};
    node.update(properties);
    json["nodes"].push_back(node);
    const std::size_t index = json["nodes"].size() - 1;
    json["scenes"][0]["nodes"].push_back(index);
    return index;
  }

  /// Two morph targets for the strip.
  void add_morph_targets() {
    for (const float side : {0.3F, -0.2F}) {
      std::vector<float> deltas;
      for (int i = 0; i < 10; ++i) deltas.insert(deltas.end(), {side, 0, 0.5F * side});
      const std::size_t delta = add(deltas, float32, "VEC3", 3);
      json["accessors"][delta]["min"] = {side, 0, 0.5F * side};
      json["accessors"][delta]["max"] = {side, 0, 0.5F * side};
      json["meshes"][0]["primitives"][0]["targets"].push_back({{"POSITION", delta}});
    }
  }

  void use(const char* extension, bool required = false) {
    json["extensionsUsed"].push_back(extension);
    if (required) json["extensionsRequired"].push_back(extension);
  }

  /// Packs the accessor's view as EXT_meshopt_compression says, without filters.
  void pack_with_meshopt(std::size_t accessor, std::size_t stride) {
    Json& view = json["bufferViews"][json["accessors"][accessor]["bufferView"].get<std::size_t>()];
    const std::size_t offset = view["byteOffset"], bytes = view["byteLength"], count = bytes / stride;
    Bytes packed(meshopt_encodeVertexBufferBound(count, stride));
    packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), bin.data() + offset, count, stride));
    bin.resize((bin.size() + 3) / 4 * 4);
    view["buffer"] = 1;
    view["extensions"]["EXT_meshopt_compression"] = {
        {"buffer", 0},          {"byteOffset", bin.size()}, {"byteLength", packed.size()},
        {"byteStride", stride}, {"mode", "ATTRIBUTES"},     {"count", count}};
    view["byteOffset"] = fallback_bytes_;
    fallback_bytes_ += (bytes + 3) / 4 * 4;
    bin.insert(bin.end(), packed.begin(), packed.end());
  }

  Bytes glb() const {
    Json whole = json;
    whole["buffers"] = Json::array({{{"byteLength", (bin.size() + 3) / 4 * 4}}});
    if (fallback_bytes_ > 0) {
      whole["buffers"].push_back(
          {{"byteLength", fallback_bytes_}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
    }
    return make_glb(whole, bin);
  }

 private:
  std::size_t fallback_bytes_ = 0;
};

Row sway(double t) { return place(0.3 * std::sin(2 * pi * t), 1, 0.2 * std::cos(2 * pi * t)); }

Bytes joints() { return Maker().wave(0).wave(1).move(0, "translation", frames(61), sway).glb(); }

Bytes scales() {
  return Maker()
      .wave()
      .move(1, "scale", frames(61), [](double t) { return place(1 + 0.5 * std::sin(6 * t), 1, 1); })
      .glb();
}

Bytes morph_weights() {
  Maker maker;
  maker.add_morph_targets();
  maker.move(2, "weights", frames(61), [](double t) {
    return Row{static_cast<float>(0.5 + 0.5 * std::sin(5 * t)), static_cast<float>(0.5 + 0.4 * std::cos(3 * t))};
  });
  return maker.glb();
}

Bytes plain_nodes() {
  Maker maker;
  const std::size_t prop = maker.prop();
  return maker.move(prop, "translation", frames(61), sway)
      .move(prop, "rotation", frames(61), [](double t) { return turn_z(t); })
      .glb();
}

Bytes many_skins() {
  Maker maker;
  maker.json["nodes"].push_back({{"name", "root2"}, {"children", {4}}, {"translation", {3, 0, 0}}});
  maker.json["nodes"].push_back({{"name", "tip2"}, {"translation", {0, 1, 0}}});
  maker.json["nodes"].push_back({{"name", "body2"}, {"mesh", 0}, {"skin", 1}});
  for (const int root : {3, 5}) maker.json["scenes"][0]["nodes"].push_back(root);
  maker.json["skins"].push_back(maker.json["skins"][0]);
  maker.json["skins"][1]["joints"] = {3, 4};
  maker.wave(1).animation("second").wave(4).animation("both").wave(0).wave(3);
  return maker.glb();
}

Bytes subsets() {
  Maker maker;
  maker.wave(0).animation("tip alone").wave(1).animation("place alone").move(0, "translation", frames(61), sway);
  return maker.glb();
}

Bytes late_start() { return Maker().wave(1, 61, 5).wave(0, 61, 5).glb(); }

Bytes uneven() {
  std::vector<float> times;
  for (int i = 0; i < 40; ++i) times.push_back(static_cast<float>(0.04 * i + 0.015 * std::sin(1.7 * i)));
  return Maker().move(1, "rotation", times, [](double t) { return turn_x(std::sin(4 * t)); }).glb();
}

Bytes few_keys() {
  return Maker()
      .move(1, "rotation", {0, 4, 20, 60}, [](double t) { return turn_x(0.02 * t); })
      .move(0, "translation", {0, 30, 60}, sway)
      .glb();
}

Bytes few_keys_beside_many() {
  return Maker().wave(1, 301).move(0, "translation", {0, 3, 10}, [](double t) { return place(0.2 * t, 0, 0); }).glb();
}

Bytes constants() {
  return Maker()
      .wave()
      .move(0, "rotation", {0, 2}, [](double) { return turn_z(0.3); })
      .move(0, "translation", {0, 2}, [](double) { return place(1, 2, 3); })
      .glb();
}

Bytes single_keys() {
  return Maker()
      .move(0, "rotation", {0}, [](double) { return turn_z(0.3); })
      .move(1, "rotation", {0}, [](double) { return turn_x(0.3); })
      .move(0, "translation", {0}, [](double) { return place(1, 2, 3); })
      .glb();
}

Bytes spins() {
  return Maker().move(0, "rotation", frames(121), [](double t) { return turn_z(pi * t); }).glb();
}

Bytes fast_spins() {
  return Maker().move(0, "rotation", frames(61, 0, 8), [](double t) { return turn_z(7 * pi * t); }).glb();
}

Bytes teleport() {
  return Maker()
      .wave(1, 121)
      .move(0, "translation", frames(121),
            [](double t) { return place(0.1 * std::sin(3 * t) + (t > 2 ? 5 : 0), 0, 0); })
      .glb();
}

Bytes glitch() {
  return Maker()
      .wave(1, 121)
      .move(0, "translation", frames(121),
            [](double t) { return place(0.1 * std::sin(3 * t), std::abs(t - 2) < 0.01 ? 1 : 0, 0); })
      .glb();
}

Bytes near_half_turns() {
  Maker maker;
  maker.json["nodes"][1]["rotation"] = {1, 0, 0, 0};
  return maker.move(1, "rotation", frames(61), [](double t) { return turn_x(pi + 0.4 * std::sin(5 * t)); }).glb();
}

Bytes not_unit() {
  return Maker()
      .move(1, "rotation", frames(61),
            [](double t) {
              Row row = turn_x(0.6 * std::sin(5 * t));
              for (float& x : row) x *= static_cast<float>(1 + 0.01 * std::sin(9 * t));
              return row;
            })
      .glb();
}

Bytes mirrored() {
  return Maker().wave().move(1, "scale", frames(61), [](double t) { return place(std::cos(3 * t), -1, 1); }).glb();
}

Bytes vanishing() {
  return Maker()
      .wave()
      .move(1, "scale", frames(61),
            [](double t) {
              const double s = std::max(0.0, 1 - t);
              return place(s, s, s);
            })
      .glb();
}

Bytes shared_outputs() {
  Maker maker;
  const std::vector<float> times = frames(61);
  const std::size_t input = maker.add_times(times);
  const std::size_t output =
      maker.add_values("rotation", rows_of(times, [](double t) { return turn_x(std::sin(5 * t)); }));
  const std::size_t sampler = maker.add_sampler(input, output);
  maker.add_channel(sampler, 0, "rotation");
  maker.add_channel(sampler, 1, "rotation");
  maker.animation("again");
  maker.add_channel(maker.add_sampler(input, output), 1, "rotation");
  return maker.glb();
}

Bytes interleaved() {
  Maker maker;
  const std::vector<float> times = frames(61);
  std::vector<float> block;
  for (const float t : times) {
    for (const Row& row : {turn_x(std::sin(5.0 * t)), sway(t)}) block.insert(block.end(), row.begin(), row.end());
  }
  const std::size_t rotations = maker.add(block, float32, "VEC4", 4);
  Json& rotation = maker.json["accessors"][rotations];
  maker.json["bufferViews"][rotation["bufferView"].get<std::size_t>()]["byteStride"] = 28;
  rotation["count"] = times.size();
  Json translation = rotation;
  translation["type"] = "VEC3";
  translation["byteOffset"] = 16;
  maker.json["accessors"].push_back(translation);
  const std::size_t input = maker.add_times(times);
  maker.add_channel(maker.add_sampler(input, rotations), 1, "rotation");
  maker.add_channel(maker.add_sampler(input, maker.json["accessors"].size() - 2), 0, "translation");
  return maker.glb();
}

Bytes sparse() {
  Maker maker;
  const std::vector<float> times = frames(61);
  const std::size_t output =
      maker.add_values("translation", rows_of(times, [](double t) { return place(0.2 * t, 0, 0); }));
  const std::size_t indices = maker.add(std::vector<std::uint16_t>{10, 11, 12}, 5123, "SCALAR", 1);
  const std::size_t values = maker.add(std::vector<float>{0, 1, 0, 0, 1, 0, 0, 1, 0}, float32, "VEC3", 3);
  maker.json["accessors"][output]["sparse"] = {
      {"count", 3},
      {"indices", {{"bufferView", maker.json["accessors"][indices]["bufferView"]}, {"componentType", 5123}}},
      {"values", {{"bufferView", maker.json["accessors"][values]["bufferView"]}}}};
  maker.json["accessors"].erase(std::max(indices, values));
  maker.json["accessors"].erase(std::min(indices, values));
  maker.add_channel(maker.add_sampler(maker.add_times(times), output), 0, "translation");
  maker.wave();
  return maker.glb();
}

Bytes normalized() {
  Maker maker;
  maker.add_morph_targets();
  const std::vector<float> times = frames(61);
  std::vector<std::int16_t> rotations;
  std::vector<std::uint8_t> weights;
  for (const float t : times) {
    for (const float x : turn_x(std::sin(5.0 * t)))
      rotations.push_back(static_cast<std::int16_t>(std::lround(32767 * x)));
    for (const double w : {0.5 + 0.5 * std::sin(4.0 * t), 0.5 + 0.5 * std::cos(3.0 * t)})
      weights.push_back(static_cast<std::uint8_t>(std::lround(255 * w)));
  }
  const std::size_t input = maker.add_times(times);
  const std::size_t rotation = maker.add(rotations, 5122, "VEC4", 4), weight = maker.add(weights, 5121, "SCALAR", 1);
  for (const std::size_t output : {rotation, weight}) maker.json["accessors"][output]["normalized"] = true;
  maker.add_channel(maker.add_sampler(input, rotation), 1, "rotation");
  maker.add_channel(maker.add_sampler(input, weight), 2, "weights");
  return maker.glb();
}

/// Keys with the tangents of `value`, by central differences.
std::vector<float> spline_rows(const std::vector<float>& times, const Function& value) {
  constexpr double h = 1e-3;
  std::vector<float> rows;
  for (const float t : times) {
    const Row before = value(t - h), now = value(t), after = value(t + h);
    Row tangent;
    for (std::size_t a = 0; a < now.size(); ++a) tangent.push_back((after[a] - before[a]) / static_cast<float>(2 * h));
    for (const Row& row : {tangent, now, tangent}) rows.insert(rows.end(), row.begin(), row.end());
  }
  return rows;
}

Bytes splines() {
  Maker maker;
  const std::vector<float> times = frames(17, 0, 8);
  const std::size_t input = maker.add_times(times);
  const auto spline = [&](std::size_t node, const char* path, const Function& value) {
    maker.add_channel(maker.add_sampler(input, maker.add_values(path, spline_rows(times, value)), "CUBICSPLINE"), node,
                      path);
  };
  spline(1, "rotation", [](double t) { return turn_x(0.6 * std::sin(5 * t)); });
  spline(0, "translation", sway);
  return maker.glb();
}

Row blink(double t) { return place(std::fmod(t, 0.5) < 0.25 ? 0 : 1, 0, 0); }

Bytes steps() { return Maker().move(0, "translation", frames(61), blink, "STEP").glb(); }

Bytes steps_beside() { return Maker().wave().move(0, "translation", frames(61), blink, "STEP").glb(); }

Bytes still_steps() {
  return Maker()
      .wave()
      .move(
          0, "translation", frames(61), [](double) { return place(1, 2, 3); }, "STEP")
      .glb();
}

Bytes pointers() {
  Maker maker;
  maker.use("KHR_animation_pointer");
  maker.json["materials"] = Json::array({{{"name", "skin"}}});
  maker.wave();
  const std::vector<float> times = frames(61);
  std::vector<float> colours;
  for (const float t : times) colours.insert(colours.end(), {t / 2, 0, 0, 1});
  const std::size_t sampler = maker.add_sampler(maker.add_times(times), maker.add(colours, float32, "VEC4", 4));
  maker.last_animation()["channels"].push_back(
      {{"sampler", sampler},
       {"target",
        {{"path", "pointer"},
         {"extensions",
          {{"KHR_animation_pointer", {{"pointer", "/materials/0/pbrMetallicRoughness/baseColorFactor"}}}}}}}});
  return maker.glb();
}

Bytes interactivity() {
  Maker maker;
  maker.use("KHR_interactivity");
  maker.json["extensions"]["KHR_interactivity"] = {
      {"graphs", {{{"types", Json::array()}, {"values", {{{"type", 0}, {"value", {"/animations/1"}}}}}}}},
      {"graph", 0}};
  return maker.wave().animation("second").wave(0).glb();
}

Bytes unknown_extension() {
  Maker maker;
  maker.use("ACME_secret_links");
  maker.json["extensions"]["ACME_secret_links"] = {{"accessor", 3}};
  return maker.wave().glb();
}

Bytes with_meshopt() {
  Maker maker;
  maker.use("EXT_meshopt_compression", true);
  maker.wave();
  maker.pack_with_meshopt(maker.last_animation()["samplers"][0]["output"], 16);
  maker.pack_with_meshopt(maker.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"], 12);
  return maker.glb();
}

Bytes quantised_mesh() {
  Maker maker;
  maker.use("KHR_mesh_quantization", true);
  std::vector<std::int16_t> positions;
  for (int i = 0; i <= 4; ++i) {
    for (const int x : {-100, 100}) {
      for (const int v : {x, 500 * i, 0, 0}) positions.push_back(static_cast<std::int16_t>(v));
    }
  }
  const std::size_t position = maker.add(positions, 5122, "VEC3", 4);
  maker.json["accessors"][position]["min"] = {-100, 0, 0};
  maker.json["accessors"][position]["max"] = {100, 2000, 0};
  Json& view = maker.json["bufferViews"][maker.json["accessors"][position]["bufferView"].get<std::size_t>()];
  view["byteStride"] = 8;
  view["target"] = 34962;
  maker.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = position;
  const std::vector<float> bind{1e-3F, 0, 0, 0, 0, 1e-3F, 0, 0, 0, 0, 1e-3F, 0, 0, 0,  0, 1,  //
                                1e-3F, 0, 0, 0, 0, 1e-3F, 0, 0, 0, 0, 1e-3F, 0, 0, -1, 0, 1};
  maker.json["skins"][0]["inverseBindMatrices"] = maker.add(bind, float32, "MAT4", 16);
  return maker.wave().glb();
}

Bytes names() {
  Maker maker;
  maker.wave().animation("clip").wave(0).animation("").wave(0);
  return maker.glb();
}

Bytes targets_without_node() {
  Maker maker;
  maker.wave();
  const std::vector<float> times = frames(3);
  const std::size_t sampler =
      maker.add_sampler(maker.add_times(times), maker.add_values("translation", rows_of(times, sway)));
  maker.last_animation()["channels"].push_back({{"sampler", sampler}, {"target", {{"path", "translation"}}}});
  return maker.glb();
}

Bytes jump_of_one_bit() {
  const float t = 1.0F;
  std::vector<float> times = frames(61);
  times.insert(times.begin() + 31, std::nextafter(t, 2.0F));
  times[30] = t;
  return Maker()
      .move(0, "translation", times, [](double at) { return place(at > 1 ? 2 : 0, 0.2 * std::sin(4 * at), 0); })
      .glb();
}

Bytes moved_matrix() {
  Maker maker;
  maker.json["nodes"][1].erase("translation");
  maker.json["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1};
  return maker.wave().glb();
}

Bytes still_matrix() {
  Maker maker;
  maker.json["nodes"][1].erase("translation");
  maker.json["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1};
  return maker.wave(0).glb();
}

Bytes tiny_clip() {
  return Maker().move(1, "rotation", {0, 0.1F}, [](double t) { return turn_x(t); }).glb();
}

Bytes no_animation() { return Maker().drop_animations().glb(); }

}  // namespace

const std::vector<Feature>& features() {
  static const std::vector<Feature> all{
      {"rotations and translations of joints", "three curves at 30 Hz", joints},
      {"scale of joints", "a pulsing joint", scales},
      {"morph weights", "two targets of a skinned mesh", morph_weights},
      {"plain nodes, no skin", "a turning prop", plain_nodes},
      {"several skins, skeletons and roots", "two characters, three clips", many_skins},
      {"clips of different parts of one skeleton", "three clips", subsets},
      {"a clip that starts late", "keys from 5 s on", late_start},
      {"uneven key times", "40 keys with jitter", uneven},
      {"few keys in a long clip", "4 and 3 keys in a minute", few_keys},
      {"few keys beside many", "3 keys beside 301", few_keys_beside_many},
      {"constants of two keys", "two curves that stand still", constants},
      {"single keys", "three curves of one key each", single_keys},
      {"a clip of two keys", "a tenth of a second", tiny_clip},
      {"spins", "two whole turns", spins},
      {"fast spins", "nearly half a turn from key to key", fast_spins},
      {"a teleport", "5 m from one frame to the next", teleport},
      {"a jump of one frame", "one key 1 m off", glitch},
      {"a jump between equal times", "two keys one bit apart", jump_of_one_bit},
      {"rest rotations near half a turn", "a joint at rest at 180 degrees", near_half_turns},
      {"quaternions that are not of unit length", "lengths within 1%", not_unit},
      {"negative scale, and through zero", "a mirrored joint", mirrored},
      {"scale to nothing", "a joint that vanishes", vanishing},
      {"shared samplers, inputs and outputs", "three channels, one accessor", shared_outputs},
      {"interleaved accessors", "byteStride 28", interleaved},
      {"sparse accessors", "three keys replaced", sparse},
      {"normalized integers", "16-bit rotations, 8-bit weights", normalized},
      {"CUBICSPLINE", "two curves of 17 keys", splines},
      {"STEP that jumps", "one curve", steps},
      {"STEP beside LINEAR", "one curve of each", steps_beside},
      {"STEP that never changes", "one curve beside a LINEAR one", still_steps},
      {"KHR\\_animation\\_pointer", "a colour beside a joint", pointers},
      {"KHR\\_interactivity", "a graph that names an animation", interactivity},
      {"an extension that gltf-nmc does not know", "it could refer to anything", unknown_extension},
      {"meshopt-compressed input", "keys and positions", with_meshopt},
      {"quantised meshes", "16-bit positions", quantised_mesh},
      {"animations of one name, or none", "three clips", names},
      {"a channel without a node", "beside one with a node", targets_without_node},
      {"a node with a matrix above what moves", "its child moves", still_matrix},
      {"a node with a matrix that moves", "glTF forbids it", moved_matrix},
      {"no animations", "a still character", no_animation},
  };
  return all;
}

}  // namespace nmc::test
