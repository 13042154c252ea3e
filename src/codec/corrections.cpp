#include "codec/corrections.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace nmc::codec {
namespace {

constexpr int widest = 6;  ///< half-widths of up to 2^6 samples
constexpr double pi = 3.14159265358979323846;

struct Candidate {
  LevelAtom atom;
  double gain = 0;  ///< fall of the excess per bit
};

class Corrector {
 public:
  Corrector(LevelClip& clip, const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted,
            double bound)
      : clip_(clip),
        layout_(layout),
        steps_(steps),
        map_(map),
        wanted_(wanted),
        bound_(bound),
        samples_(layout.values.cols()),
        moving_(static_cast<Eigen::Index>(layout.moving.size())) {}

  bool run(std::size_t most_atoms) {
    for (int round = 0; round < 8; ++round) {
      const Eigen::MatrixXd now = values_of_levels(clip_, steps_, samples_);
      error_ = map_.positions(now) - wanted_;
      if (largest().second <= bound_) return true;
      map_.linearise(0.5 * (now + layout_.values));
      // Linear predictions are off by a little: aim lower each time.
      aim_ = bound_ * (0.995 - 0.02 * round);
      while (largest().second > aim_) {
        if (clip_.atoms.size() >= most_atoms || !add_atom()) return false;
      }
      sort_atoms();
    }
    return false;
  }

 private:
  double square_error(Eigen::Index row, Eigen::Index n) const {
    const Eigen::Index points = map_.point_count();
    if (row < points) return error_.col(n).segment(3 * row, 3).matrix().squaredNorm();
    const double e = error_(2 * points + row, n);
    return e * e;
  }

  Eigen::Index point_rows() const { return map_.error_rows() - 2 * map_.point_count(); }

  std::pair<Eigen::Index, double> largest() {
    worst_point_ = 0;
    double most = -1;
    Eigen::Index at = 0;
    const Eigen::Index points = map_.point_count();
    Eigen::Array<float, 1, Eigen::Dynamic> square(samples_);
    for (Eigen::Index q = 0; q < point_rows(); ++q) {
      if (q < points)
        square = error_.middleRows(3 * q, 3).square().colwise().sum();
      else
        square = error_.row(2 * points + q).square();
      Eigen::Index n = 0;
      const double value = square.maxCoeff(&n);
      if (!(value <= most)) {
        most = value;
        at = n;
        worst_point_ = q;
      }
    }
    return {at, std::sqrt(most)};
  }

  /// A smooth stand-in for the largest error at one sample after adding amount * effect: the sum of eighth powers, in
  /// units of the aim, over `rows` (points, then morph targets) alone.
  double excess(const std::vector<Eigen::Index>& rows, const Rows& effect, Eigen::Index column, Eigen::Index n,
                float amount) const {
    const Eigen::Index points = map_.point_count();
    const float unit = static_cast<float>(1 / (aim_ * aim_));
    float sum = 0;
    for (const Eigen::Index q : rows) {
      float square = 0;
      const Eigen::Index first = q < points ? 3 * q : 2 * points + q, count = q < points ? 3 : 1;
      for (Eigen::Index a = first; a < first + count; ++a) {
        const float e = error_(a, n) + amount * effect(a, column);
        square += e * e;
      }
      square *= unit;
      square *= square;
      sum += square * square;
    }
    return sum;
  }

  /// The points that an effect moves at all, at one sample.
  std::vector<Eigen::Index> moved(const Rows& effect, Eigen::Index column) const {
    const Eigen::Index points = map_.point_count();
    std::vector<Eigen::Index> rows;
    for (Eigen::Index q = 0; q < point_rows(); ++q) {
      const Eigen::Index first = q < points ? 3 * q : 2 * points + q, count = q < points ? 3 : 1;
      if (effect.col(column).segment(first, count).abs().maxCoeff() > 0) rows.push_back(q);
    }
    return rows;
  }

