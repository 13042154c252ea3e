// Jumps: places where a parameter leaves for elsewhere from one sample to the next, as in a teleport or a cut.
#pragma once

#include <vector>

#include "codec/clip_layout.h"
#include "codec/clip_set.h"
#include "codec/sparse_training.h"

namespace nmc::codec {

/// Atoms that take the jumps out of a clip's moving parameters, so that what is left is smooth: one of width jump_width
/// for each jump, one of width 0 where the next sample is back again. A jump is a difference of two samples that is far
/// above those around it and above an anchor's step. In the order of the stream; none in most motion.
std::vector<LevelAtom> find_jumps(const ClipLayout& layout, const ParameterSteps& steps);

}  // namespace nmc::codec
