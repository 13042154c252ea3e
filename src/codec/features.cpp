#include "codec/features.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "codec/reference_codec.h"

namespace nmc::codec {

Eigen::MatrixXd window_features(Basis basis, std::uint32_t window_length, Eigen::Index count, Eigen::Index samples) {
  nmc_clip clip{};
  clip.basis = static_cast<std::uint8_t>(basis);
  nmc_window window{};
  window.length = window_length;
  Eigen::MatrixXd features(count, samples);
  std::vector<double> column(static_cast<std::size_t>(count) + 1);
  for (Eigen::Index n = 0; n < samples; ++n) {
    nmc_features(&clip, &window, static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(count), column.data());
    for (Eigen::Index j = 0; j < count; ++j) features(j, n) = column[static_cast<std::size_t>(j) + 1];
  }
  return features;
}

Eigen::Index feature_limit(Basis, std::uint32_t window_length) { return static_cast<Eigen::Index>(window_length) - 1; }

Eigen::MatrixXd anchor_shares(Basis basis, std::uint32_t window_length, Eigen::Index samples) {
  Eigen::MatrixXd shares(2, samples);
  for (Eigen::Index n = 0; n < samples; ++n) {
    const double u = basis == Basis::cosine ? 0.0 : static_cast<double>(n) / window_length;
    shares(0, n) = 1 - u;
    shares(1, n) = u;
  }
  return shares;
}

double weight_scale(int step_exponent, std::uint32_t window_length) {
  return std::exp2(-step_exponent / 4.0) * std::sqrt(2.0 / window_length);
}

double atom_share(Eigen::Index away, int width) {
  const Eigen::Index half = Eigen::Index{1} << width;
  if (away >= half) return 0.0;
  return 0.5 * (1 + std::cos(std::numbers::pi * static_cast<double>(away) / static_cast<double>(half)));
}

}  // namespace nmc::codec
