// What the clips of a set share: reference pose and step sizes, found from how far each parameter moves the points.
#pragma once

#include <cstddef>
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
/// parameter; anchors and atoms have steps finer by 2^(-anchor_exponent / 4). Reference pose: the mean over the clips
/// (indices into Source::clips, all with the same bound).
SharedPart make_shared_part(const Source& source, const std::vector<std::size_t>& clips, int anchor_exponent,
                            int threads);

/// The steps of a clip's parameters.
ParameterSteps steps_for(const ClipSet& set, const ClipLayout& layout);

}  // namespace nmc::codec
