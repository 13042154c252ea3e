// The humanoid's clips: their motions by name, and sampling.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "samples/curve.h"
#include "samples/humanoid_motion.h"

namespace nmc::samples {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int root_motion_cycles = 3;

double hump(double from, double to, double at) {
  const double u = std::clamp((at - from) / (to - from), 0.0, 1.0);
  return std::pow(std::sin(pi * u), 2);
}

/// Standing, breathing, shifting weight. Repeats after `period` seconds.
BodyState idle_state(double t, double period) {
  const auto slow = [&](std::uint32_t seed) { return fidget(t, period, 1, 4, seed); };
  const auto lively = [&](std::uint32_t seed) { return fidget(t, period, 2, 12, seed); };
  const double breath = std::sin(2.0 * pi * 3.0 * t / period);
  BodyState state = standing();
  const double shift = slow(1);
  state.pelvis_x = 0.022 * shift + 0.002 * lively(2);
  state.pelvis_z = 0.007 * slow(3) + 0.001 * lively(4);
  state.pelvis_height += 0.0015 * breath - 0.006 * shift * shift;
  state.pelvis = {0.03 * slow(5), 0.01 * lively(6), 0.035 * shift};
  state.spine = {0.03 * slow(7), 0.025 + 0.018 * breath + 0.01 * lively(8), -0.045 * shift};
  state.head = {0.16 * slow(9) + 0.03 * lively(10), -0.01 - 0.012 * breath + 0.04 * slow(11), 0.02 * lively(12)};
  for (std::uint32_t side = 0; side < 2; ++side) {
    ArmState& arm = state.arms[side];
    const std::uint32_t seed = 20 + 10 * side;
    arm.raise_side += 0.012 * breath + 0.015 * lively(seed);
    arm.raise_front += 0.04 * slow(seed + 1) + 0.01 * lively(seed + 2);
    arm.elbow += 0.05 * slow(seed + 3) + 0.01 * breath;
    arm.forearm_twist += 0.08 * slow(seed + 4);
    arm.wrist += 0.03 * lively(seed + 5);
    arm.curl += 0.06 * lively(seed + 6);
    arm.shrug = 0.02 * breath;
  }
  return state;
}

/// The position of a body thrown up, against where it is thrown from.
struct Flight {
  double start, height;
  double speed() const { return std::sqrt(2.0 * 9.81 * height); }
  double end() const { return start + 2.0 * speed() / 9.81; }
  double rise(double t) const {
    if (t <= start || t >= end()) return 0.0;
    return speed() * (t - start) - 0.5 * 9.81 * (t - start) * (t - start);
  }
};

/// A cubic with given values and slopes at both ends.
double hermite(double t0, double y0, double slope0, double t1, double y1, double slope1, double t) {
  const double width = t1 - t0, u = (t - t0) / width, v = 1.0 - u;
  return v * v * ((1.0 + 2.0 * u) * y0 + u * width * slope0) + u * u * ((3.0 - 2.0 * u) * y1 - v * width * slope1);
}

double jump_height(const Flight& flight, double t) {
  constexpr double crouch_at = 0.50, crouch = -0.27, off = 0.07, dip = -0.20, dip_after = 0.22;
  const double landing = flight.end();
  if (t < crouch_at) return crouch * smooth_step(0.0, crouch_at, t);
  if (t < flight.start) return hermite(crouch_at, crouch, 0.0, flight.start, off, flight.speed(), t);
  if (t < landing) return off + flight.rise(t);
  if (t < landing + dip_after) return hermite(landing, off, -flight.speed(), landing + dip_after, dip, 0.0, t);
  return dip * (1.0 - smooth_step(landing + dip_after, landing + 0.95, t));
}

BodyState jump_state(double t) {
  static const Flight flight = {0.72, 0.36};
  const double landing = flight.end();
  static const Curve bow({{0.0, 0.0}, {0.5, 1.0}, {0.72, -0.05}, {0.9, -0.05}, {1.25, 0.25}, {1.48, 0.8}, {2.25, 0.0}});
  static const Curve arms({{0.0, 0.0}, {0.46, -0.85}, {0.74, 2.3}, {0.95, 2.5}, {1.30, 0.9}, {1.5, 0.25}, {2.3, 0.0}});
  static const Curve heel({{0.0, 0.0}, {0.56, 0.0}, {0.72, 0.95}, {0.85, 0.9}, {1.24, 0.35}, {1.33, 0.0}, {2.3, 0.0}});
  BodyState state = standing();
  state.pelvis_height += jump_height(flight, t);
  state.pelvis_z = -0.07 * bow(t) + 0.02 * hump(0.55, 1.3, t);
  state.pelvis.pitch = 0.42 * bow(t);
  state.spine.pitch += 0.45 * bow(t);
  state.head.pitch = -0.45 * bow(t) - 0.08 * hump(0.6, 1.1, t);
  for (std::size_t side = 0; side < 2; ++side) {
    const double late = side == 0 ? 0.0 : 0.012;
    FootState& foot = state.feet[side];
    foot.pitch = heel(t);
    foot.lift = flight.rise(t) + 0.10 * hump(flight.start, landing, t);
    foot.toe_bend = heel(t) * (1.0 - hump(flight.start - 0.02, landing + 0.02, t));
    ArmState& arm = state.arms[side];
    arm.raise_front += arms(t - late);
    arm.raise_side += 0.12 * hump(0.3, 2.0, t);
    arm.elbow += 0.55 * hump(0.1, 1.9, t - late);
    arm.curl += 0.25 * hump(0.2, 2.1, t);
  }
  return state;
}

/// One step of a turn on the spot: a foot goes to its place beside a body that faces `yaw`.
struct TurnStep {
  std::size_t foot;
  double lift, land, yaw;
};

FootState foot_beside(std::size_t foot, double yaw) {
  const FootState rest = standing().feet[foot];
  FootState result = rest;
  result.x = rest.x * std::cos(yaw) + rest.z * std::sin(yaw);
  result.z = -rest.x * std::sin(yaw) + rest.z * std::cos(yaw);
  result.yaw = rest.yaw + yaw;
  return result;
}

BodyState turn_state(double t) {
  static const std::array<TurnStep, 4> steps = {
      {{0, 0.22, 0.72, 1.25}, {1, 0.74, 1.24, 2.05}, {0, 1.26, 1.76, pi}, {1, 1.78, 2.24, pi}}};
  BodyState state = standing();
  const double yaw = pi * smooth_step(0.1, 2.3, t);
  state.pelvis.yaw = yaw;
  state.spine.yaw = 0.22 * hump(0.0, 1.9, t);
  state.head.yaw = 0.45 * hump(-0.1, 1.7, t);
  double yaw_of[2] = {0.0, 0.0};
  for (const TurnStep& step : steps) {
    const double from = yaw_of[step.foot], u = smooth_step(step.lift, step.land, t), up = hump(step.lift, step.land, t);
    if (t < step.lift) continue;
    const double now = from + u * (step.yaw - from);
    state.feet[step.foot] = foot_beside(step.foot, now);
    state.feet[step.foot].lift = 0.06 * up;
    state.feet[step.foot].pitch = 0.30 * hump(step.lift, step.lift + 0.8 * (step.land - step.lift), t);
    yaw_of[step.foot] = step.yaw;
    const double away = 0.035 * hump(step.lift - 0.12, step.land + 0.12, t) * (step.foot == 0 ? -1.0 : 1.0);
    state.pelvis_x += away * std::cos(yaw);
    state.pelvis_z -= away * std::sin(yaw);
    state.pelvis_height -= 0.012 * up;
  }
  for (std::size_t side = 0; side < 2; ++side) {
    const double sign = side == 0 ? 1.0 : -1.0;
    state.arms[side].raise_front += -sign * 0.22 * hump(0.1, 1.6, t) + sign * 0.1 * hump(1.4, 2.5, t);
    state.arms[side].raise_side += 0.10 * hump(0.1, 2.4, t);
    state.arms[side].elbow += 0.15 * hump(0.2, 2.4, t);
  }
  return state;
}

/// Two full turns on the ball of the left foot.
BodyState spin_state(double t) {
  const double yaw = 4.0 * pi * smooth_step(0.5, 2.5, t);
  const double gathered = smooth_step(0.3, 0.75, t) * (1.0 - smooth_step(2.25, 2.7, t));
  const double over_foot = smooth_step(0.1, 0.5, t) * (1.0 - smooth_step(2.5, 2.95, t));
  constexpr double to_ball_x = 0.007, to_ball_z = 0.125;  // from the left ankle, foot straight ahead
  BodyState state = standing();
  const FootState planted = state.feet[0];
  const auto turned = [](double x, double z, double angle) {
    return std::array<double, 2>{x * std::cos(angle) + z * std::sin(angle), -x * std::sin(angle) + z * std::cos(angle)};
  };
  const auto offset = turned(to_ball_x, to_ball_z, planted.yaw);
  const double ball_x = planted.x + offset[0], ball_z = planted.z + offset[1];
  const auto back = turned(to_ball_x, to_ball_z, planted.yaw + yaw);
  state.feet[0] = {ball_x - back[0], ball_z - back[1], planted.yaw + yaw, 0.35 * gathered, 0.0, 0.35 * gathered};

  const auto heel = turned(-0.02, -0.075, yaw);
  state.pelvis_x = over_foot * (ball_x + heel[0]);
  state.pelvis_z = over_foot * (ball_z + heel[1]);
  state.pelvis_height += 0.025 * gathered - 0.05 * hump(0.0, 0.6, t) - 0.04 * hump(2.4, 3.2, t);
  state.pelvis.yaw = yaw;
  state.spine.yaw = -0.25 * hump(0.0, 0.7, t) + 0.15 * hump(0.6, 2.0, t);
  state.head.yaw = 0.5 * std::sin(2.0 * yaw) * gathered;

  const FootState rest = state.feet[1];
  const auto tucked = turned(-0.03, 0.16, yaw), beside = turned(rest.x, rest.z, yaw);
  state.feet[1] = {state.pelvis_x * gathered + gathered * tucked[0] + (1.0 - gathered) * beside[0],
                   state.pelvis_z * gathered + gathered * tucked[1] + (1.0 - gathered) * beside[1],
                   rest.yaw + yaw - 0.3 * gathered,
                   0.9 * gathered,
                   0.34 * gathered,
                   0.0};
  for (ArmState& arm : state.arms) {
    arm.raise_front += 1.05 * gathered;
    arm.raise_side += 0.25 * gathered + 0.9 * hump(0.0, 0.8, t) + 0.9 * hump(2.3, 3.1, t);
    arm.elbow += 1.2 * gathered;
    arm.curl += 0.1 * gathered;
  }
  return state;
}

BodyState wave_state(double t) {
  BodyState state = idle_state(t, 3.0);
  const double up = smooth_step(0.15, 0.8, t) * (1.0 - smooth_step(2.2, 2.85, t));
  const double beat =
      std::sin(2.0 * pi * 2.0 * (t - 0.7)) * smooth_step(0.6, 0.9, t) * (1.0 - smooth_step(2.0, 2.4, t));
  const ArmState raised = {
      1.25 + 0.05 * beat, 0.25, -1.45 + 0.10 * beat, 1.75 + 0.32 * beat, 0.35, -0.10 * beat, 0.08, 0.18};
  BodyState waving = state;
  waving.arms[1] = raised;
  waving.spine.roll -= 0.05;
  waving.head.roll += 0.06;
  waving.head.yaw -= 0.08;
  return blend(state, waving, up);
}

/// Twelve seconds of standing, walking on the spot, standing and waving, blended into each other.
Motion mocap_motion(const Rig& rig) {
  const Motion walk = gait_motion(rig, GaitKind::walk, 1, true);
  return {12.0, false, [walk](double t) {
            const double walking = smooth_step(1.5, 2.4, t) * (1.0 - smooth_step(6.6, 7.6, t));
            BodyState state = blend(idle_state(t, 12.0), walk.state(t), walking);
            const BodyState waving = wave_state(std::clamp(t - 8.2, 0.0, 3.0));
            state.arms[1] = blend(state, waving, smooth_step(8.2, 8.6, t) * (1.0 - smooth_step(10.9, 11.4, t))).arms[1];
            return state;
          }};
}

/// What a capture adds: every joint trembles by a fraction of a degree, slowly and from frame to frame.
void add_sensor_noise(Pose& pose, double seconds, std::uint32_t frame) {
  constexpr double slow = 0.0025, fast = 0.0004;  // radians
  for (std::uint32_t j = 0; j < pose.turns.size(); ++j) {
    glm::dvec3 tremble(0.0);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t seed = 1000 + 3 * j + axis;
      tremble[static_cast<int>(axis)] =
          slow * fidget(seconds, 12.0, 12, 40, seed) + fast * fidget(frame, 1024.0, 301, 310, seed);
    }
    pose.turns[j] = glm::normalize(pose.turns[j] * glm::dquat(1.0, 0.5 * tremble));
  }
}

