// The humanoid's skeleton and skin.
#include "samples/humanoid.h"

#include <cmath>

#include "samples/sculptor.h"

namespace nmc::samples {
namespace {

using glm::dvec3;

constexpr double diagonal = 0.70710678118654752;
const dvec3 arm_direction(diagonal, -diagonal, 0.0);  // of the left arm at rest
const dvec3 palm_normal(-diagonal, -diagonal, 0.0);   // out of the left palm at rest

/// Left and right: the mirror image has negative x.
dvec3 on_side(const dvec3& left_point, bool left) { return left ? left_point : mirrored(left_point); }

struct FingerPlan {
  const char* name;
  dvec3 base;       // from the wrist, in hand axes: along the arm, out of the palm, to the front
  dvec3 direction;  // in the same axes
  std::array<double, 3> lengths;
};

const std::array<FingerPlan, 5> finger_plans = {{
    {"thumb", {0.025, 0.012, 0.024}, {0.68, 0.32, 0.66}, {0.040, 0.032, 0.026}},
    {"index", {0.088, 0.0, 0.029}, {1.0, 0.0, 0.08}, {0.042, 0.026, 0.022}},
    {"middle", {0.092, 0.0, 0.008}, {1.0, 0.0, 0.01}, {0.046, 0.030, 0.023}},
    {"ring", {0.088, 0.0, -0.012}, {1.0, 0.0, -0.05}, {0.042, 0.028, 0.023}},
    {"little", {0.080, 0.0, -0.031}, {1.0, 0.0, -0.12}, {0.034, 0.021, 0.019}},
}};

std::string finger_bone(const FingerPlan& finger, std::size_t bone, const std::string& side) {
  std::string name = finger.name;
  name += '_';
  name += std::to_string(bone);
  return name += side;
}

dvec3 from_hand_axes(const dvec3& v) { return v.x * arm_direction + v.y * palm_normal + v.z * dvec3(0, 0, 1); }

void add_hand(Rig& rig, const std::string& side, bool left, const dvec3& wrist) {
  const dvec3 knuckles = wrist + 0.09 * arm_direction;
  rig.add("hand" + side, "forearm" + side, on_side(wrist, left), on_side(knuckles, left));
  for (const FingerPlan& finger : finger_plans) {
    dvec3 at = wrist + from_hand_axes(finger.base);
    const dvec3 direction = glm::normalize(from_hand_axes(finger.direction));
    std::string parent = "hand" + side;
    for (std::size_t bone = 0; bone < 3; ++bone) {
      const std::string name = finger_bone(finger, bone + 1, side);
      const dvec3 next = at + finger.lengths[bone] * direction;
      rig.add(name, parent, on_side(at, left), on_side(next, left));
      parent = name;
      at = next;
    }
  }
}

void add_arm(Rig& rig, const std::string& side, bool left) {
  const dvec3 collar(0.025, 1.415, -0.005), shoulder(0.165, 1.405, -0.03);
  const dvec3 elbow = shoulder + 0.285 * arm_direction + dvec3(0, 0, -0.008);
  const dvec3 wrist = elbow + 0.25 * arm_direction + dvec3(0, 0, 0.012);
  rig.add("clavicle" + side, "chest", on_side(collar, left), on_side(shoulder, left));
  rig.add("upper_arm" + side, "clavicle" + side, on_side(shoulder, left), on_side(elbow, left));
  rig.add("forearm" + side, "upper_arm" + side, on_side(elbow, left), on_side(wrist, left));
  add_hand(rig, side, left, wrist);
}

void add_leg(Rig& rig, const std::string& side, bool left) {
  const dvec3 hip(0.09, 0.92, 0.0), knee(0.094, 0.50, 0.012), ankle(0.098, 0.085, -0.03), ball(0.105, 0.02, 0.095);
  rig.add("thigh" + side, "hips", on_side(hip, left), on_side(knee, left));
  rig.add("shin" + side, "thigh" + side, on_side(knee, left), on_side(ankle, left));
  rig.add("foot" + side, "shin" + side, on_side(ankle, left), on_side(ball, left));
  rig.add("toes" + side, "foot" + side, on_side(ball, left), on_side(ball + dvec3(0.003, 0, 0.075), left));
}

constexpr dvec3 skin_colour(0.66, 0.38, 0.26), hair_colour(0.06, 0.03, 0.02), shirt_colour(0.05, 0.22, 0.42),
    trousers_colour(0.06, 0.07, 0.10), shoe_colour(0.35, 0.12, 0.05), eye_colour(0.9, 0.9, 0.88),
    iris_colour(0.03, 0.02, 0.02);

Part make_shirt(const Rig& rig) {
  Sculptor s(rig, {"shirt", shirt_colour, 0.024, 0.06, {}});
  s.blob("hips", {-0.055, 0.95, 0.0}, {0.055, 0.95, 0.0}, 0.118, 0.118, 0.86);
  s.blob("spine", {-0.045, 1.05, 0.0}, {0.045, 1.05, 0.0}, 0.108, 0.108, 0.88);
  s.blob("spine_mid", {-0.055, 1.17, -0.005}, {0.055, 1.17, -0.005}, 0.115, 0.115, 0.86);
  s.blob("chest", {-0.075, 1.29, -0.012}, {0.075, 1.29, -0.012}, 0.118, 0.118, 0.88);
  s.blob("chest", {-0.06, 1.385, -0.025}, {0.06, 1.385, -0.025}, 0.075, 0.075);
  s.blob("neck", {0, 1.43, -0.03}, {0, 1.475, -0.025}, 0.066, 0.062);
  s.pair("clavicle", {0.05, 1.415, -0.026}, {0.145, 1.402, -0.03}, 0.060, 0.052);
  s.bone_pair("upper_arm", 0.058, 0.047).smoothness(0.012).bone_pair("forearm", 0.048, 0.036);
  return s.part();
}

Part make_trousers(const Rig& rig) {
  Sculptor s(rig, {"trousers", trousers_colour, 0.024, 0.035, {}});
  s.blob("hips", {-0.055, 0.965, 0.0}, {0.055, 0.965, 0.0}, 0.112, 0.112, 0.86);
  s.blob("hips", {-0.06, 0.90, -0.012}, {0.06, 0.90, -0.012}, 0.105, 0.105, 0.95);
  s.pair("thigh", {0.092, 0.87, -0.002}, {0.094, 0.50, 0.010}, 0.084, 0.058);
  s.smoothness(0.012);
  s.pair("shin", {0.094, 0.50, 0.010}, {0.097, 0.34, -0.028}, 0.057, 0.059);
  s.pair("shin", {0.097, 0.34, -0.028}, {0.098, 0.10, -0.034}, 0.059, 0.046);
  return s.part();
}

Part make_head(const Rig& rig) {
  Sculptor s(rig, {"head", skin_colour, 0.0115, 0.018, {}});
  s.blob("neck", {0, 1.42, -0.03}, {0, 1.53, -0.018}, 0.056, 0.054);
  s.blob("head", {0, 1.655, -0.018}, {0, 1.645, -0.002}, 0.088, 0.084, 0.92, {1, 0, 0});
  s.blob("head", {0, 1.60, 0.015}, {0, 1.568, 0.036}, 0.064, 0.038, 1.15, {1, 0, 0});
  s.blob("head", {0, 1.637, 0.079}, {0, 1.610, 0.089}, 0.009, 0.013);
  s.blob("head", {-0.013, 1.583, 0.066}, {0.013, 1.583, 0.066}, 0.013, 0.013, 0.8, {0, 1, 0});
  s.blob("head", {-0.03, 1.667, 0.066}, {0.03, 1.667, 0.066}, 0.014, 0.014, 0.7, {0, 1, 0});
  for (const double x : {-1.0, 1.0}) {
    s.blob("head", {x * 0.083, 1.655, -0.012}, {x * 0.080, 1.622, -0.008}, 0.021, 0.014, 0.45, {1, 0, 0});
    s.carve("head", {x * 0.033, 1.645, 0.093}, 0.016);
  }
  return s.part();
}

Part make_hair(const Rig& rig) {
  Sculptor s(rig, {"hair", hair_colour, 0.017, 0.02, {}});
  s.blob("head", {0, 1.675, -0.026}, {0, 1.668, -0.012}, 0.093, 0.088, 0.93, {1, 0, 0});
  s.blob("head", {0, 1.62, -0.055}, {0, 1.57, -0.055}, 0.068, 0.05);
  s.carve("head", {0, 1.60, 0.105}, 0.105);
  return s.part();
}

Part make_eyes(const Rig& rig, const std::string& name, const dvec3& colour, double forward, double radius) {
  Sculptor s(rig, {name, colour, radius / 1.7, 0.001, {}});
  for (const double x : {-0.033, 0.033})
    s.blob("head", {x, 1.645, 0.069 + forward}, {x, 1.645, 0.069 + forward}, radius, radius);
  return s.part();
}

Part make_hand(const Rig& rig, const std::string& side) {
  const bool left = side == "_l";
  Sculptor s(rig, {"hand" + side, skin_colour, 0.0082, 0.012, {}});
  const dvec3 wrist = s.head_of("hand" + side);
  const dvec3 flat = on_side(palm_normal, left);
  const auto in_hand = [&](double along, double out, double front) {
    return wrist + on_side(from_hand_axes({along, out, front}), left);
  };
  s.blob("forearm" + side, in_hand(-0.035, 0, 0), in_hand(0.0, 0, 0), 0.029, 0.026, 0.9, flat);
  s.blob("hand" + side, in_hand(0.0, 0, 0), in_hand(0.03, 0, 0), 0.026, 0.030, 0.75, flat);
  s.blob("hand" + side, in_hand(0.03, 0, 0.012), in_hand(0.08, 0, 0.022), 0.025, 0.018, 0.75, flat);
  s.blob("hand" + side, in_hand(0.03, 0, -0.012), in_hand(0.072, 0, -0.024), 0.025, 0.018, 0.75, flat);
  s.blob("hand" + side, in_hand(0.02, 0.006, 0.014), in_hand(0.04, 0.01, 0.026), 0.020, 0.016);
  for (const FingerPlan& finger : finger_plans) {
    const double thick = finger.name == std::string("little")  ? 0.0085
                         : finger.name == std::string("thumb") ? 0.0115
                                                               : 0.0098;
    for (std::size_t bone = 1; bone <= 3; ++bone) {
      const double shrink = 1.0 - 0.06 * static_cast<double>(bone);
      s.bone(finger_bone(finger, bone, side), thick * (shrink + 0.06), thick * shrink);
    }
  }
  Part part = s.part();
  part.smoothness = 0.006;
  return part;
}

Part make_shoe(const Rig& rig, const std::string& side) {
  const bool left = side == "_l";
  Sculptor s(rig, {"shoe" + side, shoe_colour, 0.0155, 0.03, {}});
  const auto at = [&](double x, double y, double z) { return on_side({x, y, z}, left); };
  s.blob("foot" + side, at(0.098, 0.105, -0.032), at(0.098, 0.07, -0.03), 0.043, 0.045);
  s.blob("foot" + side, at(0.098, 0.036, -0.055), at(0.103, 0.036, 0.04), 0.037, 0.036);
  s.blob("foot" + side, at(0.099, 0.065, -0.01), at(0.105, 0.034, 0.085), 0.038, 0.034);
  s.blob("toes" + side, at(0.107, 0.026, 0.10), at(0.106, 0.025, 0.15), 0.042, 0.034, 0.62, {0, 1, 0});
  return s.part();
}

}  // namespace

Rig humanoid_rig(RestStyle style) {
  Rig rig;
  rig.add("hips", "", {0, 0.94, 0}, {0, 1.03, 0});
  rig.add("spine", "hips", {0, 1.03, 0}, {0, 1.14, -0.006});
  rig.add("spine_mid", "spine", {0, 1.14, -0.006}, {0, 1.26, -0.018});
  rig.add("chest", "spine_mid", {0, 1.26, -0.018}, {0, 1.46, -0.03});
  rig.add("neck", "chest", {0, 1.46, -0.03}, {0, 1.555, -0.016});
  rig.add("head", "neck", {0, 1.555, -0.016}, {0, 1.75, -0.01});
  for (const bool left : {true, false}) add_arm(rig, left ? "_l" : "_r", left);
  for (const bool left : {true, false}) add_leg(rig, left ? "_l" : "_r", left);
  set_rest_rotations(rig, style);
  return rig;
}

SkinMesh humanoid_mesh(const Rig& rig) {
  return polygonise({make_shirt(rig), make_trousers(rig), make_head(rig), make_hair(rig),
                     make_eyes(rig, "eyes", eye_colour, 0.0, 0.0135),
                     make_eyes(rig, "irises", iris_colour, 0.0095, 0.006), make_hand(rig, "_l"), make_hand(rig, "_r"),
                     make_shoe(rig, "_l"), make_shoe(rig, "_r")});
}

}  // namespace nmc::samples
