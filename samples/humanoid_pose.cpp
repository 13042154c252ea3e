// From the handful of numbers that say a humanoid's pose to the turns of its joints.
#include <algorithm>
#include <cmath>

#include "samples/curve.h"
#include "samples/humanoid.h"

namespace nmc::samples {
namespace {

using glm::dquat;
using glm::dvec3;

const std::array<const char*, 2> sides = {"_l", "_r"};

dquat turn_of(const Bend& bend, double share = 1.0) {
  return about_y(share * bend.yaw) * about_x(share * bend.pitch) * about_z(share * bend.roll);
}

/// What is known of a joint while a pose is built from the root down.
class PoseBuilder {
 public:
  explicit PoseBuilder(const Rig& rig) : rig_(rig), pose_(rest_pose(rig)) {}

  const Joint& joint(const std::string& name) const { return rig_.joints[index(name)]; }
  void set_root_position(const dvec3& position) { pose_.root_position = position; }
  void set_turn(const std::string& name, const dquat& turn) { pose_.turns[index(name)] = turn; }

  /// Sets a joint's turn in model space; everything above it must be set.
  void set_model_turn(const std::string& name, const dquat& turn) {
    pose_.turns[index(name)] = glm::conjugate(model_turn(joint(name).parent)) * turn;
  }
  dvec3 position(const std::string& name) const { return place(rig_, pose_).positions[index(name)]; }
  dquat model_turn(int joint) const {
    dquat turn(1, 0, 0, 0);
    for (int j = joint; j >= 0; j = rig_.joints[static_cast<std::size_t>(j)].parent)
      turn = pose_.turns[static_cast<std::size_t>(j)] * turn;
    return turn;
  }
  Pose pose() const { return pose_; }

