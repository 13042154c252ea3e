// The default codec: a sparse Fourier layer per clip, trained through kinematics for its bytes, within the bound.
#pragma once

#include <cstddef>
#include <vector>

#include "codec/clip_set.h"
#include "codec/compress.h"
#include "codec/source.h"

namespace nmc::codec {

/// Trains each clip once and writes any selection of them as one set.
class StandardEncoder {
 public:
  StandardEncoder(const Source& source, const CompressOptions& options);

  /// The set of the clips (indices into Source::clips, ascending). Every clip is within the tolerance by the encoder's
  /// own measurement unless it cannot be brought there.
  EncodedSet encode(const std::vector<std::size_t>& clips) const;

 private:
  std::vector<NodeTarget> targets_;
  ClipSet set_;  ///< all clips of the source
  std::vector<double> seconds_;
};

}  // namespace nmc::codec
