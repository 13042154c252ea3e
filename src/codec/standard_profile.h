// The default codec: a sparse Fourier layer per clip, trained through kinematics for its bytes, within the bound.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "codec/clip_set.h"
#include "codec/compress.h"
#include "codec/source.h"

namespace nmc::codec {

/// Trains each clip once and writes any selection of them as one set.
class StandardEncoder {
 public:
  /// How exactly anchors and atoms are written: steps 2^(-n / 4) of what one tolerance is worth.
  static constexpr int usual_precision = 9;
  static constexpr int finest_precision = 30;

  /// Precision for first and last poses that are to be exact.
  static constexpr int exact_precision = 40;

  /// `clips` are indices into Source::clips, ascending; all have the same bound.
  StandardEncoder(const Source& source, const CompressOptions& options, const std::vector<std::size_t>& clips,
                  int precision);

  /// The set of some of the clips (indices into Source::clips, ascending). Every clip is within the tolerance by the
  /// encoder's own measurement unless it cannot be brought there.
  EncodedSet encode(const std::vector<std::size_t>& clips) const;

 private:
  std::vector<NodeTarget> targets_;
  ClipSet set_;                               ///< its clips: those trained
  std::map<std::size_t, std::size_t> place_;  ///< of a clip of the source among them
  std::vector<double> seconds_;
  std::vector<std::vector<Candidate>> candidates_;  ///< as seconds_; empty where nobody asked
};

/// Gives the set clips: of each one's choices (the first clip's, the second's, ...), none of them empty, whichever
/// makes the set smallest, one clip after the other. The set is never larger than with the first choice of each.
void choose_clips(const std::vector<std::vector<LevelClip>>& choices, ClipSet& set);

/// Predicts each clip's first anchor pose from the earlier clip whose last one is nearest, in bits.
void choose_references(ClipSet& chosen);

}  // namespace nmc::codec
