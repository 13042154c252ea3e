// Small files with the less usual things that glTF animations may hold, for tests.
#include "samples/props.h"

#include <array>
#include <cmath>
#include <numbers>

#include "samples/glb.h"

namespace nmc::samples {
namespace {

using Floats = std::vector<float>;

constexpr double pi = std::numbers::pi;

// A PNG of 2 x 2 pixels: red, green / blue, white.
constexpr std::array<std::uint8_t, 75> tiny_png = {
    0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00,
    0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xfd, 0xd4, 0x9a, 0x73, 0x00, 0x00, 0x00, 0x12, 0x49,
    0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8, 0xcf, 0xc0, 0xc0, 0x00, 0xc2, 0x0c, 0xff, 0x81, 0x00, 0x00, 0x1f, 0xee,
    0x05, 0xfb, 0xf1, 0xab, 0xba, 0x77, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};

std::size_t add_floats(GlbBuilder& glb, const Floats& values, const char* type, std::size_t width,
                       ViewTarget target = ViewTarget::none, const Floats& min = {}, const Floats& max = {}) {
  AccessorInfo info{ComponentType::f32,      type, values.size() / width, false, {min.begin(), min.end()},
                    {max.begin(), max.end()}};
  return glb.add_accessor(glb.add_view(to_bytes(values), target), 0, info);
}

std::size_t add_indices(GlbBuilder& glb, const std::vector<std::uint16_t>& indices) {
  const std::size_t view = glb.add_view(to_bytes(indices), ViewTarget::indices);
  return glb.add_accessor(view, 0, {ComponentType::u16, "SCALAR", indices.size(), false, {}, {}});
}

std::size_t add_times(GlbBuilder& glb, const Floats& times) {
  return add_floats(glb, times, "SCALAR", 1, ViewTarget::none, {times.front()}, {times.back()});
}

Floats uniform_times(int first_frame, int count, double frames_per_second) {
  Floats times;
  for (int i = 0; i < count; ++i) times.push_back(static_cast<float>((first_frame + i) / frames_per_second));
  return times;
}

void add_channel(Json& animation, std::size_t node, const char* path, std::size_t input, std::size_t output,
                 const char* interpolation) {
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  animation["samplers"].push_back({{"input", input}, {"interpolation", interpolation}, {"output", output}});
}

Json new_animation(const char* name) {
  return {{"name", name}, {"channels", Json::array()}, {"samplers", Json::array()}};
}

/// A flat blade in the plane z = 0, both sides visible.
Json make_blade(GlbBuilder& glb) {
  const Floats positions = {-0.05f, 0, 0, 0.05f, 0, 0, 0.12f, 0.6f, 0, -0.12f, 0.6f, 0};
  const Floats texture = {0, 1, 1, 1, 1, 0, 0, 0};
  Json attributes = {
      {"POSITION", add_floats(glb, positions, "VEC3", 3, ViewTarget::vertices, {-0.12f, 0, 0}, {0.12f, 0.6f, 0})}};
  attributes["TEXCOORD_0"] = add_floats(glb, texture, "VEC2", 2, ViewTarget::vertices);
  const Json primitive = {
      {"attributes", attributes}, {"indices", add_indices(glb, {0, 1, 2, 0, 2, 3})}, {"material", 0}};
  return {{"name", "blade"}, {"primitives", Json::array({primitive})}};
}

const Floats octahedron = {0.3f, 0, 0, -0.3f, 0, 0, 0, 0.3f, 0, 0, -0.3f, 0, 0, 0, 0.3f, 0, 0, -0.3f};
const std::vector<std::uint16_t> octahedron_faces = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                                     2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};

Json make_ball(GlbBuilder& glb, const char* name) {
  Json attributes = {{"POSITION", add_floats(glb, octahedron, "VEC3", 3, ViewTarget::vertices, {-0.3f, -0.3f, -0.3f},
                                             {0.3f, 0.3f, 0.3f})}};
  const Json primitive = {{"attributes", attributes}, {"indices", add_indices(glb, octahedron_faces)}};
  return {{"name", name}, {"primitives", Json::array({primitive})}};
}

/// The ball with two targets: one draws its top up, the other its side out.
Json make_morphing_ball(GlbBuilder& glb) {
  Json mesh = make_ball(glb, "gesicht_\u00e4\u00f6\u00fc");
  Floats up(18, 0.0f), out(18, 0.0f);
  up[7] = 0.4f;
  out[0] = 0.5f;
  Json targets = Json::array();
  targets.push_back({{"POSITION", add_floats(glb, up, "VEC3", 3, ViewTarget::vertices, {0, 0, 0}, {0, 0.4f, 0})}});
  targets.push_back({{"POSITION", add_floats(glb, out, "VEC3", 3, ViewTarget::vertices, {0, 0, 0}, {0.5f, 0, 0})}});
  mesh["primitives"][0]["targets"] = targets;
  mesh["weights"] = {0.0, 0.25};
  mesh["extras"] = {{"targetNames", {"up", "out"}}};
  return mesh;
}

/// Three full turns about Z, ten keys a turn.
void add_fan(GlbBuilder& glb, Json& animation, std::size_t node) {
  const Floats times = uniform_times(0, 31, 15.0);
  Floats rotations;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double half = pi * static_cast<double>(i) / 10.0;
    rotations.insert(rotations.end(),
                     {0.0f, 0.0f, static_cast<float>(std::sin(half)), static_cast<float>(std::cos(half))});
  }
  add_channel(animation, node, "rotation", add_times(glb, times), add_floats(glb, rotations, "VEC4", 4), "LINEAR");
}

