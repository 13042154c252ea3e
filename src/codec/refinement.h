// Changes single levels of a trained clip by one: to bring errors under the bound where that costs almost nothing, and
// to drop weights that the bound does not need.
#pragma once

#include "codec/clip_layout.h"
#include "codec/motion_map.h"
#include "codec/sparse_training.h"

namespace nmc::codec {

/// Moves weights one level up or down as long as that lowers what lies above `bound` (world units), anywhere in the
/// clip, at few bits. `wanted`: positions of the map's points. The bound need not be reached. The result does not
/// depend on `threads`.
void repair(LevelClip& clip, const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted,
            double bound, int threads = 1);

/// Moves weights of a clip that is within `bound` towards zero, smallest first, where it stays within the bound (by the
/// linear map: up to second order).
void prune(LevelClip& clip, const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted,
           double bound, int threads = 1);

}  // namespace nmc::codec
