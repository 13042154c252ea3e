// Frequency-adaptive training of a pose network: Algorithm 1.
#include "network/adaptive_training.h"

#include <fmt/format.h>

#include "base/error.h"
#include "network/fourier_features.h"
#include "network/frequency_search.h"

namespace nmc::network {
namespace {

void check(const TrainingClip& clip) {
  const auto refuse = [](const char* what) {
    throw Error(ErrorCode::invalid_input, fmt::format("Training a network: {}.", what));
  };
  if (clip.poses.rows() == 0 || clip.poses.cols() == 0) refuse("the clip has no frames or no pose parameters");
  if (clip.weights.size() != clip.poses.cols()) refuse("there is not one weight per pose parameter");
  if (!clip.poses.allFinite()) refuse("the clip holds values that are not finite");
  if (!clip.weights.allFinite() || (clip.weights.array() < 0).any()) refuse("a weight is negative or not finite");
}

/// Half cycles of the next frequency; 0 when there is none left.
int next_frequency(const PoseNetwork& network, const TrainingClip& clip, FrequencyChoice choice) {
  if (choice == FrequencyChoice::consecutive) return 2 * (static_cast<int>(network.half_cycles.size()) + 1);
  const Eigen::MatrixXf residual = clip.poses - evaluate(network, frame_times(clip.poses.rows()));
  return dominant_half_cycles(residual, clip.weights, network.half_cycles);
}

}  // namespace

AdaptiveResult train_adaptive(const TrainingClip& clip, const AdaptiveOptions& options, const Measure& measure) {
  check(clip);
  AdaptiveResult result;
  PoseNetwork network = make_network({}, paper_hidden_size(0), clip.poses.cols(), false, options.seed);
  for (int frequencies = 0;; ++frequencies) {
    const bool last = frequencies >= options.max_frequencies;
    TrainOptions training = options.training;
    if (last) training.iterations = options.final_iterations;
    AdaptiveStep step;
    step.frequencies = frequencies;
    step.loss = train(network, clip, training);
    step.error = measure(network);
    result.steps.push_back(step);
    if (result.steps.size() == 1 || step.error < result.error) {
      result.network = network;
      result.error = step.error;
    }
    if (options.progress) {
      options.progress(last ? 1.0 : static_cast<double>(frequencies + 1) / (options.max_frequencies + 1),
                       fmt::format("{} frequencies", frequencies));
    }
    result.success = step.error <= options.threshold;
    if (result.success || last || (options.stop_requested && options.stop_requested())) return result;
    const int half_cycles = next_frequency(network, clip, options.choice);
    if (half_cycles == 0) return result;
    network = grow(network, half_cycles, paper_hidden_size(frequencies + 1),
                   options.seed + static_cast<std::uint64_t>(frequencies) + 1);
  }
}

}  // namespace nmc::network
