// The quadruped's clips.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "samples/curve.h"
#include "samples/quadruped.h"

namespace nmc::samples {
namespace {

using glm::dvec3;

double wave(double phase) { return std::sin(2.0 * std::numbers::pi * phase); }
double cosine(double phase) { return std::cos(2.0 * std::numbers::pi * phase); }

double hump(double from, double to, double at) {
  const double u = std::clamp((at - from) / (to - from), 0.0, 1.0);
  return std::pow(std::sin(std::numbers::pi * u), 2);
}

/// A paw: metres from where it stands in the rest pose, and radians.
struct Paw {
  double ahead = 0.0, lift = 0.0;
  double pitch = 0.0;     ///< of the bone above the toes, forwards
  double toe_bend = 0.0;  ///< toes down, in the air
};

enum Leg : std::size_t { hind_left, hind_right, fore_left, fore_right };

struct DogState {
  double height = 0.0, ahead = 0.0;  ///< of the hips, metres from the rest pose
  double yaw = 0.0, pitch = 0.0, roll = 0.0;
  double arch = 0.0, sway = 0.0;  ///< of the spine: back up, and to the left
  double neck_pitch = 0.0, neck_yaw = 0.0, head_pitch = 0.0, head_yaw = 0.0, head_roll = 0.0;
  double jaw = 0.0, ears = 0.0;
  double tail_raise = 0.0, tail_curl = 0.0;
  std::array<double, 6> tail_wag{};
  std::array<double, 2> scapula{};  ///< left, right; forwards when positive
  std::array<Paw, 4> paws;
};

/// Draws a point in the air nearer to where its leg starts when it is out of reach; a standing paw (`lift` 0) stays
/// where it is.
dvec3 within_reach(const dvec3& start, const dvec3& end, double leg_length, double lift) {
  constexpr double easy = 0.88, limit = 0.99;
  const double reach = glm::length(end - start) / leg_length;
  if (reach <= easy) return end;
  const double softened = limit - (limit - easy) * std::exp((easy - reach) / (limit - easy));
  return start + (end - start) * (1.0 + smooth_step(0.0, 0.05, lift) * (softened / reach - 1.0));
}

class DogPoser {
 public:
  DogPoser(const Rig& rig, const DogState& state) : rig_(rig), state_(state), pose_(rest_pose(rig)) { set_all(); }
  const Pose& pose() const { return pose_; }
  /// Of all standing legs, the largest distance to go / length of the leg.
  double stretch() const { return stretch_; }

 private:
  std::size_t index(const std::string& name) const { return static_cast<std::size_t>(rig_.find(name)); }
  dvec3 head(const std::string& name) const { return rig_.joints[index(name)].head; }
  void set(const std::string& name, const glm::dquat& turn) { pose_.turns[index(name)] = turn; }
  glm::dquat model_turn(const std::string& name) const { return place(rig_, pose_).turns[index(name)]; }

  void set_all() {
    pose_.root_position += dvec3(0.0, state_.height, state_.ahead);
    set("hips", about_y(state_.yaw) * about_x(state_.pitch - 0.5 * state_.arch) * about_z(state_.roll));
    for (const char* name : {"spine_1", "spine_2", "chest"}) {
      set(name, about_y(state_.sway / 3.0) * about_x(state_.arch / 3.0) * about_z(-state_.roll / 3.0));
    }
    const glm::dquat neck = about_y(0.5 * state_.neck_yaw) * about_x(0.5 * state_.neck_pitch);
    set("neck_1", neck);
    set("neck_2", neck);
    set("head", about_y(state_.head_yaw) * about_x(state_.head_pitch) * about_z(state_.head_roll));
    set("jaw", about_x(state_.jaw));
    for (const bool left : {true, false}) {
      const glm::dquat ear = about_x(-state_.ears) * about_z(-0.3 * state_.ears);
      set(left ? "ear_l" : "ear_r", left ? ear : mirrored(ear));
      set(left ? "ear_tip_l" : "ear_tip_r", about_x(-0.5 * state_.ears));
    }
    for (std::size_t i = 0; i < 6; ++i) {
      set("tail_" + std::to_string(i + 1),
          about_y(state_.tail_wag[i]) * about_x(i == 0 ? state_.tail_raise : state_.tail_curl));
    }
    set_leg(hind_left, "thigh_l", "shin_l", "hock_l", "hind_toes_l", dvec3(0, 0, 1));
    set_leg(hind_right, "thigh_r", "shin_r", "hock_r", "hind_toes_r", dvec3(0, 0, 1));
    set("scapula_l", about_x(-state_.scapula[0]));
    set("scapula_r", about_x(-state_.scapula[1]));
    set_leg(fore_left, "upper_arm_l", "forearm_l", "pastern_l", "fore_toes_l", dvec3(0, 0, -1));
    set_leg(fore_right, "upper_arm_r", "forearm_r", "pastern_r", "fore_toes_r", dvec3(0, 0, -1));
  }

