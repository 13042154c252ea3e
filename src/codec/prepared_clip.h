// A clip in its set's parameters, ready to be trained and measured, and what that needs to know of its file.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "codec/clip_layout.h"
#include "codec/clip_set.h"
#include "codec/motion_map.h"
#include "codec/parts.h"
#include "codec/source.h"
#include "codec/sparse_training.h"
#include "motion/error.h"

namespace nmc::codec {

/// A clip in the set's parameters, with where its points should be.
struct PreparedClip {
  ClipLayout layout;
  ParameterSteps steps;
  Eigen::MatrixXd coded;           ///< the first sample, fixed targets as they are coded
  Rows wanted;                     ///< positions of the points of the bound
  std::vector<LaneRows> offset;    ///< TrainingInput::offset: what the rounding of fixed targets moves the points by
  std::vector<LevelAtom> jumps;    ///< taken out before training
  bool loops = false;              ///< the last pose is the first one again
  std::vector<LaneRows> emphasis;  ///< TrainingInput::emphasis: how much an error counts
};

/// The part of the tolerance up to which a measured error is taken as kept.
inline constexpr double kept_share = 0.999;

/// What a search needs to know; all of it outlives the search.
struct SearchContext {
  const Source& source;
  const Bound& bound;
  const SetFrame& frame;
  const ClipSet& set;
  const motion::ErrorMeter& meter;
  std::function<bool()> is_late;         ///< no time is left: take the first result
  std::function<bool()> is_half_over{};  ///< half of the time is over; empty: there is time
  int effort = 5;
  int threads = 1;  ///< for one clip
  bool exact_ends = false;
  Parts parts{};
};

/// Puts clip `index` of the source into the set's parameters. `contact_weight`: how often the error of points that
/// stand still counts.
PreparedClip prepare_clip(const SearchContext& context, std::size_t index, double contact_weight);

}  // namespace nmc::codec
