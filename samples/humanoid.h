// A human figure of 52 joints, 1.75 m tall: skeleton, skin, and the handful of numbers that pose it.
#pragma once

#include <array>
#include <vector>

#include "samples/export.h"
#include "samples/rig.h"
#include "samples/shape.h"

namespace nmc::samples {

/// The skeleton in its rest pose: standing, arms hanging out at 45 degrees.
Rig humanoid_rig(RestStyle style);

/// The body: skin, hair, shirt, trousers, shoes.
SkinMesh humanoid_mesh(const Rig& rig);

/// A foot: where it would stand if it stood flat, and how it leaves that place. Metres and radians.
struct FootState {
  double x = 0.0, z = 0.0;  ///< of the ankle on the ground
  double yaw = 0.0;         ///< about +Y
  double pitch = 0.0;     ///< heel up (rolls over the ball) when positive, toes up (rolls over the heel) when negative
  double lift = 0.0;      ///< height above the ground
  double toe_bend = 0.0;  ///< toes up against the foot; equal to the pitch they lie flat while the heel is up
};

/// An arm, said for the left one; the right one is its mirror image. Radians; all zero lets it hang straight down.
struct ArmState {
  double raise_side = 0.0;     ///< away from the body
  double raise_front = 0.0;    ///< forwards
  double twist = 0.0;          ///< of the upper arm, elbow outwards when positive
  double elbow = 0.0;          ///< bend
  double forearm_twist = 0.0;  ///< palm towards the front when positive
  double wrist = 0.0;          ///< hand towards the palm's side
  double curl = 0.0;           ///< of the fingers, 0 straight .. 1 fist
  double shrug = 0.0;          ///< collar bone up
};

/// A turn as heading, bow and lean. Radians.
struct Bend {
  double yaw = 0.0;    ///< to the left
  double pitch = 0.0;  ///< forwards
  double roll = 0.0;   ///< to the right
};

/// A whole pose. Index 0 is left, 1 is right. Linear blends of two states are sensible states.
struct BodyState {
  double pelvis_x = 0.0, pelvis_height = 0.94, pelvis_z = 0.0;
  Bend pelvis, spine,
      head;  ///< each against what carries it; the spine's is spread over its joints, the head's over neck and head
  std::array<FootState, 2> feet;
  std::array<ArmState, 2> arms;
};

/// (1 - amount) * a + amount * b.
BodyState blend(const BodyState& a, const BodyState& b, double amount);

/// Standing at ease.
BodyState standing();

/// The joints' turns for a state. Legs are solved so that the feet are exactly where they should be, as far as they
/// reach.
Pose solve(const Rig& rig, const BodyState& state);

/// The largest pelvis height at which both legs reach their feet, knees bent by at least `slack` of the leg's length.
double highest_pelvis(const Rig& rig, const BodyState& state, double slack);

/// A named clip of the humanoid, sampled at `frames_per_second`. Names: humanoid_clip_names(). Throws
/// std::invalid_argument.
PoseClip humanoid_clip(const Rig& rig, std::string_view name, double frames_per_second);

/// Clips that make up humanoid_30hz.glb.
std::vector<std::string> humanoid_clip_names();

/// When a foot stands in a clip: its ball joint must not move then.
struct Contact {
  int foot = 0;  ///< 0 left, 1 right
  double from_seconds = 0.0, to_seconds = 0.0;
};

/// The ball's contacts of "walk_root_motion" and "run_root_motion".
std::vector<Contact> humanoid_contacts(std::string_view clip_name);

}  // namespace nmc::samples