Motion make_motion(const Rig& rig, std::string_view name) {
  if (name == "walk") return gait_motion(rig, GaitKind::walk, 1, true);
  if (name == "walk_root_motion") return gait_motion(rig, GaitKind::walk, root_motion_cycles, false);
  if (name == "run") return gait_motion(rig, GaitKind::run, 1, true);
  if (name == "run_root_motion") return gait_motion(rig, GaitKind::run, root_motion_cycles, false);
  if (name == "jump") return {2.3, false, jump_state};
  if (name == "idle") return {10.0, true, [](double t) { return idle_state(t, 10.0); }};
  if (name == "turn") return {2.6, false, turn_state};
  if (name == "wave") return {3.0, false, wave_state};
  if (name == "spin") return {3.2, false, spin_state};
  if (name == "mocap_sequence") return mocap_motion(rig);
  throw std::invalid_argument("the humanoid has no clip named " + std::string(name));
}

}  // namespace

std::vector<std::string> humanoid_clip_names() {
  return {"walk", "walk_root_motion", "run", "run_root_motion", "jump", "idle", "turn", "wave", "spin"};
}

PoseClip humanoid_clip(const Rig& rig, std::string_view name, double frames_per_second) {
  const Motion motion = make_motion(rig, name);
  const auto frames = static_cast<std::uint32_t>(std::lround(motion.seconds * frames_per_second));
  PoseClip clip{std::string(name), frames_per_second, 0, {}};
  for (std::uint32_t i = 0; i <= frames; ++i) {
    const std::uint32_t frame = motion.loops && i == frames ? 0 : i;
    const double seconds = frame / frames_per_second;
    clip.poses.push_back(solve(rig, motion.state(seconds)));
    if (name == "mocap_sequence") add_sensor_noise(clip.poses.back(), seconds, frame);
  }
  return clip;
}

std::vector<Contact> humanoid_contacts(std::string_view clip_name) {
  if (clip_name == "walk_root_motion") return gait_contacts(GaitKind::walk, root_motion_cycles);
  if (clip_name == "run_root_motion") return gait_contacts(GaitKind::run, root_motion_cycles);
  return {};
}

}  // namespace nmc::samples
