// Brings what training left above the bound under it, by sparse corrections in time and parameter.
#pragma once

#include <cstddef>
#include <memory>

#include "codec/clip_layout.h"
#include "codec/motion_map.h"
#include "codec/sparse_training.h"

namespace nmc::codec {

/// Corrects levels, round after round: what has not changed since the last time is not looked at again.
class Corrections {
 public:
  /// `wanted`: positions of the map's points; `bound`: world units. All that it is given outlives it, and the map is
  /// its alone meanwhile. The result does not depend on `threads`.
  Corrections(const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted, double bound,
              int threads = 1);
  ~Corrections();
  Corrections(const Corrections&) = delete;
  Corrections& operator=(const Corrections&) = delete;

  /// Adds atoms to `clip` until every point is within the bound over `strictness` (one number per sample, one or more)
  /// at every sample. False where that is not reached within `most_atoms`; the clip then has the atoms found so far.
  bool correct(LevelClip& clip, const SampleRow& strictness, std::size_t most_atoms);

 private:
  class Corrector;
  std::unique_ptr<Corrector> corrector_;
};

}  // namespace nmc::codec
