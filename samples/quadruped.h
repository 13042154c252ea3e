// A dog of 38 joints, 0.6 m high at the shoulder: skeleton, skin and clips.
#pragma once

#include <string_view>
#include <vector>

#include "samples/export.h"

namespace nmc::samples {

/// The skeleton in its rest pose: standing, facing +Z.
Rig quadruped_rig(RestStyle style);

/// The body: coat, muzzle, ears, paws.
SkinMesh quadruped_mesh(const Rig& rig);

/// Clips: walk, trot and gallop (loops in place), idle (loop), jump.
std::vector<std::string> quadruped_clip_names();

/// A named clip. Throws std::invalid_argument for a name that is not listed.
PoseClip quadruped_clip(const Rig& rig, std::string_view name, double frames_per_second);

}  // namespace nmc::samples
