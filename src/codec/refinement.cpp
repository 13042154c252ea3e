#include "codec/refinement.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "codec/effects.h"
#include "codec/features.h"

namespace nmc::codec {
namespace {

/// A window's levels as a matrix, and its samples' errors.
struct DenseWindow {
  Eigen::Index first = 0, samples = 0;
  BlockRange blocks;                       ///< that the samples lie in
  Eigen::MatrixXf features;                ///< samples of the blocks x features; zero outside of the window
  float largest_feature = 0;               ///< of the numbers
  Eigen::VectorXf step;                    ///< per moving parameter
  Eigen::MatrixXi levels;                  ///< moving parameters x features
  LaneRows error;                          ///< of the blocks; zero outside of the window
  std::map<Eigen::Index, Effect> effects;  ///< those asked for, by moving parameter

  /// `amount` times a feature, one column per block.
  LaneRows shares(Eigen::Index feature, float amount) const {
    return amount * Eigen::Map<const LaneRows>(features.col(feature).data(), lanes, blocks.count);
  }
};

/// About how many bits a level costs: the shape of the coder's numbers with usual contexts.
double bits_of(int level) { return level == 0 ? 0.4 : 4.5 + 2.0 * std::log2(static_cast<double>(std::abs(level))); }

class Refiner {
 public:
  Refiner(LevelClip& clip, const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted,
          double bound, int threads)
      : clip_(clip),
        layout_(layout),
        steps_(steps),
        map_(map),
        wanted_(wanted),
        bound_(bound),
        threads_(threads),
        samples_(layout.values.cols()),
        moving_(static_cast<Eigen::Index>(layout.moving.size())) {
    std::vector<Eigen::Index> moving_of(layout.parameters.size(), -1);
    for (Eigen::Index i = 0; i < moving_; ++i) moving_of[static_cast<std::size_t>(parameter(i))] = i;
    for (std::size_t w = 0; w < clip.windows.size(); ++w) {
      const LevelWindow& from = clip.windows[w];
      DenseWindow window;
      window.first = static_cast<Eigen::Index>(from.begin);
      window.samples = w + 1 == clip.windows.size() ? samples_ - window.first : static_cast<Eigen::Index>(from.length);
      int most = 0;
      for (const LevelWeight& weight : from.weights) most = std::max(most, weight.feature);
      window.blocks = BlockRange::of(window.first, window.samples);
      window.features.setZero(window.blocks.count * lanes, most);
      window.features.middleRows(window.first - window.blocks.first * lanes, window.samples) =
          window_features(clip.basis, from.length, most, window.samples).cast<float>().transpose();
      if (most > 0) window.largest_feature = window.features.cwiseAbs().maxCoeff();
      const double scale = weight_scale(clip.step_exponent, from.length);
      window.step.resize(moving_);
      for (Eigen::Index i = 0; i < moving_; ++i) window.step(i) = static_cast<float>(steps.slot(parameter(i)) * scale);
      window.levels.setZero(moving_, most);
      for (const LevelWeight& weight : from.weights)
        window.levels(moving_of[static_cast<std::size_t>(weight.parameter)], weight.feature - 1) = weight.level;
      windows_.push_back(std::move(window));
    }
    start();
  }

  void repair() {
    constexpr int halves = 2, sweeps = 6;
    for (int half = 0; half < halves; ++half) {
      if (half > 0) {
        store();
        start();
      }
      // Windows share no samples.
      parallel_for(windows_.size(), threads_, [&](std::size_t w) {
        DenseWindow& window = windows_[w];
        for (int sweep = 0; sweep < sweeps; ++sweep)
          if (!repair_once(window)) break;
        window.effects.clear();
      });
    }
    store();
  }

  void prune() {
    if (!std::all_of(windows_.begin(), windows_.end(), [&](const DenseWindow& window) { return is_within(window); }))
      return;
    parallel_for(windows_.size(), threads_, [&](std::size_t w) { prune_window(windows_[w]); });
    store();
  }

 private:
  Eigen::Index parameter(Eigen::Index i) const { return layout_.moving[static_cast<std::size_t>(i)]; }

