// Frequency-adaptive training of a pose network (Tojo et al. 2022, Algorithm 1).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/progress.h"
#include "network/pose_network.h"
#include "network/training.h"

namespace nmc::network {

enum class FrequencyChoice {
  adaptive,     ///< the peak of the residual's DCT (Algorithm 1)
  consecutive,  ///< 1, 2, ..., K full cycles per clip: the paper's naive baseline
};

struct AdaptiveOptions {
  FrequencyChoice choice = FrequencyChoice::adaptive;
  int max_frequencies = 40;
  double threshold = 0;         ///< the error at which to stop, in the unit of the measure
  TrainOptions training;        ///< of each network but the last
  int final_iterations = 1500;  ///< of the network with the most frequencies
  std::uint64_t seed = 1;
  std::function<bool()> stop_requested;  ///< true ends the search with what there is. May be empty.
  Progress progress;
};

/// The error of a network that decides (in the paper the largest joint position error). Called after each training.
using Measure = std::function<double(const PoseNetwork&)>;

struct AdaptiveStep {
  int frequencies = 0;
  double loss = 0;   ///< equation 3
  double error = 0;  ///< the measure
};

struct AdaptiveResult {
  PoseNetwork network;              ///< the first under the threshold; where none was, the one with the least error
  double error = 0;                 ///< of it
  bool success = false;             ///< error <= threshold
  std::vector<AdaptiveStep> steps;  ///< one per number of frequencies that was trained
};

/// Algorithm 1. Throws Error (invalid_input) when the clip has no frames or no parameters, or holds values that are not
/// finite.
AdaptiveResult train_adaptive(const TrainingClip& clip, const AdaptiveOptions& options, const Measure& measure);

}  // namespace nmc::network
