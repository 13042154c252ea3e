// Prints how long Algorithm 1 takes on a made clip of the size that the paper quotes a time for (900 frames, K = 10),
// and the error it reaches.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <numbers>

#include "network/adaptive_training.h"
#include "network/fourier_features.h"
#include "network/random.h"

namespace {

using namespace nmc::network;

constexpr Eigen::Index frame_count = 900;
constexpr Eigen::Index joint_count = 30;
constexpr Eigen::Index pose_size = 4 + 3 + 3 * joint_count;

double wave(double half_cycles, double t, double phase) {
  return std::sin(std::numbers::pi * (half_cycles * t + phase));
}

/// A clip that moves like a walk with a turn: all parameters share a gait of three harmonics and a few slow modes whose
/// amplitudes fall as 1 / f, each adds a little of its own, and the root drifts. Lengths are in body heights.
TrainingClip make_clip() {
  constexpr int slow_modes = 12;
  constexpr int own_modes = 30;
  constexpr double gait_half_cycles = 15;
  Random random(2022);
  TrainingClip clip;
  clip.poses.resize(frame_count, pose_size);
  clip.weights.resize(pose_size);
  for (Eigen::Index i = 0; i < pose_size; ++i) {
    const bool root_translation = i >= 4 && i < 7;
    clip.weights[i] = root_translation ? 1.0f : static_cast<float>(0.1 + 0.4 * std::abs(random.uniform()));
    const double amplitude = 0.1 + 0.3 * std::abs(random.uniform());
    const double drift = root_translation ? 2 * random.uniform() : 0.0;
    const double offset = random.uniform();
    std::vector<double> strengths;
    std::vector<double> half_cycles;
    std::vector<double> phases;
    const auto add = [&](double strength, double frequency) {
      strengths.push_back(strength * random.uniform());
      half_cycles.push_back(frequency);
      phases.push_back(random.uniform());
    };
    for (int harmonic = 1; harmonic <= 3; ++harmonic) add(1.0 / harmonic, gait_half_cycles * harmonic);
    for (int mode = 1; mode <= slow_modes; ++mode) add(0.5 / mode, mode);
    for (int mode = 1; mode <= own_modes; ++mode) add(0.1 / mode, 4 * mode + random.uniform());
    for (Eigen::Index n = 0; n < frame_count; ++n) {
      const double t = static_cast<double>(n) / (frame_count - 1);
      double value = offset + drift * t;
      for (std::size_t k = 0; k < strengths.size(); ++k) {
        value += amplitude * strengths[k] * wave(half_cycles[k], t, phases[k]);
      }
      clip.poses(n, i) = static_cast<float>(value);
    }
  }
  return clip;
}

}  // namespace

int main() {
  const TrainingClip clip = make_clip();
  AdaptiveOptions options;
  options.max_frequencies = 10;
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  fmt::print("{} frames, {} pose parameters, one thread; weighted errors in % of body height\n", clip.poses.rows(),
             clip.poses.cols());
  fmt::print("  K  parameters  half cycles  pose rms  largest  seconds\n");
  train_adaptive(clip, options, [&](const PoseNetwork& network) {
    const Eigen::MatrixXf difference = clip.poses - evaluate(network, frame_times(frame_count));
    const Eigen::MatrixXf weighted = difference * clip.weights.asDiagonal();
    const double rms = std::sqrt(weighted.squaredNorm() / static_cast<float>(frame_count));
    const double largest = weighted.cwiseAbs().maxCoeff();
    fmt::print("{:3}  {:10}  {:>11}  {:8.3f}  {:7.3f}  {:7.2f}\n", network.half_cycles.size(), parameter_count(network),
               network.half_cycles.empty() ? "" : fmt::to_string(network.half_cycles.back()), 100 * rms, 100 * largest,
               seconds());
    return largest;
  });
}