  void start() {
    Eigen::MatrixXd values = values_of_levels(clip_, steps_, samples_, threads_);
    parallel_for(windows_.size(), threads_, [&](std::size_t w) {
      DenseWindow& window = windows_[w];
      Rows error = Rows::Zero(map_.error_rows(), window.blocks.count * lanes);
      error.middleCols(window.first - window.blocks.first * lanes, window.samples) =
          map_.positions(values.middleCols(window.first, window.samples)) -
          wanted_.middleCols(window.first, window.samples);
      window.error = in_blocks(error);
    });
    values = 0.5 * (values + layout_.values);
    map_.linearise(values, threads_);
  }

  Eigen::Index error_column(Eigen::Index block, Eigen::Index q) const {
    return block * map_.error_rows() + map_.first_row(q);
  }

  /// The squared error of one point in one block of a window, in units of the bound.
  Lanes square_of(const DenseWindow& window, Eigen::Index block, Eigen::Index q) const {
    return unit() * window.error.middleCols(error_column(block, q), map_.row_count(q)).square().rowwise().sum();
  }

  bool is_within(const DenseWindow& window) const {
    for (Eigen::Index b = 0; b < window.blocks.count; ++b)
      for (Eigen::Index q = 0; q < map_.seen_count(); ++q)
        if (square_of(window, b, q).maxCoeff() > 1) return false;
    return true;
  }

  float unit() const { return static_cast<float>(1 / (bound_ * bound_)); }

  /// The effect of a parameter on the window's samples; valid until the next call.
  const Effect& effect_of(DenseWindow& window, Eigen::Index i) const {
    if (const auto known = window.effects.find(i); known != window.effects.end()) return known->second;
    if (static_cast<Eigen::Index>(window.effects.size()) * window.error.size() >= most_numbers) window.effects.clear();
    return window.effects.emplace(i, map_.effect(i, window.blocks)).first->second;
  }

  /// Where one step of any of a parameter's levels could bring points above the bound.
  std::vector<Parabola> endangered_by(const Effect& effect, const DenseWindow& window, Eigen::Index i) const {
    return endangered(map_, effect, window.step(i) * window.largest_feature, window.error, static_cast<float>(bound_));
  }

  /// What squared errors above the bound weigh after adding these shares of an effect.
  static double excess_after(const std::vector<Parabola>& near, const LaneRows& shares) {
    double sum = 0;
    for (const Parabola& part : near)
      sum += static_cast<double>((part.at(shares.col(part.block)) - 1.0f).max(0.0f).square().sum());
    return sum;
  }

  static bool goes_above(const std::vector<Parabola>& near, const LaneRows& shares) {
    return std::any_of(near.begin(), near.end(),
                       [&](const Parabola& part) { return part.at(shares.col(part.block)).maxCoeff() > 1.0f; });
  }

  /// The slope of the window's excess by every moving parameter at every sample of its blocks; empty where nothing is
  /// above the bound.
  Eigen::MatrixXf slopes(const DenseWindow& window) const {
    Rows weight, gradient;
    for (Eigen::Index b = 0; b < window.blocks.count; ++b)
      for (Eigen::Index q = 0; q < map_.seen_count(); ++q) {
        const Lanes square = square_of(window, b, q);
        if (square.maxCoeff() <= 1) continue;
        if (weight.size() == 0) weight.setZero(map_.error_rows(), window.blocks.count * lanes);
        const Lanes pull = 4 * unit() * (square - 1.0f).max(0.0f);
        for (Eigen::Index a = 0; a < map_.row_count(q); ++a)
          weight.row(map_.first_row(q) + a).segment<lanes>(b * lanes) =
              (pull * window.error.col(error_column(b, q) + a)).transpose();
      }
    if (weight.size() == 0) return {};
    map_.gradient(weight, gradient, window.blocks.first * lanes);
    return gradient.matrix();
  }

  void prune_window(DenseWindow& window) {
    for (Eigen::Index i = 0; i < moving_; ++i) {
      if ((window.levels.row(i).array() == 0).all()) continue;
      const Effect effect = map_.effect(i, window.blocks);
      std::vector<Parabola> near = endangered_by(effect, window, i);
      for (Eigen::Index j = window.levels.cols(); j-- > 0;) {
        const int level = window.levels(i, j);
        if (level == 0) continue;
        const LaneRows shares = window.shares(j, level > 0 ? -window.step(i) : window.step(i));
        if (goes_above(near, shares)) continue;
        window.levels(i, j) -= level > 0 ? 1 : -1;
        add_effect(map_, effect, shares, window.error);
        near = endangered_by(effect, window, i);
      }
    }
  }

