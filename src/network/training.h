// Fits the weights of a pose network to a clip (Tojo et al. 2022, line 4 of Algorithm 1).
#pragma once

#include <functional>

#include "network/pose_network.h"

namespace nmc::network {

struct TrainOptions {
  int iterations = 300;
  double learning_rate = 0.01;                     ///< of the first iteration; falls to zero along a half cosine
  std::function<bool()> stop_requested = nullptr;  ///< asked in every iteration; true ends the training early
};

/// The clip that a network is trained on.
struct TrainingClip {
  Eigen::MatrixXf poses;    ///< N x m, one frame per row, at the times of frame_times(N)
  Eigen::VectorXf weights;  ///< m: w of equation 3, not negative
};

/// Minimises equation 3 from the network given: full batch, the steps of Optimizer on a cosine schedule, in coordinates
/// where the weighted clip has zero mean and unit variance. The best weights seen come back, never worse than the ones
/// given; parameters whose weight is zero get a constant, their mean. Returns the loss of equation 3. The same input
/// gives the same network.
double train(PoseNetwork& network, const TrainingClip& clip, const TrainOptions& options);

}  // namespace nmc::network
