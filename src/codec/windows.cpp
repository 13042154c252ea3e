#include "codec/windows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "codec/features.h"

namespace nmc::codec {
namespace {

using Curves = Eigen::MatrixXf;  ///< moving parameters x samples

constexpr float log2_e = 1.442695041f;

/// Moving parameters in slot steps, the jumps taken back.
Curves smooth_curves(const ClipLayout& layout, const ParameterSteps& steps, const std::vector<LevelAtom>& jumps) {
  const Eigen::Index samples = layout.values.cols();
  Curves curves(static_cast<Eigen::Index>(layout.moving.size()), samples);
  for (Eigen::Index i = 0; i < curves.rows(); ++i) {
    const Eigen::Index parameter = layout.moving[static_cast<std::size_t>(i)];
    Eigen::RowVectorXd row = layout.values.row(parameter);
    for (const LevelAtom& jump : jumps) {
      if (jump.parameter != parameter) continue;
      const auto sample = static_cast<Eigen::Index>(jump.sample);
      const Eigen::Index count = jump.width == LevelAtom::jump_width ? samples - sample : 1;
      row.segment(sample, count).array() -= jump.level * steps.anchor(parameter);
    }
    curves.row(i) = (row / steps.slot(parameter)).cast<float>();
  }
  return curves;
}

/// Bits of all these levels, before rounding, about: few for what is likely to become zero.
float weight_bits(const Eigen::MatrixXf& levels) { return log2_e * (1 + 4 * levels.array().square()).log().sum(); }

/// Bits of an anchor pose that differs so much from the one before.
float anchor_bits(const Eigen::VectorXf& levels) {
  constexpr float least = 2;
  return (0.5f * log2_e * (1 + levels.array().square()).log() + least).sum();
}

/// A window with more weights for each of its parameters takes long to play and learns worse than two of half its
/// length. Those as short as `shortest` samples may have as many as they need.
constexpr Eigen::Index most_weights = 10, shortest = 32;

/// Lengths of windows that are tried, in places: from the shortest on, ever more sparsely.
std::vector<Eigen::Index> lengths_up_to(Eigen::Index longest) {
  std::vector<Eigen::Index> lengths;
  for (Eigen::Index length = 1; length <= longest; length += length < 16 ? 1 : length < 32 ? 2 : 8)
    lengths.push_back(length);
  return lengths;
}

/// What windows of a clip cost.
class WindowCosts {
 public:
  WindowCosts(const ClipLayout& layout, const ParameterSteps& steps, const std::vector<LevelAtom>& jumps,
              int step_exponent)
      : curves_(smooth_curves(layout, steps, jumps)),
        anchor_levels_(curves_.rows()),
        weight_levels_(static_cast<float>(std::exp2(step_exponent / 4.0))) {
    for (Eigen::Index i = 0; i < curves_.rows(); ++i) {
      const Eigen::Index parameter = layout.moving[static_cast<std::size_t>(i)];
      anchor_levels_(i) = static_cast<float>(steps.slot(parameter) / steps.anchor(parameter));
    }
  }

  /// Bits of a window's weights and of its second anchor; infinite where it has too many weights. `sines` as
  /// sines_of(length).
  float of(Eigen::Index begin, Eigen::Index length, const Eigen::MatrixXf& sines) const {
    const Eigen::VectorXf change = curves_.col(begin + length) - curves_.col(begin);
    const float anchor = anchor_bits(change.cwiseProduct(anchor_levels_));
    if (length < 2) return anchor;
    const auto inner = static_cast<float>(length - 1);
    const Eigen::RowVectorXf line = Eigen::RowVectorXf::LinSpaced(length - 1, 1, inner) / static_cast<float>(length);
    Eigen::MatrixXf rest = curves_.middleCols(begin + 1, length - 1).colwise() - curves_.col(begin);
    rest.noalias() -= change * line;
    const Eigen::MatrixXf levels = rest * sines * weight_levels_;
    if (length > shortest && (levels.array().abs() > 0.5f).count() > most_weights * levels.rows())
      return std::numeric_limits<float>::infinity();
    return anchor + weight_bits(levels);
  }

  /// The orthonormal sines of a window at its inner samples: samples x features.
  static Eigen::MatrixXf sines_of(Eigen::Index length) {
    if (length < 2) return {};
    const auto window = static_cast<std::uint32_t>(length);
    const Eigen::MatrixXd features = window_features(Basis::sine, window, length - 1, length);
    return (features.rightCols(length - 1).transpose() * weight_scale(0, window)).cast<float>();
  }

