// Motion capture in Biovision's BVH text format: read into a skeleton and a clip.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "motion/clip.h"
#include "motion/skeleton.h"

namespace nmc::motion {

struct BvhOptions {
  double scale = 1;              ///< metres per unit of the file
  double frames_per_second = 0;  ///< keep every n-th frame to come nearest to this rate; 0: all frames
  std::string clip_name = {};    ///< the name that the clip gets
};

/// Nodes in the order of the file. `skeleton.joints` are the ROOT and JOINT entries; end sites are nodes without
/// tracks, named after their parent with "_end". Rest: the offsets, identity rotations. The clip has a rotation track
/// for each joint with rotation channels, and a translation track for each root and for each other joint whose position
/// changes; a position that never changes is the joint's rest translation.
struct BvhClip {
  Skeleton skeleton;
  Clip clip;
};

/// Reads the text of a BVH file. Rotation channels (degrees) apply in their order in the file, the first outermost;
/// times are frame number times Frame Time. Throws Error (invalid_input) with `file_name` and the line number.
BvhClip parse_bvh(std::string_view text, const std::string& file_name, const BvhOptions& options = {});

}  // namespace nmc::motion
