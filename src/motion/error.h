// The error that users see: how far a decoded animation moves the points of a character from where they should be (DESIGN: error).
#pragma once

#include <string>
#include <vector>

#include "base/animation.h"
#include "base/points.h"
#include "motion/skeleton.h"

namespace nmc::motion {

/// The character's size: the largest side of the box of the skin joints in the rest pose; without skins of the points at rest; 1 when that is 0.
double character_size(const Skeleton& skeleton, const Points& points);

/// Distances in world units. `mean` and `percentile_99` are over all sampled times and points.
struct ErrorReport {
  double max = 0;
  double mean = 0;
  double percentile_99 = 0;
  double max_joint = 0;            ///< the same maximum over skin joints' origins alone (the paper's measure)
  double max_rotation_degrees = 0; ///< largest angle between local rotations of animated nodes
  double max_morph_weight = 0;     ///< largest difference of a morph weight
  double jitter = 0;               ///< root mean square of the second difference over key times of the error vector, all points
  double loop_seam = 0;            ///< largest change of the error vector between last and first key time
  double max_seconds = 0;          ///< when the maximum occurs
  int max_node = -1;               ///< the node with the largest influence on the worst point
};

/// Compares two animations of one character at all key times of `original` and the midpoints between them. Curves are matched by node and path;
/// a missing curve means the rest value.
ErrorReport measure_error(const Skeleton& skeleton, const Points& points, const Animation& original, const Animation& decoded);

}  // namespace nmc::motion