 private:
  Curves curves_;
  Eigen::VectorXf anchor_levels_;  ///< of one slot step
  float weight_levels_;
};

/// Where windows may begin and end.
std::vector<Eigen::Index> places_of(Eigen::Index last, Eigen::Index grid) {
  std::vector<Eigen::Index> places;
  for (Eigen::Index n = 0; n < last; n += grid) places.push_back(n);
  places.push_back(last);
  return places;
}

/// Bits of windows: lengths (in places) x the places where they end; infinite where there is no such window.
Eigen::ArrayXXf bits_of(const WindowCosts& costs, const std::vector<Eigen::Index>& places,
                        const std::vector<Eigen::Index>& lengths, int threads) {
  const auto begin_of = [&](Eigen::Index k, Eigen::Index l) {
    return places[static_cast<std::size_t>(k - lengths[static_cast<std::size_t>(l)])];
  };
  const auto count = std::ssize(places);
  Eigen::ArrayXXf bits = Eigen::ArrayXXf::Constant(std::ssize(lengths), count, std::numeric_limits<float>::infinity());
  std::map<Eigen::Index, Eigen::MatrixXf> sines;
  for (const Eigen::Index k : {count - 2, count - 1})  // the last step of the grid may be a shorter one
    for (Eigen::Index l = 0; l < bits.rows() && lengths[static_cast<std::size_t>(l)] <= k; ++l) {
      const Eigen::Index length = places[static_cast<std::size_t>(k)] - begin_of(k, l);
      sines.try_emplace(length, WindowCosts::sines_of(length));
    }
  parallel_for(places.size(), threads, [&](std::size_t end) {
    const auto k = static_cast<Eigen::Index>(end);
    for (Eigen::Index l = 0; l < bits.rows() && lengths[static_cast<std::size_t>(l)] <= k; ++l) {
      const Eigen::Index length = places[end] - begin_of(k, l);
      bits(l, k) = costs.of(begin_of(k, l), length, sines.at(length));
      if (!std::isfinite(bits(l, k))) break;  // longer ones have still more weights
    }
  });
  return bits;
}

}  // namespace

std::vector<std::uint32_t> even_windows(std::size_t samples, std::size_t length) {
  const std::size_t last = samples - 1;
  const std::size_t windows = std::max<std::size_t>(1, (last + length / 2) / length);
  std::vector<std::uint32_t> boundaries;
  for (std::size_t k = 0; k <= windows; ++k) boundaries.push_back(static_cast<std::uint32_t>(k * last / windows));
  return boundaries;
}

std::vector<std::uint32_t> fitted_windows(const ClipLayout& layout, const ParameterSteps& steps,
                                          const std::vector<LevelAtom>& jumps, int step_exponent, int threads) {
  constexpr Eigen::Index usual_places = 100, coarsest_grid = 4, longest_window = 256, most_places = 64;
  const Eigen::Index last = layout.values.cols() - 1;
  const Eigen::Index grid = std::clamp<Eigen::Index>(last / usual_places, 1, coarsest_grid);
  const std::vector<Eigen::Index> places = places_of(last, grid);
  const std::vector<Eigen::Index> lengths = lengths_up_to(std::min(longest_window / grid, most_places));
  const Eigen::ArrayXXf bits = bits_of({layout, steps, jumps, step_exponent}, places, lengths, threads);

  std::vector<double> least(places.size(), std::numeric_limits<double>::infinity());  // bits up to each place
  std::vector<std::size_t> from(places.size(), 0);
  least[0] = 0;
  for (std::size_t k = 1; k < places.size(); ++k)
    for (std::size_t l = 0; l < lengths.size() && static_cast<std::size_t>(lengths[l]) <= k; ++l) {
      const std::size_t begin = k - static_cast<std::size_t>(lengths[l]);
      const double sum =
          least[begin] + static_cast<double>(bits(static_cast<Eigen::Index>(l), static_cast<Eigen::Index>(k)));
      if (sum >= least[k]) continue;
      least[k] = sum;
      from[k] = begin;
    }
  std::vector<std::uint32_t> boundaries{static_cast<std::uint32_t>(last)};
  for (std::size_t k = places.size() - 1; k > 0; k = from[k])
    boundaries.push_back(static_cast<std::uint32_t>(places[from[k]]));
  std::reverse(boundaries.begin(), boundaries.end());
  return boundaries;
}

}  // namespace nmc::codec
