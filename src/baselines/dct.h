// The plain opponent: a DCT-II of each channel over the whole clip, one step a clip, the codec's own entropy coder.
#pragma once

#include <vector>

#include "codec/source.h"

namespace nmc::baselines {

/// Rounds the transform without training and corrections. Every clip has the coarsest step (in quarters of an octave)
/// that a bisection finds with the decoded error within source.tolerance; clips without one are left out. One set at
/// the codec's usual precision of anchors, and one at its finest for clips that the first cannot hold.
std::vector<codec::EncodedSet> encode_dct(const codec::Source& source, int threads);

}  // namespace nmc::baselines