  void set_leg(Leg leg, const std::string& upper, const std::string& lower, const std::string& foot,
               const std::string& toes, const dvec3& pole) {
    const Paw& paw = state_.paws[leg];
    const dvec3 ball = head(toes) + dvec3(0.0, paw.lift, paw.ahead);
    const glm::dquat foot_turn = about_x(paw.pitch);
    const dvec3 start = place(rig_, pose_).positions[index(upper)];
    const dvec3 upper_bone = head(lower) - head(upper), lower_bone = head(foot) - head(lower);
    const double upper_length = glm::length(upper_bone), lower_length = glm::length(lower_bone);
    const dvec3 end =
        within_reach(start, ball + foot_turn * (head(foot) - head(toes)), upper_length + lower_length, paw.lift);
    const TwoBoneBend bend = bend_two_bones(start, end, upper_length, lower_length, pole);
    if (paw.lift < 0.01) stretch_ = std::max(stretch_, bend.stretch);
    const dvec3 side(pole.z, 0, 0);
    const std::string above = rig_.joints[static_cast<std::size_t>(rig_.joints[index(upper)].parent)].name;
    const glm::dquat upper_turn = aim(upper_bone, side, bend.middle - start, bend.side);
    const glm::dquat lower_turn = aim(lower_bone, side, end - bend.middle, bend.side);
    set(upper, glm::conjugate(model_turn(above)) * upper_turn);
    set(lower, glm::conjugate(upper_turn) * lower_turn);
    set(foot, glm::conjugate(lower_turn) * foot_turn);
    set(toes, about_x(-paw.pitch) * about_x(paw.toe_bend));
  }

