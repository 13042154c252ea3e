#include "codec/level_prices.h"

#include <algorithm>

namespace nmc::codec {
namespace {

/// Adds to each number of a row those so many columns before and after it.
template <typename Row, typename From>
void add_neighbours(Row&& row, const From& from, Eigen::Index distance, float share) {
  const Eigen::Index count = row.size() - distance;
  if (count <= 0) return;
  row.head(count) += share * from.tail(count);
  row.tail(count) += share * from.head(count);
}

/// The mean size around each level of window w.
Weights mean_around(const std::vector<Weights>& sizes, std::size_t w, const ClipLayout& layout) {
  constexpr float beside = 2;
  const Weights& size = sizes[w];
  Weights sum = Weights::Zero(size.rows(), size.cols());
  float common = 6;
  for (const std::size_t other : {w - 1, w + 1}) {
    if (other >= sizes.size()) continue;
    const Eigen::Index both = std::min(size.cols(), sizes[other].cols());
    sum.leftCols(both) += beside * sizes[other].leftCols(both);
    common += beside;
  }
  const auto target_of = [&](Eigen::Index i) {
    return layout.parameters[static_cast<std::size_t>(layout.moving[static_cast<std::size_t>(i)])].target;
  };
  for (Eigen::Index i = 0; i < size.rows(); ++i) {
    float shares = common;
    add_neighbours(sum.row(i), size.row(i), 1, 2);
    add_neighbours(sum.row(i), size.row(i), 2, 1);
    for (Eigen::Index k = std::max<Eigen::Index>(0, i - 3); k < std::min(size.rows(), i + 4); ++k) {
      if (k == i || target_of(k) != target_of(i)) continue;
      sum.row(i) += size.row(k);
      add_neighbours(sum.row(i), size.row(k), 1, 0.5f);
      shares += 2;
    }
    sum.row(i) /= shares;
  }
  return sum;
}

/// Bits by which one more step lengthens the code of a geometric distribution with this mean, and a little for the
/// sign and for what the mean does not tell; in units of what the smooth rate says.
Weights prices_of(const Weights& mean) {
  constexpr float least_mean = 0.02f, least_bits = 0.5f, usual_bits = 2, log2_e = 1.442695041f;
  return ((least_bits + (1 + (mean.array() + least_mean).inverse()).log() * log2_e) / usual_bits).matrix();
}

}  // namespace

std::vector<Weights> level_prices(const std::vector<Weights>& levels, const ClipLayout& layout) {
  constexpr float largest = 8;  // among still larger levels a step costs no less
  std::vector<Weights> sizes, prices;
  for (const Weights& level : levels) sizes.push_back(level.array().round().abs().min(largest).matrix());
  for (std::size_t w = 0; w < sizes.size(); ++w) prices.push_back(prices_of(mean_around(sizes, w, layout)));
  return prices;
}

}  // namespace nmc::codec