  static double window(Eigen::Index away, int width) {
    const Eigen::Index half = Eigen::Index{1} << width;
    return away >= half ? 0.0 : 0.5 * (1 + std::cos(pi * static_cast<double>(away) / static_cast<double>(half)));
  }

  /// The moving parameters that could take most of the worst point's error away: by |J^T e| a step.
  std::vector<Eigen::Index> promising(Eigen::Index n, std::size_t most) {
    const Eigen::Index points = map_.point_count();
    Rows weight = Rows::Zero(error_.rows(), 1), gradient;
    const Eigen::Index first = worst_point_ < points ? 3 * worst_point_ : 2 * points + worst_point_,
                       count = worst_point_ < points ? 3 : 1;
    weight.col(0).segment(first, count) = error_.col(n).segment(first, count);
    map_.gradient(weight, gradient, n);
    std::vector<std::pair<double, Eigen::Index>> ranked;
    for (Eigen::Index i = 0; i < moving_; ++i)
      if (const double pull = std::abs(static_cast<double>(gradient(i, 0))) * step_of(i); pull > 0)
        ranked.push_back({-pull, i});
    std::sort(ranked.begin(), ranked.end());
    std::vector<Eigen::Index> best;
    for (std::size_t k = 0; k < std::min(most, ranked.size()); ++k) best.push_back(ranked[k].second);
    return best;
  }

  Eigen::Index parameter(Eigen::Index moving) const { return layout_.moving[static_cast<std::size_t>(moving)]; }
  double step_of(Eigen::Index moving) const { return steps_.anchor(parameter(moving)); }

  /// The level that takes most of the worst point's error away at sample n, and the smaller one that brings it to the
  /// aim.
  std::vector<std::int32_t> levels_for(const Rows& effect, Eigen::Index column, Eigen::Index n, double step) const {
    const Eigen::Index points = map_.point_count();
    double ee = 0, ej = 0, jj = 0;
    for (Eigen::Index a = 0; a < (worst_point_ < points ? 3 : 1); ++a) {
      const Eigen::Index r = worst_point_ < points ? 3 * worst_point_ + a : 2 * points + worst_point_;
      const double e = error_(r, n), j = effect(r, column);
      ee += e * e;
      ej += e * j;
      jj += j * j;
    }
    if (jj <= 0) return {};
    const double full = -ej / jj;
    std::vector<std::int32_t> levels;
    const auto add = [&](double amount) {
      const double exact = amount / step;
      const auto level = static_cast<std::int32_t>(exact < 0 ? std::floor(exact) : std::ceil(exact));
      if (level != 0 && std::abs(exact) < 1e6 && std::find(levels.begin(), levels.end(), level) == levels.end())
        levels.push_back(level);
    };
    const double inside = ej * ej - jj * (ee - aim_ * aim_ * 0.98);
    if (inside > 0) add((-ej + (ej < 0 ? -1.0 : 1.0) * std::sqrt(inside)) / jj);
    add(0.7 * full);
    add(full);
    return levels;
  }

  bool try_parameter(Eigen::Index moving, Eigen::Index n, std::optional<Candidate>& best, Rows& best_effect,
                     Eigen::Index& best_from) {
    const Eigen::Index reach = (Eigen::Index{1} << widest) - 1;
    const Eigen::Index from = std::max<Eigen::Index>(0, n - reach), end = std::min(samples_, n + reach + 1);
    Rows delta = Rows::Zero(moving_, end - from), effect;
    delta.row(moving).setOnes();
    map_.errors(delta, effect, from);
    const double step = step_of(moving);
    const std::vector<Eigen::Index> rows = moved(effect, n - from);
    std::vector<double> before(static_cast<std::size_t>(end - from));
    for (Eigen::Index m = from; m < end; ++m)
      before[static_cast<std::size_t>(m - from)] = excess(rows, effect, m - from, m, 0);
    bool found = false;
    for (const std::int32_t level : levels_for(effect, n - from, n, step)) {
      for (int width = 0; width <= widest; ++width) {
        double fall = 0;
        const Eigen::Index half = (Eigen::Index{1} << width) - 1;
        for (Eigen::Index m = std::max(from, n - half); m < std::min(end, n + half + 1); ++m)
          fall += before[static_cast<std::size_t>(m - from)] -
                  excess(rows, effect, m - from, m, static_cast<float>(level * step * window(std::abs(m - n), width)));
        const double gain = fall / (18 + 2 * std::log2(std::abs(level) + 1));
        if (gain > 0 && (!best || gain > best->gain)) {
          best = Candidate{{static_cast<std::uint32_t>(n), static_cast<int>(parameter(moving)), width, level}, gain};
          best_effect = effect;
          best_from = from;
          found = true;
        }
      }
    }
    return found;
  }