  const Rig& rig_;
  const DogState& state_;
  Pose pose_;
  double stretch_ = 0.0;
};

struct DogGait {
  double period_seconds, metres_per_second, stance;
  std::array<double, 4> offsets;  // phases at time 0; a paw lands at phase 0
  double hind_lift, fore_lift;
  double hind_ahead, fore_ahead;  // middle of stance before where the paw rests, metres
  double push;                    // how far the paw rolls over its toes, radians
};

const DogGait walk_gait = {28.0 / 30.0, 0.78, 0.64, {0.0, 0.5, 0.75, 0.25}, 0.06, 0.07, 0.03, -0.02, 0.45};
const DogGait trot_gait = {16.0 / 30.0, 1.75, 0.43, {0.0, 0.5, 0.5, 0.0}, 0.09, 0.11, 0.03, -0.02, 0.6};
const DogGait gallop_gait = {14.0 / 30.0, 3.9, 0.23, {0.0, 0.9, 0.44, 0.56}, 0.11, 0.15, 0.06, 0.0, 0.75};

/// From half the travel behind to half of it before, for `u` from 0 to 1, with the same slope at both ends.
double swing_path(double u, double travel, double end_slope) {
  const double v = 1.0 - u;
  return travel * (u * u * (3.0 - 2.0 * u) - 0.5) + end_slope * (u * v * v - u * u * v);
}

Paw gait_paw(const DogGait& gait, Leg leg, double seconds) {
  const bool hind = leg == hind_left || leg == hind_right;
  const double steps = seconds / gait.period_seconds + gait.offsets[leg];
  const double phase = steps - std::floor(steps);
  const double swing = std::max(phase - gait.stance, 0.0) / (1.0 - gait.stance);
  // In place the ground moves back under a standing paw; the swing starts and ends with the ground's speed.
  const double travel = gait.metres_per_second * gait.period_seconds * gait.stance;
  // In place the ground moves back under a standing paw. A paw keeps a part of that speed when it leaves the ground and
  // takes it up before it lands.
  const double end_slope = -0.3 * gait.metres_per_second * gait.period_seconds * (1.0 - gait.stance);
  Paw paw;
  paw.ahead = (hind ? gait.hind_ahead : gait.fore_ahead) +
              (phase < gait.stance ? travel * (0.5 - phase / gait.stance) : swing_path(swing, travel, end_slope));
  static const Curve lift({{0.0, 0.0}, {0.4, 1.0}, {0.75, 0.55}, {1.0, 0.0}});
  paw.lift = (hind ? gait.hind_lift : gait.fore_lift) * lift(swing);
  const Curve roll({{0.0, -0.35},
                    {0.5 * gait.stance, 0.05},
                    {gait.stance, 1.0},
                    {gait.stance + 0.3 * (1.0 - gait.stance), hind ? 1.2 : 1.9},
                    {gait.stance + 0.75 * (1.0 - gait.stance), 0.1},
                    {1.0, -0.35}},
                   true);
  paw.pitch = gait.push * roll(phase);
  paw.toe_bend = (0.5 + gait.push) * hump(0.0, 0.9, swing);
  return paw;
}

DogState gait_base(const DogGait& gait, double seconds) {
  DogState state;
  for (const Leg leg : {hind_left, hind_right, fore_left, fore_right}) state.paws[leg] = gait_paw(gait, leg, seconds);
  for (std::size_t side = 0; side < 2; ++side) state.scapula[side] = 1.0 * state.paws[fore_left + side].ahead;
  return state;
}

void wag(DogState& state, double phase, double amplitude, double lag) {
  for (std::size_t i = 0; i < 6; ++i) {
    const double k = static_cast<double>(i);
    state.tail_wag[i] = amplitude * (0.6 + 0.12 * k) * wave(phase - lag * k);
  }
}

DogState walk_state(double t) {
  const double p = t / walk_gait.period_seconds;
  DogState state = gait_base(walk_gait, t);
  state.height = 0.007 * cosine(2.0 * p - 0.2);
  state.yaw = 0.05 * cosine(p);
  state.sway = -0.10 * cosine(p - 0.05);
  state.roll = 0.035 * wave(p);
  state.pitch = 0.012 * wave(2.0 * p);
  state.neck_pitch = 0.14 + 0.05 * cosine(2.0 * p + 0.15);
  state.head_pitch = 0.05 - 0.04 * cosine(2.0 * p + 0.1);
  state.head_yaw = 0.04 * cosine(p - 0.1);
  state.ears = 0.05 * wave(2.0 * p);
  state.tail_raise = 0.15;
  wag(state, p, 0.10, 0.07);
  return state;
}

DogState trot_state(double t) {
  const double p = t / trot_gait.period_seconds;
  DogState state = gait_base(trot_gait, t);
  state.height = -0.014 * cosine(2.0 * (p - 0.21));
  state.yaw = 0.04 * cosine(p);
  state.sway = -0.07 * cosine(p - 0.05);
  state.roll = 0.02 * wave(p);
  state.neck_pitch = -0.05 + 0.03 * cosine(2.0 * p);
  state.head_pitch = 0.10 - 0.03 * cosine(2.0 * p - 0.1);
  state.jaw = 0.18 + 0.03 * wave(2.0 * p);
  state.ears = 0.12 + 0.10 * wave(2.0 * p - 0.1);
  state.tail_raise = 0.45;
  state.tail_curl = 0.10;
  wag(state, p, 0.12, 0.08);
  return state;
}

DogState gallop_state(double t) {
  const double p = t / gallop_gait.period_seconds;
  DogState state = gait_base(gallop_gait, t);
  state.arch = 0.10 + 0.34 * cosine(p - 0.97);
  state.height = 0.022 * cosine(2.0 * (p - 0.92)) + 0.012 * wave(p);
  state.pitch = 0.13 * wave(p - 0.35);
  state.neck_pitch = 0.30 - 0.22 * cosine(p - 0.93);
  state.head_pitch = -0.10 + 0.02 * cosine(p - 0.5);
  state.jaw = 0.25 + 0.05 * wave(p);
  state.ears = 0.55 + 0.18 * wave(p - 0.1);
  state.tail_raise = 0.75 + 0.25 * wave(p - 0.1);
  state.tail_curl = 0.08 * wave(p - 0.3);
  wag(state, p, 0.05, 0.1);
  return state;
}

DogState idle_state(double t) {
  constexpr double period = 6.0;
  const double pant = wave(15.0 * t / period);
  DogState state;
  state.height = -0.012 + 0.002 * fidget(t, period, 1, 3, 1);
  state.ahead = 0.006 * fidget(t, period, 1, 3, 2);
  state.arch = 0.02 * wave(2.0 * t / period) + 0.006 * pant;
  state.sway = 0.05 * fidget(t, period, 1, 3, 3);
  state.neck_pitch = -0.05 + 0.05 * fidget(t, period, 1, 4, 4) + 0.006 * pant;
  state.neck_yaw = 0.30 * fidget(t, period, 1, 3, 5);
  state.head_pitch = 0.05 * fidget(t, period, 1, 5, 6);
  state.head_yaw = 0.18 * fidget(t, period, 1, 5, 7);
  state.head_roll = 0.08 * fidget(t, period, 1, 4, 8);
  state.jaw = 0.26 + 0.07 * pant;
  state.ears = 0.06 * fidget(t, period, 2, 12, 9);
  state.tail_raise = 0.75 + 0.04 * fidget(t, period, 1, 4, 10);
  state.tail_curl = 0.16;
  wag(state, 12.0 * t / period, 0.22 + 0.08 * cosine(t / period), 0.09);
  return state;
}

DogState jump_state(double t) {
  constexpr double length = 1.1;
  static const Curve height(
      {{0.0, 0.0}, {0.32, -0.11}, {0.55, 0.05}, {0.80, 0.30}, {1.02, 0.05}, {1.18, -0.09}, {1.55, 0.0}, {1.7, 0.0}});
  static const Curve pitch(
      {{0.0, 0.0}, {0.30, 0.10}, {0.55, -0.42}, {0.80, -0.02}, {0.98, 0.34}, {1.15, 0.12}, {1.5, 0.0}});
  DogState state;
  state.height = height(t);
  state.ahead = -0.05 * hump(0.0, 0.6, t) + length * smooth_step(0.25, 1.25, t);
  state.pitch = pitch(t);
  state.arch = 0.18 * hump(0.0, 0.55, t) - 0.35 * hump(0.45, 0.95, t) + 0.35 * hump(0.95, 1.4, t);
  state.neck_pitch = -0.8 * pitch(t);
  state.ears = 0.5 * hump(0.3, 1.3, t);
  state.tail_raise = 0.3 + 0.5 * hump(0.2, 1.3, t);
  for (const Leg leg : {hind_left, hind_right, fore_left, fore_right}) {
    const bool hind = leg == hind_left || leg == hind_right;
    const double late = leg == hind_right || leg == fore_right ? 0.02 : 0.0;
    const double off = (hind ? 0.52 : 0.34) + late, on = (hind ? 1.16 : 0.98) + late;
    Paw& paw = state.paws[leg];
    paw.ahead = length * smooth_step(off, on, t);
    paw.lift = (hind ? 0.30 : 0.40) * hump(off, on, t);
    paw.pitch = 0.5 * hump(off - 0.25, off + 0.3, t) + 0.3 * hump(off, on, t);
    paw.toe_bend = 0.6 * hump(off, on, t);
    if (!hind) state.scapula[leg - fore_left] = 0.4 * hump(0.4, 1.1, t);
  }
  return state;
}

struct DogMotion {
  double seconds;
  bool loops;
  DogState (*state)(double);
};

DogMotion find_motion(std::string_view name) {
  if (name == "walk") return {walk_gait.period_seconds, true, walk_state};
  if (name == "trot") return {trot_gait.period_seconds, true, trot_state};
  if (name == "gallop") return {gallop_gait.period_seconds, true, gallop_state};
  if (name == "idle") return {6.0, true, idle_state};
  if (name == "jump") return {1.7, false, jump_state};
  throw std::invalid_argument("the quadruped has no clip named " + std::string(name));
}

/// How much lower the whole motion must be for all paws to reach their places.
double lowering(const Rig& rig, const DogMotion& motion) {
  constexpr double step = 0.002, deepest = 0.2, longest = 0.992;
  double drop = 0.0;
  for (int i = 0; i < 120; ++i) {
    DogState state = motion.state(motion.seconds * i / 120.0);
    state.height -= drop;
    while (drop < deepest && DogPoser(rig, state).stretch() > longest) {
      drop += step;
      state.height -= step;
    }
  }
  return drop;
}

}  // namespace

std::vector<std::string> quadruped_clip_names() { return {"walk", "trot", "gallop", "idle", "jump"}; }

PoseClip quadruped_clip(const Rig& rig, std::string_view name, double frames_per_second) {
  const DogMotion motion = find_motion(name);
  const double drop = motion.loops ? lowering(rig, motion) : 0.0;
  const auto frames = std::lround(motion.seconds * frames_per_second);
  PoseClip clip{std::string(name), frames_per_second, 0, {}};
  for (long i = 0; i <= frames; ++i) {
    DogState state = motion.state(static_cast<double>(motion.loops && i == frames ? 0 : i) / frames_per_second);
    state.height -= drop;
    clip.poses.push_back(DogPoser(rig, state).pose());
  }
  return clip;
}

}  // namespace nmc::samples
