// What the clips of a set share: reference pose and step sizes, found from how far each parameter moves the points.
#pragma once

#include <vector>

#include "codec/clip_layout.h"
#include "codec/clip_set.h"
#include "codec/source.h"
#include "codec/sparse_training.h"

namespace nmc::codec {

struct SharedPart {
  SetFrame frame;  ///< its reference pose is the one that the set stores, in whole steps
  ClipSet set;     ///< targets, steps and references; no clips
};

/// Steps: one tolerance over the root mean square (over samples and clips) of the farthest point's way per unit of the
/// parameter. Reference pose: the mean over the clips.
SharedPart make_shared_part(const Source& source, int threads);

/// The steps of a clip's parameters.
ParameterSteps steps_for(const ClipSet& set, const ClipLayout& layout);

}  // namespace nmc::codec
