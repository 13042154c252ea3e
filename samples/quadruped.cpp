// The quadruped's skeleton and skin.
#include "samples/quadruped.h"

#include <cmath>

#include "samples/sculptor.h"

namespace nmc::samples {
namespace {

using glm::dvec3;

dvec3 on_side(const dvec3& left_point, bool left) { return left ? left_point : mirrored(left_point); }

/// Adds a chain of bones through points; `side` is appended to the names.
void add_chain(Rig& rig, std::string parent, const std::vector<std::string>& names, const std::vector<dvec3>& points,
               const std::string& side) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    rig.add(names[i] + side, parent, on_side(points[i], side != "_r"), on_side(points[i + 1], side != "_r"));
    parent = names[i] + side;
  }
}

constexpr dvec3 coat_colour(0.52, 0.20, 0.045), pale_colour(0.80, 0.68, 0.52), dark_colour(0.03, 0.02, 0.02);

Part make_coat(const Rig& rig) {
  Sculptor s(rig, {"coat", coat_colour, 0.0165, 0.04, {}});
  s.blob("hips", {0, 0.545, -0.33}, {0, 0.55, -0.24}, 0.098, 0.094);
  s.blob("spine_1", {0, 0.55, -0.22}, {0, 0.555, -0.10}, 0.088, 0.088);
  s.blob("spine_2", {0, 0.55, -0.08}, {0, 0.54, 0.05}, 0.094, 0.104);
  s.blob("chest", {0, 0.525, 0.08}, {0, 0.525, 0.20}, 0.118, 0.106);
  s.blob("neck_1", {0, 0.575, 0.24}, {0, 0.66, 0.31}, 0.086, 0.070);
  s.blob("neck_2", {0, 0.66, 0.31}, {0, 0.735, 0.365}, 0.068, 0.062);
  s.pair("thigh", {0.062, 0.52, -0.30}, {0.073, 0.37, -0.235}, 0.082, 0.052);
  s.pair("scapula", {0.058, 0.58, 0.16}, {0.068, 0.47, 0.22}, 0.062, 0.056);
  s.smoothness(0.018);
  s.pair("shin", {0.075, 0.36, -0.225}, {0.078, 0.18, -0.355}, 0.048, 0.025);
  s.pair("upper_arm", {0.07, 0.46, 0.23}, {0.075, 0.33, 0.155}, 0.054, 0.043);
  s.pair("forearm", {0.075, 0.32, 0.15}, {0.077, 0.13, 0.16}, 0.040, 0.026);
  return s.part();
}

Part make_head(const Rig& rig) {
  Sculptor s(rig, {"head", coat_colour, 0.0125, 0.022, {}});
  s.blob("neck_2", {0, 0.69, 0.33}, {0, 0.74, 0.37}, 0.056, 0.056);
  s.blob("head", {0, 0.775, 0.395}, {0, 0.77, 0.44}, 0.068, 0.060);
  s.blob("head", {0, 0.752, 0.46}, {0, 0.728, 0.575}, 0.041, 0.024);
  for (const double x : {-1.0, 1.0}) s.blob("head", {x * 0.03, 0.75, 0.43}, {x * 0.026, 0.735, 0.47}, 0.034, 0.022);
  s.smoothness(0.01);
  s.pair("ear", {0.04, 0.815, 0.375}, {0.058, 0.865, 0.362}, 0.030, 0.022, 0.45);
  s.pair("ear_tip", {0.058, 0.865, 0.362}, {0.070, 0.91, 0.358}, 0.022, 0.008, 0.45);
  return s.part();
}

Part make_jaw(const Rig& rig) {
  Sculptor s(rig, {"jaw", pale_colour, 0.0125, 0.015, {}});
  return s.blob("jaw", {0, 0.722, 0.43}, {0, 0.700, 0.55}, 0.028, 0.016).part();
}

Part make_bib(const Rig& rig) {
  Sculptor s(rig, {"bib", pale_colour, 0.0165, 0.03, {}});
  s.blob("chest", {0, 0.50, 0.235}, {0, 0.55, 0.275}, 0.072, 0.066);
  return s.blob("neck_1", {0, 0.60, 0.305}, {0, 0.66, 0.345}, 0.055, 0.045).part();
}

