// The humanoid's clips.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "samples/curve.h"
#include "samples/humanoid.h"

namespace nmc::samples {
namespace {

constexpr double turn = 2.0 * std::numbers::pi;

double wave(double phase) { return std::sin(turn * phase); }
double cosine(double phase) { return std::cos(turn * phase); }

/// A way of going on two legs: all that walking and running differ in.
struct Gait {
  double period_seconds;  // of a left and a right step
  double metres_per_second;
  double stance;      // part of the period that a foot is on the ground
  double foot_ahead;  // metres that the middle of stance lies in front of the hips
  double half_width;  // metres between ankle and midline
  Curve foot_pitch;   // by phase, 0 is the heel strike
  Curve foot_lift;    // by phase of the swing
};

const Gait& walk_gait() {
  static const Gait gait = {32.0 / 30.0,
                            1.12,
                            0.60,
                            -0.045,
                            0.075,
                            Curve({{0.0, -0.32},
                                   {0.09, 0.0},
                                   {0.32, 0.0},
                                   {0.60, 0.80},
                                   {0.68, 0.92},
                                   {0.86, 0.0},
                                   {0.97, -0.33},
                                   {1.0, -0.32}},
                                  true),
                            Curve({{0.0, 0.0}, {0.35, 0.05}, {0.7, 0.035}, {1.0, 0.0}})};
  return gait;
}

/// The foot of a gait at a time. `offset` is the foot's phase at time 0.
FootState gait_foot(const Gait& gait, double seconds, double offset, double side_sign) {
  const double steps = seconds / gait.period_seconds + offset;
  const double cycle = std::floor(steps), phase = steps - cycle;
  const double stride = gait.metres_per_second * gait.period_seconds;
  const double swing = std::max(phase - gait.stance, 0.0) / (1.0 - gait.stance);
  FootState foot;
  foot.x = side_sign * gait.half_width;
  foot.z = stride * (cycle + smooth_step(0.0, 1.0, swing) + 0.5 * gait.stance - offset) + gait.foot_ahead;
  foot.yaw = side_sign * 0.10;
  foot.pitch = gait.foot_pitch(phase);
  foot.lift = gait.foot_lift(swing);
  foot.toe_bend = std::max(foot.pitch, 0.0) * (1.0 - smooth_step(0.0, 0.5, swing));
  return foot;
}

BodyState walk_state(double seconds) {
  const Gait& gait = walk_gait();
  const double p = seconds / gait.period_seconds;  // left heel strike at 0
  BodyState state;
  state.pelvis_z = gait.metres_per_second * seconds + 0.008 * wave(2.0 * p - 0.1);
  state.pelvis_x = 0.018 * wave(p - 0.03) + 0.002 * wave(3.0 * p);
  state.pelvis_height = -0.017 * cosine(2.0 * (p - 0.045)) + 0.002 * cosine(4.0 * p);
  state.pelvis = {-0.10 * cosine(p), 0.04 + 0.012 * cosine(2.0 * p), 0.045 * wave(p - 0.02)};
  state.spine = {0.19 * cosine(p - 0.02), 0.02 + 0.015 * wave(2.0 * p), -0.06 * wave(p - 0.04)};
  state.head = {-0.085 * cosine(p - 0.03), -0.03 + 0.015 * wave(2.0 * p + 0.1), 0.012 * wave(p)};
  for (std::size_t side = 0; side < 2; ++side) {
    const double offset = side == 0 ? 0.0 : 0.5;
    const double q = p + offset;
    state.feet[side] = gait_foot(gait, seconds, offset, side == 0 ? 1.0 : -1.0);
    const double swing = -cosine(q - 0.03);  // back at the own heel's strike
    state.arms[side] = {0.12 + 0.015 * wave(q),
                        0.02 + 0.36 * swing + 0.02 * cosine(2.0 * q),
                        0.08,
                        0.32 + 0.20 * cosine(q + 0.44) + 0.03 * wave(2.0 * q),
                        0.2,
                        0.05 + 0.06 * cosine(q + 0.36),
                        0.28 + 0.04 * cosine(q + 0.4),
                        0.02 * wave(2.0 * q)};
  }
  return state;
}

void move_back(BodyState& state, double metres) {
  state.pelvis_z -= metres;
  for (FootState& foot : state.feet) foot.z -= metres;
}

/// Shifts the pelvis of a whole clip to the greatest height at which the legs always reach the ground.
double fitting_height(const Rig& rig, const std::function<BodyState(double)>& motion, double seconds, double slack) {
  double shift = 1e3;
  for (int i = 0; i < 240; ++i) {
    const BodyState state = motion(seconds * i / 240.0);
    shift = std::min(shift, highest_pelvis(rig, state, slack) - state.pelvis_height);
  }
  return shift;
}

/// A motion as a function of time.
struct Motion {
  double seconds = 0.0;
  bool loops = false;
  std::function<BodyState(double)> state;
};

Motion gait_motion(const Rig& rig, const Gait& gait, BodyState (*state_at)(double), int cycles, bool in_place) {
  const double shift = fitting_height(rig, state_at, gait.period_seconds, 0.004);
  const double speed = in_place ? gait.metres_per_second : 0.0;
  return {cycles * gait.period_seconds, in_place, [=](double seconds) {
            BodyState state = state_at(seconds);
            state.pelvis_height += shift;
            move_back(state, speed * seconds);
            return state;
          }};
}

Motion make_motion(const Rig& rig, std::string_view name) {
  if (name == "walk") return gait_motion(rig, walk_gait(), walk_state, 1, true);
  if (name == "walk_root_motion") return gait_motion(rig, walk_gait(), walk_state, 3, false);
  throw std::invalid_argument("the humanoid has no clip named " + std::string(name));
}

}  // namespace

std::vector<std::string> humanoid_clip_names() { return {"walk", "walk_root_motion"}; }

PoseClip humanoid_clip(const Rig& rig, std::string_view name, double frames_per_second) {
  const Motion motion = make_motion(rig, name);
  const auto frames = std::lround(motion.seconds * frames_per_second);
  PoseClip clip{std::string(name), frames_per_second, 0, {}};
  for (long i = 0; i <= frames; ++i) {
    const long frame = motion.loops && i == frames ? 0 : i;
    clip.poses.push_back(solve(rig, motion.state(static_cast<double>(frame) / frames_per_second)));
  }
  return clip;
}

std::vector<Contact> humanoid_contacts(std::string_view) { return {}; }

}  // namespace nmc::samples
