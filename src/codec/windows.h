// Where a clip is cut into windows, each with sines between the poses at its ends (format: basis 2).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "codec/clip_layout.h"
#include "codec/sparse_training.h"

namespace nmc::codec {

/// Windows of about one length: sample indices from 0 to samples - 1. Needs two samples.
std::vector<std::uint32_t> even_windows(std::size_t samples, std::size_t length);

/// Windows that follow the motion: sample indices from 0 to samples - 1, those on a grid whose anchors and weights take
/// the fewest bits by an estimate, at weights of 2^(-step_exponent / 4) slot steps and without what `jumps` gives.
/// Needs two samples; time and memory grow linearly with them.
std::vector<std::uint32_t> fitted_windows(const ClipLayout& layout, const ParameterSteps& steps,
                                          const std::vector<LevelAtom>& jumps, int step_exponent, int threads);

}  // namespace nmc::codec