/// Four bounces; the ball widens as it flattens on the ground.
void add_bounce(GlbBuilder& glb, Json& animation, std::size_t node) {
  const Floats times = uniform_times(0, 61, 30.0);
  Floats translations, scales;
  for (const float time : times) {
    const double phase = 2.0 * time - std::floor(2.0 * time);
    const double height = 4.0 * phase * (1.0 - phase);
    const double squash = 0.4 * std::pow(1.0 - height, 6);
    const auto wide = static_cast<float>(1.0 / std::sqrt(1.0 - squash));
    translations.insert(translations.end(), {1.5f, static_cast<float>(0.3 * (1.0 - squash) + 1.2 * height), 0.0f});
    scales.insert(scales.end(), {wide, static_cast<float>(1.0 - squash), wide});
  }
  const std::size_t input = add_times(glb, times);
  add_channel(animation, node, "translation", input, add_floats(glb, translations, "VEC3", 3), "LINEAR");
  add_channel(animation, node, "scale", input, add_floats(glb, scales, "VEC3", 3), "LINEAR");
}

Json make_morph_animation(GlbBuilder& glb, std::size_t node) {
  Json animation = new_animation("morph");
  const Floats times = uniform_times(0, 31, 30.0);
  Floats weights;
  for (const float time : times) {
    weights.push_back(static_cast<float>(0.5 - 0.5 * std::cos(2.0 * pi * time)));
    weights.push_back(static_cast<float>(0.25 + 0.25 * std::sin(4.0 * pi * time)));
  }
  add_channel(animation, node, "weights", add_times(glb, times), add_floats(glb, weights, "SCALAR", 1), "LINEAR");
  return animation;
}

/// CUBICSPLINE (in-tangent, value, out-tangent for each key), STEP, and a constant of two keys.
Json make_interpolation_animation(GlbBuilder& glb, std::size_t moving, std::size_t stepping) {
  Json animation = new_animation("spline, step & constant");
  const std::size_t input = add_times(glb, {0.0f, 0.4f, 1.0f, 1.6f});
  const Floats spline = {0, 0, 0, 1.5f, 0.3f, 0,    1, 2, 0,  1,  1, 0, 1.8f, 1.1f, 0.2f, 1, 0, 0,
                         0, 0, 1, 1.9f, 0.6f, 0.5f, 0, 0, -1, -1, 0, 0, 1.5f, 0.3f, 0,    0, 0, 0};
  add_channel(animation, moving, "translation", input, add_floats(glb, spline, "VEC3", 3), "CUBICSPLINE");
  const auto half = static_cast<float>(std::sqrt(0.5));
  const Floats steps = {0, 0, 0, 1, half, 0, 0, half, 0, half, 0, half, 0, 0, 0, 1};
  add_channel(animation, stepping, "rotation", input, add_floats(glb, steps, "VEC4", 4), "STEP");
  const std::size_t ends = add_times(glb, {0.0f, 1.6f});
  add_channel(animation, stepping, "scale", ends, add_floats(glb, {1, 1, 1, 1, 1, 1}, "VEC3", 3), "LINEAR");
  return animation;
}

