// The codec of Tojo, Chen and Umetani 2022 as published: one network a clip, float32 weights, Algorithm 1.
#pragma once

#include <optional>
#include <string>

#include "codec/source.h"

namespace nmc::codec {

/// The outcome of Algorithm 1 on one clip.
struct PaperClip {
  EncodedSet set;              ///< of this clip alone
  double joint_error = 0;      ///< the paper's: largest distance of a joint over all frames, world units
  bool reached = false;        ///< joint_error is within the tolerance
  std::size_t parameters = 0;  ///< numbers in alpha
  std::size_t values = 0;      ///< numbers in Y: the paper's ratio is values / parameters
};

PaperClip encode_paper(const Source& source, std::size_t clip, const CompressOptions& options);

}  // namespace nmc::codec