  bool add_atom() {
    const Eigen::Index n = largest().first;
    std::optional<Candidate> best;
    Rows effect;
    Eigen::Index from = 0;
    for (const std::size_t most : {std::size_t{4}, std::size_t{24}}) {
      for (const Eigen::Index moving : promising(n, most)) try_parameter(moving, n, best, effect, from);
      if (best) break;
    }
    if (!best) return rewrite_sample(n);
    const LevelAtom& atom = best->atom;
    const double step = steps_.anchor(atom.parameter);
    for (Eigen::Index m = 0; m < effect.cols(); ++m) {
      const double share = window(std::abs(from + m - static_cast<Eigen::Index>(atom.sample)), atom.width);
      if (share > 0) error_.col(from + m) += static_cast<float>(atom.level * step * share) * effect.col(m);
    }
    // A second atom at the same place is added to the first.
    for (LevelAtom& other : clip_.atoms)
      if (other.sample == atom.sample && other.parameter == atom.parameter && other.width == atom.width) {
        other.level += atom.level;
        return true;
      }
    clip_.atoms.push_back(atom);
    return true;
  }

  /// Where no single step helps: every parameter of the sample is brought to its true value.
  bool rewrite_sample(Eigen::Index n) {
    bool changed = false;
    const Eigen::MatrixXd now = values_of_levels(clip_, steps_, samples_);
    Rows delta = Rows::Zero(moving_, 1), effect;
    for (Eigen::Index i = 0; i < moving_; ++i) {
      const auto level =
          static_cast<std::int32_t>(std::lround((layout_.values(parameter(i), n) - now(parameter(i), n)) / step_of(i)));
      if (level == 0) continue;
      clip_.atoms.push_back({static_cast<std::uint32_t>(n), static_cast<int>(parameter(i)), 0, level});
      delta(i, 0) = static_cast<float>(level * step_of(i));
      changed = true;
    }
    if (!changed) return false;
    map_.errors(delta, effect, n);
    error_.col(n) += effect.col(0);
    return true;
  }

  void sort_atoms() {
    std::erase_if(clip_.atoms, [](const LevelAtom& a) { return a.level == 0; });
    std::stable_sort(clip_.atoms.begin(), clip_.atoms.end(),
                     [](const LevelAtom& a, const LevelAtom& b) { return a.sample < b.sample; });
  }

  LevelClip& clip_;
  const ClipLayout& layout_;
  const ParameterSteps& steps_;
  MotionMap& map_;
  const Rows& wanted_;
  double bound_, aim_ = 0;
  Eigen::Index samples_, moving_;
  Eigen::Index worst_point_ = 0;
  Rows error_;
};

}  // namespace

bool correct(LevelClip& clip, const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted,
             double bound, std::size_t most_atoms) {
  const bool reached = Corrector(clip, layout, steps, map, wanted, bound).run(most_atoms);
  std::stable_sort(clip.atoms.begin(), clip.atoms.end(),
                   [](const LevelAtom& a, const LevelAtom& b) { return a.sample < b.sample; });
  return reached;
}

}  // namespace nmc::codec
