// Some stretches of a long clip as a short clip of their own: what settings are tried on before the whole clip takes
// them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "codec/prepared_clip.h"
#include "codec/source.h"

namespace nmc::codec {

/// Stretches one after the other. It has no loop, no curves of the file, and times that only count its samples.
struct Excerpt {
  PreparedClip clip;
  ClipSource source;
  double share = 1;  ///< of the clip's samples
  std::vector<std::uint32_t>
      boundaries;  ///< of its windows: those of the clip, and one of a single step between stretches
};

/// Whole windows of a clip, of calm and busy ones about the same share, about `samples` samples in all. `boundaries`:
/// of the clip's windows (sample indices from 0 to samples - 1). None of a clip of few windows, and
/// where it would be most of the clip.
std::optional<Excerpt> excerpt_of(const PreparedClip& clip, const std::vector<std::uint32_t>& boundaries,
                                  Eigen::Index samples);

}  // namespace nmc::codec