/// Keys from frame 15 to 40 at 24 Hz: does not start at 0 and does not end where it began.
Json make_late_animation(GlbBuilder& glb, std::size_t node) {
  Json animation = new_animation("\u9045\u308c\u3066 late");
  const Floats times = uniform_times(15, 26, 24.0);
  Floats translations;
  for (const float time : times)
    translations.insert(translations.end(), {-1.5f, static_cast<float>(0.5 * std::sqrt(time)), 0.2f * time});
  add_channel(animation, node, "translation", add_times(glb, times), add_floats(glb, translations, "VEC3", 3),
              "LINEAR");
  animation["extras"] = {{"loop", false}, {"events", Json::array({{{"name", "footstep"}, {"time", 0.75}}})}};
  return animation;
}

void add_image_and_material(GlbBuilder& glb) {
  const std::size_t view = glb.add_view(tiny_png);
  glb.json["images"] = Json::array({{{"name", "tiny"}, {"mimeType", "image/png"}, {"bufferView", view}}});
  glb.json["samplers"] = Json::array({{{"magFilter", 9728}, {"minFilter", 9728}}});
  glb.json["textures"] = Json::array({{{"sampler", 0}, {"source", 0}}});
  glb.json["materials"] =
      Json::array({{{"name", "painted"},
                    {"doubleSided", true},
                    {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0.0}}}}});
}

}  // namespace

std::vector<std::uint8_t> make_props() {
  GlbBuilder glb;
  glb.json["asset"]["extras"] = {{"purpose", "tests"}, {"numbers", {1, 2.5, -3e-7, 9007199254740991}}};
  enum Node : std::size_t { stand, fan, ball, face };
  glb.json["scene"] = 0;
  glb.json["scenes"] = Json::array({{{"nodes", {stand, ball, face}}, {"extras", {{"mood", "\u2600"}}}}});
  glb.json["nodes"] =
      Json::array({{{"name", "stand"}, {"translation", {0, 1, 0}}, {"children", {fan}}},
                   {{"name", "ventilateur_\u00e9t\u00e9"}, {"mesh", 0}, {"extras", {{"blades", 1}, {"note", nullptr}}}},
                   {{"name", "\u30dc\u30fc\u30eb"}, {"mesh", 1}, {"translation", {1.5, 0.3, 0}}},
                   {{"name", "face \U0001F600"}, {"mesh", 2}, {"translation", {-1.5, 0.5, 0}}}});
  add_image_and_material(glb);
  glb.json["meshes"] = Json::array({make_blade(glb), make_ball(glb, "ball"), make_morphing_ball(glb)});
  Json turning = new_animation("spin and bounce");
  add_fan(glb, turning, fan);
  add_bounce(glb, turning, ball);
  glb.json["animations"] = Json::array({turning, make_morph_animation(glb, face),
                                        make_interpolation_animation(glb, ball, fan), make_late_animation(glb, face)});
  return glb.finish();
}

std::vector<std::uint8_t> make_unknown_extension() {
  GlbBuilder glb;
  const Json unknown = {{"EXAMPLE_unknown", {{"accessor", 0}, {"bufferView", 1}, {"values", {1, 2, 3}}}}};
  glb.json["extensionsUsed"] = {"EXAMPLE_unknown"};
  glb.json["extensions"] = unknown;
  glb.json["scene"] = 0;
  glb.json["scenes"] = Json::array({{{"nodes", {0}}}});
  glb.json["nodes"] = Json::array({{{"name", "fan"}, {"mesh", 0}, {"extensions", unknown}}});
  add_image_and_material(glb);
  glb.json["meshes"] = Json::array({make_blade(glb)});
  Json animation = new_animation("spin");
  add_fan(glb, animation, 0);
  animation["extensions"] = unknown;
  glb.json["animations"] = Json::array({animation});
  return glb.finish();
}

}  // namespace nmc::samples
