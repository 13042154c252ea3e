// The codec of Tojo, Chen and Umetani 2022 as published: one network a clip, float32 weights, Algorithm 1.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "codec/source.h"
#include "network/adaptive_training.h"

namespace nmc::codec {

/// One network on the way of Algorithm 1.
struct PaperStep {
  int frequencies = 0;         ///< K
  double joint_error = 0;      ///< world units
  std::size_t parameters = 0;  ///< numbers in alpha
  double seconds = 0;          ///< since the start, training of all networks up to this one
};

/// The outcome of Algorithm 1 on one clip.
struct PaperClip {
  EncodedSet set;                ///< of this clip alone
  double joint_error = 0;        ///< the paper's: largest distance of a joint over all frames, world units
  bool reached = false;          ///< joint_error is within the tolerance
  std::size_t parameters = 0;    ///< numbers in alpha
  std::size_t values = 0;        ///< numbers in Y: the paper's ratio is values / parameters
  std::vector<PaperStep> steps;  ///< one per number of frequencies that was trained
};

/// Runs Algorithm 1 on clip `clip` until the largest joint error is within source.tolerance or K is
/// options.max_frequencies; the stream holds the network with the least error. `choice`: consecutive is the paper's
/// naive baseline. `on_network` (may be empty) gets every network on the way, as the set that it would be.
PaperClip encode_paper(const Source& source, std::size_t clip, const CompressOptions& options,
                       network::FrequencyChoice choice = network::FrequencyChoice::adaptive,
                       const std::function<void(EncodedSet)>& on_network = {});

/// The largest K, 40 at most, with which the network of a clip has no more than twice the numbers of its moving
/// parameters.
int most_paper_frequencies(const Source& source, std::size_t clip);

}  // namespace nmc::codec
