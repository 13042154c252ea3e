// Fourier features of normalised time.
#include "network/fourier_features.h"

#include <cmath>
#include <numbers>

namespace nmc::network {

Eigen::VectorXd frame_times(Eigen::Index count) {
  if (count <= 1) return Eigen::VectorXd::Zero(count);
  // LinSpaced may round differently on different processors; a quotient does not.
  Eigen::VectorXd times(count);
  for (Eigen::Index n = 0; n < count; ++n) times[n] = static_cast<double>(n) / static_cast<double>(count - 1);
  return times;
}

Eigen::MatrixXf fourier_features(std::span<const int> half_cycles, const Eigen::VectorXd& times) {
  const auto count = static_cast<Eigen::Index>(half_cycles.size());
  Eigen::MatrixXf features(times.size(), 2 * count + 1);
  features.col(0) = times.cast<float>();
  for (Eigen::Index k = 0; k < count; ++k) {
    for (Eigen::Index n = 0; n < times.size(); ++n) {
      // The period is 2 in units of pi: reducing first keeps the phase exact for large frequencies.
      const double phase = std::numbers::pi * std::fmod(half_cycles[static_cast<std::size_t>(k)] * times[n], 2.0);
      features(n, 2 * k + 1) = static_cast<float>(std::sin(phase));
      features(n, 2 * k + 2) = static_cast<float>(std::cos(phase));
    }
  }
  return features;
}

}  // namespace nmc::network