 private:
  std::size_t index(const std::string& name) const { return static_cast<std::size_t>(rig_.find(name)); }
  const Rig& rig_;
  Pose pose_;
};

/// The ankle's position in model space. The foot rolls over the ball's joint or over the heel's edge.
dvec3 ankle_position(const Rig& rig, const FootState& foot, std::size_t side) {
  const dvec3 ankle = rig.joints[static_cast<std::size_t>(rig.find(std::string("foot") + sides[side]))].head;
  const dvec3 ball = rig.joints[static_cast<std::size_t>(rig.find(std::string("toes") + sides[side]))].head;
  const dvec3 to_ball = ball - ankle, to_heel(0.0, -ankle.y, -0.055);
  const dvec3 pivot = glm::mix(to_heel, to_ball, smooth_step(-0.03, 0.03, foot.pitch));
  const dvec3 ankle_from_pivot = about_y(foot.yaw) * (about_x(foot.pitch) * -pivot);
  return dvec3(foot.x, ankle.y + foot.lift, foot.z) + about_y(foot.yaw) * pivot + ankle_from_pivot;
}

void set_torso(PoseBuilder& builder, const BodyState& state) {
  builder.set_root_position({state.pelvis_x, state.pelvis_height, state.pelvis_z});
  builder.set_turn("hips", turn_of(state.pelvis));
  builder.set_turn("spine", turn_of(state.spine, 0.3));
  builder.set_turn("spine_mid", turn_of(state.spine, 0.35));
  builder.set_turn("chest", turn_of(state.spine, 0.35));
  builder.set_turn("neck", turn_of(state.head, 0.4));
  builder.set_turn("head", turn_of(state.head, 0.6));
}

void set_leg(PoseBuilder& builder, const Rig& rig, const BodyState& state, std::size_t side) {
  const std::string s = sides[side];
  const FootState& foot = state.feet[side];
  const Joint &thigh = builder.joint("thigh" + s), &shin = builder.joint("shin" + s),
              &ankle = builder.joint("foot" + s);
  const dvec3 hip = builder.position("thigh" + s), end = ankle_position(rig, foot, side);
  const dvec3 front = about_y(0.5 * (foot.yaw + state.pelvis.yaw)) * dvec3(0, 0, 1);
  const dvec3 rest_side(1, 0, 0), upper = shin.head - thigh.head, lower = ankle.head - shin.head;
  const TwoBoneBend bend = bend_two_bones(hip, end, glm::length(upper), glm::length(lower), front);
  builder.set_model_turn("thigh" + s, aim(upper, rest_side, bend.middle - hip, bend.side));
  builder.set_model_turn("shin" + s, aim(lower, rest_side, end - bend.middle, bend.side));
  builder.set_model_turn("foot" + s, about_y(foot.yaw) * about_x(foot.pitch));
  builder.set_turn("toes" + s, about_x(-foot.toe_bend));
}

void set_fingers(PoseBuilder& builder, const std::string& s, double curl) {
  const auto to_side = [&](const dquat& turn) { return s == "_l" ? turn : mirrored(turn); };
  int finger = 0;
  for (const char* name : {"index", "middle", "ring", "little"}) {
    const double amount = curl * (0.85 + 0.1 * finger++);
    builder.set_turn(name + ("_1" + s), to_side(about_z(-1.45 * amount)));
    builder.set_turn(name + ("_2" + s), to_side(about_z(-1.65 * amount)));
    builder.set_turn(name + ("_3" + s), to_side(about_z(-1.05 * amount)));
  }
  const dvec3 thumb_axis = glm::normalize(dvec3(0.35, -0.35, -1.0) + dvec3(0.6, 0.6, 0.0));
  for (const char* bone : {"_1", "_2", "_3"}) {
    builder.set_turn("thumb" + (bone + s), to_side(glm::angleAxis(0.55 * curl, thumb_axis)));
  }
}

void set_arm(PoseBuilder& builder, const ArmState& arm, std::size_t side) {
  const std::string s = sides[side];
  const auto to_side = [&](const dquat& turn) { return side == 0 ? turn : mirrored(turn); };
  const Joint &upper = builder.joint("upper_arm_l"), &lower = builder.joint("forearm_l");
  const dvec3 upper_direction = glm::normalize(lower.head - upper.head),
              lower_direction = glm::normalize(lower.tail - lower.head);
  const dquat hang = about_z(-std::acos(-upper_direction.y));
  const dvec3 hinge = glm::normalize(glm::cross(lower_direction, dvec3(0, 0, 1)));
  builder.set_turn("clavicle" + s, to_side(about_z(arm.shrug)));
  builder.set_turn("upper_arm" + s, to_side(about_x(-arm.raise_front) * about_z(arm.raise_side) * hang *
                                            glm::angleAxis(arm.twist, upper_direction)));
  builder.set_turn("forearm" + s,
                   to_side(glm::angleAxis(arm.elbow, hinge) * glm::angleAxis(arm.forearm_twist, lower_direction)));
  builder.set_turn("hand" + s, to_side(about_z(-arm.wrist)));
  set_fingers(builder, s, arm.curl);
}

double mix(double a, double b, double amount) { return a + amount * (b - a); }

Bend mix(const Bend& a, const Bend& b, double t) {
  return {mix(a.yaw, b.yaw, t), mix(a.pitch, b.pitch, t), mix(a.roll, b.roll, t)};
}

FootState mix(const FootState& a, const FootState& b, double t) {
  return {mix(a.x, b.x, t),         mix(a.z, b.z, t),       mix(a.yaw, b.yaw, t),
          mix(a.pitch, b.pitch, t), mix(a.lift, b.lift, t), mix(a.toe_bend, b.toe_bend, t)};
}

ArmState mix(const ArmState& a, const ArmState& b, double t) {
  return {mix(a.raise_side, b.raise_side, t),
          mix(a.raise_front, b.raise_front, t),
          mix(a.twist, b.twist, t),
          mix(a.elbow, b.elbow, t),
          mix(a.forearm_twist, b.forearm_twist, t),
          mix(a.wrist, b.wrist, t),
          mix(a.curl, b.curl, t),
          mix(a.shrug, b.shrug, t)};
}

}  // namespace

BodyState blend(const BodyState& a, const BodyState& b, double amount) {
  BodyState result;
  result.pelvis_x = mix(a.pelvis_x, b.pelvis_x, amount);
  result.pelvis_height = mix(a.pelvis_height, b.pelvis_height, amount);
  result.pelvis_z = mix(a.pelvis_z, b.pelvis_z, amount);
  result.pelvis = mix(a.pelvis, b.pelvis, amount);
  result.spine = mix(a.spine, b.spine, amount);
  result.head = mix(a.head, b.head, amount);
  for (std::size_t side = 0; side < 2; ++side) {
    result.feet[side] = mix(a.feet[side], b.feet[side], amount);
    result.arms[side] = mix(a.arms[side], b.arms[side], amount);
  }
  return result;
}

BodyState standing() {
  BodyState state;
  state.pelvis_height = 0.928;
  state.spine.pitch = 0.02;
  for (std::size_t side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1.0 : -1.0;
    state.feet[side] = {sign * 0.11, 0.0, sign * 0.12, 0.0, 0.0, 0.0};
    state.arms[side] = {0.14, 0.02, 0.0, 0.22, 0.15, 0.05, 0.22, 0.0};
  }
  return state;
}

Pose solve(const Rig& rig, const BodyState& state) {
  PoseBuilder builder(rig);
  set_torso(builder, state);
  for (std::size_t side = 0; side < 2; ++side) {
    set_leg(builder, rig, state, side);
    set_arm(builder, state.arms[side], side);
  }
  return builder.pose();
}

double highest_pelvis(const Rig& rig, const BodyState& state, double slack) {
  PoseBuilder builder(rig);
  set_torso(builder, state);
  double highest = 1e3;
  for (std::size_t side = 0; side < 2; ++side) {
    const std::string s = sides[side];
    const double leg = glm::length(builder.joint("shin" + s).head - builder.joint("thigh" + s).head) +
                       glm::length(builder.joint("foot" + s).head - builder.joint("shin" + s).head);
    const dvec3 hip = builder.position("thigh" + s), ankle = ankle_position(rig, state.feet[side], side);
    const double across = std::hypot(hip.x - ankle.x, hip.z - ankle.z);
    const double down = std::sqrt(std::max(std::pow(leg * (1.0 - slack), 2) - across * across, 0.0));
    highest = std::min(highest, state.pelvis_height + ankle.y + down - hip.y);
  }
  return highest;
}

}  // namespace nmc::samples
