// The default codec: a sparse Fourier layer per clip, trained through kinematics for its bytes, within the bound.
#pragma once

#include <memory>
#include <vector>

#include "codec/compress.h"
#include "codec/source.h"

namespace nmc::codec {

/// Trains each clip once and writes any selection of them as one set.
class StandardEncoder {
 public:
  /// `source` must outlive it.
  StandardEncoder(const Source& source, const CompressOptions& options);
  ~StandardEncoder();

  /// The set of the clips (indices into Source::clips, ascending). Every clip is within the tolerance by the encoder's
  /// own measurement unless it cannot be brought there.
  EncodedSet encode(const std::vector<std::size_t>& clips);

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace nmc::codec
