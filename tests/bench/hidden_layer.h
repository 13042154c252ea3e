// A small network beside the sparse layers of a set's clips, with layers that the clips share, trained to save bits.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "codec/clip_search.h"
#include "codec/clip_set.h"

namespace nmc::bench {

struct HiddenSettings {
  int frequencies = 4;           ///< of each clip's layer; fewer where a clip has fewer
  int hidden0 = 4, hidden1 = 4;  ///< units of the clips' layers and of the shared one
  double output_step = 2;        ///< of W2, in the median of the parameters' steps
  double hidden_step = 0.125;    ///< of the other tensors
  double rate = 2;               ///< how much a bit of the network weighs against one of the levels
  int iterations = 500;
};

/// A clip with the levels that a search has found for it. The clips of a set move the same parameters.
struct SparseClip {
  const codec::PreparedClip* clip = nullptr;
  const codec::LevelClip* levels = nullptr;
};

struct HiddenLayer {
  codec::SharedLayers shared;           ///< quantised, as the clips' layers
  std::vector<codec::ClipLayer> clips;  ///< likewise
  std::vector<Eigen::MatrixXd> given;   ///< per clip, all parameters x samples: what the network adds
};

/// Trains the network by Adam so that the levels without what it gives, and its own rounded weights, cost few bits. The
/// steps of the levels stay; a loop's network has the loop's period. Needs a parameter that moves.
HiddenLayer train_hidden_layer(const std::vector<SparseClip>& clips, const codec::ClipSet& set,
                               const HiddenSettings& settings);

}  // namespace nmc::bench