  struct Move {
    Eigen::Index parameter = 0;
    double promise = 0;
  };

  /// One pass over the window's parameters that promise most. False where no move helped.
  bool repair_once(DenseWindow& window) {
    const Eigen::MatrixXf gradient = slopes(window);
    if (gradient.size() == 0) return false;
    const Eigen::MatrixXf slope = window.step.asDiagonal() * gradient * window.features;
    std::vector<Move> moves;
    for (Eigen::Index i = 0; i < moving_; ++i) {
      double most = 0;
      for (Eigen::Index j = 0; j < window.levels.cols(); ++j)
        if (window.levels(i, j) != 0) most = std::max(most, std::abs(static_cast<double>(slope(i, j))));
      if (most > 0) moves.push_back({i, most});
    }
    std::stable_sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) { return a.promise > b.promise; });
    const std::size_t most = std::max<std::size_t>(24, moves.size() / 4);
    if (moves.size() > most) moves.resize(most);
    bool has_moved = false;
    for (const Move& move : moves) has_moved |= try_parameter(window, move.parameter, slope.row(move.parameter));
    return has_moved;
  }

  /// The best single step among the parameter's features.
  bool try_parameter(DenseWindow& window, Eigen::Index i, const Eigen::RowVectorXf& slope) {
    constexpr std::size_t most = 4;
    std::vector<Eigen::Index> order;
    for (Eigen::Index j = 0; j < window.levels.cols(); ++j)
      if (window.levels(i, j) != 0 && slope(j) != 0) order.push_back(j);
    std::stable_sort(order.begin(), order.end(),
                     [&](Eigen::Index a, Eigen::Index b) { return std::abs(slope(a)) > std::abs(slope(b)); });
    if (order.size() > most) order.resize(most);
    const Effect& effect = effect_of(window, i);
    const std::vector<Parabola> near = endangered_by(effect, window, i);
    const double before = excess_after(near, LaneRows::Zero(lanes, window.blocks.count));
    double best_gain = 0;
    Eigen::Index best = -1;
    for (const Eigen::Index j : order) {
      const int direction = slope(j) > 0 ? -1 : 1;
      const double fall = before - excess_after(near, window.shares(j, window.step(i) * static_cast<float>(direction)));
      const double bits = bits_of(window.levels(i, j) + direction) - bits_of(window.levels(i, j));
      const double gain = fall / std::max(1.0, 4 + bits);
      if (fall > 1e-4 * before && gain > best_gain) {
        best_gain = gain;
        best = j;
      }
    }
    if (best < 0) return false;
    const int direction = slope(best) > 0 ? -1 : 1;
    window.levels(i, best) += direction;
    add_effect(map_, effect, window.shares(best, window.step(i) * static_cast<float>(direction)), window.error);
    return true;
  }

  void store() {
    for (std::size_t w = 0; w < windows_.size(); ++w) {
      std::vector<LevelWeight>& weights = clip_.windows[w].weights;
      weights.clear();
      for (Eigen::Index i = 0; i < moving_; ++i)
        for (Eigen::Index j = 0; j < windows_[w].levels.cols(); ++j)
          if (const int level = windows_[w].levels(i, j); level != 0)
            weights.push_back({static_cast<int>(j) + 1, static_cast<int>(parameter(i)), level});
    }
  }

  LevelClip& clip_;
  const ClipLayout& layout_;
  const ParameterSteps& steps_;
  MotionMap& map_;
  const Rows& wanted_;
  double bound_;
  int threads_;
  Eigen::Index samples_, moving_;
  std::vector<DenseWindow> windows_;
  static constexpr Eigen::Index most_numbers = 1 << 22;  ///< of a window's effects, kept at a time
};

}  // namespace

void repair(LevelClip& clip, const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted,
            double bound, int threads) {
  if (!layout.moving.empty()) Refiner(clip, layout, steps, map, wanted, bound, threads).repair();
}

void prune(LevelClip& clip, const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted,
           double bound, int threads) {
  if (!layout.moving.empty()) Refiner(clip, layout, steps, map, wanted, bound, threads).prune();
}

}  // namespace nmc::codec