Part make_tail(const Rig& rig) {
  Sculptor s(rig, {"tail", coat_colour, 0.0165, 0.02, {}});
  const std::array<double, 7> radii = {0.034, 0.036, 0.042, 0.048, 0.048, 0.038, 0.022};
  for (std::size_t i = 0; i + 2 < radii.size(); ++i) s.bone("tail_" + std::to_string(i + 1), radii[i], radii[i + 1]);
  return s.part();
}

Part make_tail_tip(const Rig& rig) {
  Sculptor s(rig, {"tail_tip", pale_colour, 0.0165, 0.02, {}});
  return s.bone("tail_6", 0.045, 0.018).part();
}

Part make_socks(const Rig& rig) {
  Sculptor s(rig, {"socks", dark_colour, 0.0115, 0.016, {}});
  s.pair("shin", {0.077, 0.20, -0.338}, {0.078, 0.18, -0.355}, 0.027, 0.027);
  s.bone_pair("hock", 0.029, 0.024);
  s.pair("forearm", {0.077, 0.17, 0.158}, {0.077, 0.13, 0.16}, 0.030, 0.028);
  s.bone_pair("pastern", 0.028, 0.026);
  for (const char* leg : {"hind_toes", "fore_toes"}) {
    const dvec3 at = s.head_of(std::string(leg) + "_l");
    s.pair(leg, {at.x, 0.028, at.z + 0.005}, {at.x, 0.022, at.z + 0.048}, 0.033, 0.030, 0.7, {0, 1, 0});
  }
  return s.part();
}

Part make_nose_and_eyes(const Rig& rig) {
  Sculptor s(rig, {"nose", dark_colour, 0.0065, 0.002, {}});
  s.blob("head", {0, 0.737, 0.598}, {0, 0.735, 0.602}, 0.013, 0.013);
  s.pair("eye", {0.037, 0.786, 0.478}, {0.037, 0.786, 0.478}, 0.0115, 0.0115);
  return s.part();
}

}  // namespace

Rig quadruped_rig(RestStyle style) {
  Rig rig;
  add_chain(rig, "", {"hips", "spine_1", "spine_2", "chest", "neck_1", "neck_2", "head"},
            {{0, 0.56, -0.30},
             {0, 0.57, -0.20},
             {0, 0.575, -0.06},
             {0, 0.57, 0.08},
             {0, 0.59, 0.24},
             {0, 0.67, 0.31},
             {0, 0.75, 0.37},
             {0, 0.74, 0.60}},
            "");
  add_chain(rig, "head", {"jaw"}, {{0, 0.735, 0.42}, {0, 0.705, 0.56}}, "");
  add_chain(rig, "hips", {"tail_1", "tail_2", "tail_3", "tail_4", "tail_5", "tail_6"},
            {{0, 0.575, -0.40},
             {0, 0.545, -0.465},
             {0, 0.495, -0.52},
             {0, 0.44, -0.565},
             {0, 0.385, -0.605},
             {0, 0.335, -0.65},
             {0, 0.30, -0.715}},
            "");
  for (const char* side : {"_l", "_r"}) {
    add_chain(rig, "head", {"ear", "ear_tip"}, {{0.04, 0.815, 0.375}, {0.058, 0.865, 0.362}, {0.072, 0.92, 0.358}},
              side);
    add_chain(rig, "head", {"eye"}, {{0.037, 0.786, 0.478}, {0.037, 0.786, 0.49}}, side);
    add_chain(rig, "hips", {"thigh", "shin", "hock", "hind_toes"},
              {{0.068, 0.53, -0.30},
               {0.075, 0.36, -0.225},
               {0.078, 0.175, -0.36},
               {0.078, 0.032, -0.325},
               {0.078, 0.022, -0.26}},
              side);
    add_chain(rig, "chest", {"scapula", "upper_arm", "forearm", "pastern", "fore_toes"},
              {{0.052, 0.61, 0.15},
               {0.07, 0.46, 0.235},
               {0.075, 0.32, 0.15},
               {0.077, 0.115, 0.16},
               {0.077, 0.032, 0.185},
               {0.077, 0.022, 0.25}},
              side);
  }
  set_rest_rotations(rig, style);
  return rig;
}

SkinMesh quadruped_mesh(const Rig& rig) {
  return polygonise({make_coat(rig), make_head(rig), make_jaw(rig), make_bib(rig), make_tail(rig), make_tail_tip(rig),
                     make_socks(rig), make_nose_and_eyes(rig)});
}

}  // namespace nmc::samples
