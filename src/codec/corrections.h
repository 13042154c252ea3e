// Brings what training left above the bound under it, by sparse corrections in time and parameter.
#pragma once

#include "base/points.h"
#include "codec/clip_layout.h"
#include "codec/motion_map.h"
#include "codec/sparse_training.h"

namespace nmc::codec {

/// Adds atoms to `clip` until every point is within `bound` (world units) over `strictness` (one number per sample, one
/// or more) of `wanted` (positions of the map's points) at every sample. False where that is not reached within
/// `most_atoms`; the clip then has the atoms found so far. The result does not depend on `threads`.
bool correct(LevelClip& clip, const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted,
             double bound, const SampleRow& strictness, std::size_t most_atoms, int threads = 1);

}  // namespace nmc::codec
