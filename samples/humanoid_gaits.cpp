// Walking and running: two sets of numbers for one way of going on two legs.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "samples/curve.h"
#include "samples/humanoid_motion.h"

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
  double flat_from;   // phase from which the ball is on the ground too
  double foot_ahead;  // metres that the middle of stance lies in front of the hips
  double half_width;  // metres between ankle and midline
  Curve foot_pitch;   // by phase, 0 is the heel strike
  Curve foot_lift;    // by phase of the swing
};

const Gait& walk_gait() {
  static const Gait gait = {32.0 / 30.0,
                            1.12,
                            0.60,
                            0.09,
                            -0.065,
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

const Gait& run_gait() {
  static const Gait gait = {21.0 / 30.0,
                            3.1,
                            0.34,
                            0.05,
                            -0.135,
                            0.05,
                            Curve({{0.0, -0.10},
                                   {0.05, 0.0},
                                   {0.14, 0.02},
                                   {0.34, 0.95},
                                   {0.46, 1.65},
                                   {0.62, 1.35},
                                   {0.84, 0.10},
                                   {0.95, -0.14},
                                   {1.0, -0.10}},
                                  true),
                            Curve({{0.0, 0.0}, {0.32, 0.27}, {0.5, 0.27}, {0.78, 0.13}, {1.0, 0.0}})};
  return gait;
}

BodyState walk_state(double seconds) {
  const Gait& gait = walk_gait();
  const double p = seconds / gait.period_seconds;  // left heel strike at 0
  BodyState state;
  state.pelvis_z = gait.metres_per_second * seconds + 0.008 * wave(2.0 * p - 0.1);
  state.pelvis_x = 0.018 * wave(p - 0.03) + 0.002 * wave(3.0 * p);
  state.pelvis_height = -0.021 * cosine(2.0 * (p - 0.045)) + 0.002 * cosine(4.0 * p);
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

BodyState run_state(double seconds) {
  const Gait& gait = run_gait();
  const double p = seconds / gait.period_seconds;  // left foot strikes at 0
  BodyState state;
  state.pelvis_z = gait.metres_per_second * seconds + 0.012 * wave(2.0 * p - 0.1);
  state.pelvis_x = 0.010 * wave(p);
  state.pelvis_height = -0.034 * cosine(2.0 * (p - 0.155)) + 0.004 * cosine(4.0 * p);
  state.pelvis = {-0.16 * cosine(p - 0.02), 0.13 + 0.03 * cosine(2.0 * p - 0.1), 0.05 * wave(p + 0.02)};
  state.spine = {0.34 * cosine(p - 0.03), 0.09 + 0.03 * wave(2.0 * p), -0.06 * wave(p)};
  state.head = {-0.17 * cosine(p - 0.04), -0.13 + 0.02 * wave(2.0 * p + 0.1), 0.01 * wave(p)};
  for (std::size_t side = 0; side < 2; ++side) {
    const double offset = side == 0 ? 0.0 : 0.5;
    const double q = p + offset;
    state.feet[side] = gait_foot(gait, seconds, offset, side == 0 ? 1.0 : -1.0);
    const double swing = -cosine(q - 0.03);
    state.arms[side] = {0.22 + 0.03 * wave(q),
                        -0.12 + 0.62 * swing + 0.04 * cosine(2.0 * q),
                        0.25,
                        1.55 + 0.25 * swing + 0.06 * wave(2.0 * q),
                        0.15,
                        0.08,
                        0.62 + 0.03 * cosine(q),
                        0.03 * wave(2.0 * q)};
  }
  return state;
}

void move_back(BodyState& state, double metres) {
  state.pelvis_z -= metres;
  for (FootState& foot : state.feet) foot.z -= metres;
}

/// Shifts the pelvis of a whole clip to the greatest height at which the legs always reach the ground.
double fitting_height(const Rig& rig, BodyState (*motion)(double), double seconds, double slack) {
  double shift = 1e3;
  for (int i = 0; i < 240; ++i) {
    const BodyState state = motion(seconds * i / 240.0);
    shift = std::min(shift, highest_pelvis(rig, state, slack) - state.pelvis_height);
  }
  return shift;
}

}  // namespace

Motion gait_motion(const Rig& rig, GaitKind kind, int cycles, bool in_place) {
  const Gait& gait = kind == GaitKind::walk ? walk_gait() : run_gait();
  const auto state_at = kind == GaitKind::walk ? walk_state : run_state;
  const double shift = fitting_height(rig, state_at, gait.period_seconds, 0.004);
  const double speed = in_place ? gait.metres_per_second : 0.0;
  return {cycles * gait.period_seconds, in_place, [=](double seconds) {
            BodyState state = state_at(seconds);
            state.pelvis_height += shift;
            move_back(state, speed * seconds);
            return state;
          }};
}

std::vector<Contact> gait_contacts(GaitKind kind, int cycles) {
  const Gait& gait = kind == GaitKind::walk ? walk_gait() : run_gait();
  std::vector<Contact> contacts;
  for (int foot = 0; foot < 2; ++foot) {
    for (int cycle = -1; cycle < cycles; ++cycle) {
      const double strike = (cycle + 0.5 * foot) * gait.period_seconds;
      const double from = std::max(strike + gait.flat_from * gait.period_seconds, 0.0);
      const double to = std::min(strike + gait.stance * gait.period_seconds, cycles * gait.period_seconds);
      if (to > from) contacts.push_back({foot, from, to});
    }
  }
  return contacts;
}

}  // namespace nmc::samples
