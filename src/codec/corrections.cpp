#include "codec/corrections.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "codec/atoms.h"
#include "codec/effects.h"
#include "codec/features.h"

namespace nmc::codec {
namespace {

constexpr int widest = 6;  ///< half-widths of up to 2^6 samples

struct FoundAtom {
  LevelAtom atom;
  double gain = 0;  ///< fall of the excess per bit
  Effect effect;    ///< of one unit of the atom's parameter
};

}  // namespace

class Corrections::Corrector {
 public:
  Corrector(const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted, double bound,
            int threads)
      : layout_(layout),
        steps_(steps),
        map_(map),
        wanted_(wanted),
        bound_(bound),
        aim_(aimed_share * bound),
        threads_(threads),
        samples_(layout.values.cols()),
        blocks_(blocks_of(samples_)),
        moving_(static_cast<Eigen::Index>(layout.moving.size())),
        asked_(SampleRow::Ones(blocks_ * lanes)),
        strictness_(asked_),
        worst_square_(asked_.size()),
        worst_point_(asked_.size()),
        error_(LaneRows::Zero(lanes, blocks_ * map.error_rows())),
        has_old_error_(static_cast<std::size_t>(blocks_), 1),
        has_old_map_(static_cast<std::size_t>(blocks_), 1) {
    map_.resize(samples_);
  }

  bool run(LevelClip& clip, const SampleRow& strictness, std::size_t most_atoms) {
    clip_ = &clip;
    ask_for(strictness);
    for (int round = 0; round < rounds; ++round) {
      look_again();
      if (within_bound()) return true;
      renew_map();
      restored_.assign(static_cast<std::size_t>(samples_), 0);
      if (round > 0) aim_lower();
      hand_out_atoms();
      if (round >= linear_rounds) restore_all();
      const bool reached = reach_aim(most_atoms);
      collect_atoms();
      if (!reached) return false;
    }
    return false;
  }

 private:
  static constexpr int rounds = 8, linear_rounds = 2, most_restorations = 3;
  static constexpr double aimed_share = 0.995;

  /// Samples that one thread corrects while others correct those of every other stretch: an atom at one of them changes
  /// nothing beyond the next stretch.
  struct Stretch {
    Eigen::Index first = 0, end = 0;
    std::vector<LevelAtom> atoms;  ///< at its samples
    std::size_t changes = 0;
    bool is_stuck = false;  ///< nothing brings its worst point nearer to the bound
  };
  static constexpr Eigen::Index stretch_samples = 256;
  static_assert(stretch_samples >= Eigen::Index{2} << widest);

  /// The error rows of one sample.
  auto errors_of(Eigen::Index n) {
    return error_.row(n % lanes).segment((n / lanes) * map_.error_rows(), map_.error_rows());
  }
  auto errors_of(Eigen::Index n) const {
    return error_.row(n % lanes).segment((n / lanes) * map_.error_rows(), map_.error_rows());
  }

  auto errors_of(const BlockRange& blocks) {
    return error_.middleCols(blocks.first * map_.error_rows(), blocks.count * map_.error_rows());
  }
  auto errors_of(const BlockRange& blocks) const {
    return error_.middleCols(blocks.first * map_.error_rows(), blocks.count * map_.error_rows());
  }

  void ask_for(const SampleRow& strictness) {
    asked_.head(samples_) = strictness;
    for (Eigen::Index block = 0; block < blocks_; ++block)
      if ((strict(block) != asked_.segment<lanes>(block * lanes).transpose()).any())
        has_old_error_[static_cast<std::size_t>(block)] = 1;
    strictness_ = asked_;
  }

  /// The samples of one block.
  Eigen::Index samples_of(Eigen::Index block) const { return std::min(lanes, samples_ - block * lanes); }

  /// What the levels mean and the errors that this leaves, where it is not known.
  void look_again() {
    Eigen::MatrixXd values = values_of_levels(*clip_, steps_, samples_, threads_);
    for (Eigen::Index block = 0; block < blocks_; ++block) {
      const auto columns = Eigen::seqN(block * lanes, samples_of(block));
      if (values_.size() == 0 || values(Eigen::all, columns) != values_(Eigen::all, columns))
        has_old_error_[static_cast<std::size_t>(block)] = 1;
    }
    values_ = std::move(values);
    parallel_for(has_old_error_.size(), threads_, [&](std::size_t b) {
      if (!has_old_error_[b]) return;
      const auto block = static_cast<Eigen::Index>(b);
      const Eigen::Index first = block * lanes, count = samples_of(block);
      const Rows error =
          (map_.positions(values_.middleCols(first, count)) - wanted_.middleCols(first, count)).rowwise() *
          strictness_.segment(first, count);
      errors_of({block, 1}) = in_blocks(error);
      measure({block, 1});
      has_old_error_[b] = 0;
      has_old_map_[b] = 1;
    });
  }

  /// By what the caller asks for.
  bool within_bound() const {
    const SampleRow square = worst_square_ * (asked_ / strictness_).square();
    return static_cast<double>(square.maxCoeff()) <= bound_ * bound_;
  }

  void renew_map() {
    parallel_for(has_old_map_.size(), threads_, [&](std::size_t b) {
      if (!has_old_map_[b]) return;
      const Eigen::Index first = static_cast<Eigen::Index>(b) * lanes, count = samples_of(static_cast<Eigen::Index>(b));
      map_.linearise_block(0.5 * (values_.middleCols(first, count) + layout_.values.middleCols(first, count)),
                           static_cast<Eigen::Index>(b));
      has_old_map_[b] = 0;
    });
  }

  void hand_out_atoms() {
    stretches_.clear();
    for (Eigen::Index first = 0; first < samples_; first += stretch_samples)
      stretches_.push_back({first, std::min(samples_, first + stretch_samples), {}});
    for (const LevelAtom& atom : clip_->atoms) stretch_at(static_cast<Eigen::Index>(atom.sample)).atoms.push_back(atom);
  }

  void collect_atoms() {
    clip_->atoms.clear();
    for (const Stretch& stretch : stretches_)
      clip_->atoms.insert(clip_->atoms.end(), stretch.atoms.begin(), stretch.atoms.end());
    tidy_atoms(clip_->atoms);
  }

  Stretch& stretch_at(Eigen::Index sample) { return stretches_[static_cast<std::size_t>(sample / stretch_samples)]; }

  /// Adds atoms until every sample is within the aim by the linear map. False where that takes too many, or none help.
  bool reach_aim(std::size_t most_atoms) {
    while (static_cast<double>(worst_square_.maxCoeff()) > aim_ * aim_) {
      for (const std::size_t parity : {std::size_t{0}, std::size_t{1}})
        parallel_for((stretches_.size() + 1 - parity) / 2, threads_,
                     [&](std::size_t k) { add_atoms(stretches_[2 * k + parity]); });
      std::size_t atoms = 0, changes = 0;
      for (const Stretch& stretch : stretches_) {
        if (stretch.is_stuck) return false;
        atoms += stretch.atoms.size();
        changes += stretch.changes;
      }
      if (atoms > most_atoms || changes > 2 * most_atoms) return false;
    }
    return true;
  }

  /// Some of the atoms that a stretch needs.
  void add_atoms(Stretch& stretch) {
    constexpr int at_once = 16;
    for (int k = 0; k < at_once; ++k) {
      Eigen::Index n = 0;
      const double most = worst_square_.segment(stretch.first, stretch.end - stretch.first).maxCoeff(&n);
      if (most <= aim_ * aim_) return;
      ++stretch.changes;
      stretch.is_stuck = !add_atom(stretch.first + n);
      if (stretch.is_stuck) return;
    }
  }

  /// Linear predictions are off by a little: where they were, more is asked for.
  void aim_lower() {
    constexpr float more = 1.02f;
    for (Eigen::Index block = 0; block < blocks_; ++block) {
      bool is_raised = false;
      for (Eigen::Index n = block * lanes; n < block * lanes + samples_of(block); ++n) {
        const double asked = asked_(n) / strictness_(n);
        if (static_cast<double>(worst_square_(n)) * asked * asked <= bound_ * bound_) continue;
        strictness_(n) *= more;
        errors_of(n) *= more;
        is_raised = true;
      }
      if (is_raised) measure({block, 1});
    }
  }

  /// Finds the largest error of each sample of some blocks anew.
  void measure(const BlockRange& blocks) {
    for (Eigen::Index block = blocks.first; block < blocks.first + blocks.count; ++block) {
      Lanes most = Lanes::Constant(-1.0f);
      Eigen::Array<int, lanes, 1> point = Eigen::Array<int, lanes, 1>::Zero();
      for (Eigen::Index q = 0; q < map_.seen_count(); ++q) {
        const Eigen::Index column = block * map_.error_rows() + map_.first_row(q);
        const Lanes square = error_.middleCols(column, map_.row_count(q)).square().rowwise().sum();
        for (Eigen::Index lane = 0; lane < lanes; ++lane) {
          const bool is_more = square(lane) > most(lane);
          most(lane) = is_more ? square(lane) : most(lane);
          point(lane) = is_more ? static_cast<int>(q) : point(lane);
        }
      }
      worst_square_.segment<lanes>(block * lanes) = most.transpose();
      worst_point_.segment<lanes>(block * lanes) = point.transpose();
    }
  }

  /// The moving parameters that could take most of the worst point's error away: by |J^T e| a step.
  std::vector<Eigen::Index> promising(Eigen::Index n, std::size_t most) const {
    Rows weight = Rows::Zero(map_.error_rows(), 1), gradient;
    const Eigen::Index first = map_.first_row(worst_point_(n)), count = map_.row_count(worst_point_(n));
    weight.col(0).segment(first, count) = errors_of(n).segment(first, count).transpose();
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

  /// Levels worth trying for a parameter whose unit moves the worst point by `pull` at sample n: the one that takes
  /// most of its error away, and smaller ones.
  std::vector<std::int32_t> levels_for(const Eigen::Array3f& pull, Eigen::Index n, double step) const {
    double ee = 0, ej = 0, jj = 0;
    for (Eigen::Index a = 0; a < map_.row_count(worst_point_(n)); ++a) {
      const double e = errors_of(n)(map_.first_row(worst_point_(n)) + a), j = pull(a);
      ee += e * e;
      ej += e * j;
      jj += j * j;
    }
    if (jj <= 0) return {};
    const double full = -ej / jj;
    std::vector<std::int32_t> levels;
    const auto add = [&](double amount) {
      const double exact = amount / step;
      if (!(std::abs(exact) < 1e6)) return;
      const auto level = static_cast<std::int32_t>(exact < 0 ? std::floor(exact) : std::ceil(exact));
      if (level != 0 && std::find(levels.begin(), levels.end(), level) == levels.end()) levels.push_back(level);
    };
    const double inside = ej * ej - jj * (ee - aim_ * aim_ * static_cast<double>(free_share));
    if (inside > 0) add((-ej + (ej < 0 ? -1.0 : 1.0) * std::sqrt(inside)) / jj);
    add(0.7 * full);
    add(full);
    return levels;
  }

  /// The part of the aim below which a squared error does not count.
  static constexpr float free_share = 0.98f;

  /// Atoms of one level, tried at ever larger widths as long as that gains.
  struct Growth {
    std::int32_t level = 0;
    double last_gain = 0;
    int falls = 0;  ///< in a row

    bool goes_on() const { return falls < 2; }
  };

  Lanes strict(Eigen::Index block) const { return strictness_.segment<lanes>(block * lanes).transpose(); }

  /// What one unit of a parameter does around sample n, as far as atoms of this width reach.
  Effect effect_around(Eigen::Index moving, Eigen::Index n, int width) const {
    Effect effect = map_.effect(moving, reach_of(n, width).blocks());
    const Eigen::Index columns = effect.column(0, 1);
    for (Eigen::Index b = 0; b < effect.blocks.count; ++b)
      effect.values.middleCols(b * columns, columns).colwise() *= strict(effect.blocks.first + b);
    return effect;
  }

  /// The best atom of one parameter at sample n. Most are narrow: what is farther away is looked at only as needed.
  std::optional<FoundAtom> best_atom(Eigen::Index moving, Eigen::Index n) const {
    constexpr std::array<int, 3> stages{2, 4, widest};
    const double step = step_of(moving);
    std::optional<FoundAtom> best;
    std::vector<Growth> growths;
    std::int32_t largest_level = 0;
    Effect effect;
    for (int width = 0; const int last_width : stages) {
      effect = effect_around(moving, n, last_width);
      if (last_width == stages.front()) {
        const auto at = std::find(effect.points.begin(), effect.points.end(), worst_point_(n)) - effect.points.begin();
        if (at == std::ssize(effect.points)) return best;
        const Eigen::Index column = effect.column(static_cast<std::size_t>(at), n / lanes - effect.blocks.first);
        for (const std::int32_t level : levels_for(effect.values.row(n % lanes).segment<3>(column), n, step)) {
          growths.push_back({level});
          largest_level = std::max(largest_level, std::abs(level));
        }
      }
      grow({n, static_cast<int>(parameter(moving))}, effect, static_cast<float>(largest_level * step), width,
           last_width, growths, best);
      width = last_width + 1;
      if (std::none_of(growths.begin(), growths.end(), [](const Growth& g) { return g.goes_on(); })) break;
    }
    if (best) best->effect = std::move(effect);
    return best;
  }

  struct Place {
    Eigen::Index sample = 0;
    int parameter = 0;
  };

  /// What an atom adds to its parameter.
  struct Spread {
    BlockRange reached;  ///< what it reaches
    LaneRows shares;     ///< one column for each block of an effect

    bool has(Eigen::Index block) const { return block >= reached.first && block < reached.first + reached.count; }
  };

  Spread spread_of(Eigen::Index n, int width, double amount, const BlockRange& blocks) const {
    const Reach reach = reach_of(n, width);
    Spread spread{reach.blocks(), LaneRows::Zero(lanes, blocks.count)};
    for (Eigen::Index m = reach.first; m < reach.end; ++m)
      spread.shares(m % lanes, m / lanes - blocks.first) =
          static_cast<float>(amount * atom_share(std::abs(m - n), width));
    return spread;
  }

  /// Tries atoms of some widths within an effect; none moves a point by more than `most` times the effect.
  void grow(const Place& place, const Effect& effect, float most, int first_width, int last_width,
            std::vector<Growth>& growths, std::optional<FoundAtom>& best) const {
    const double step = steps_.anchor(place.parameter);
    const std::vector<Parabola> near =
        endangered(map_, effect, most, errors_of(effect.blocks), static_cast<float>(aim_) * std::sqrt(free_share));
    for (Growth& growth : growths)
      for (int width = first_width; width <= last_width && growth.goes_on(); ++width) {
        const Spread spread = spread_of(place.sample, width, growth.level * step, effect.blocks);
        double fall = 0;
        for (const Parabola& part : near)
          if (spread.has(effect.blocks.first + part.block))
            fall +=
                static_cast<double>((part.square.max(1.0f) - part.at(spread.shares.col(part.block)).max(1.0f)).sum());
        const double gain = fall / (18 + 2 * std::log2(std::abs(growth.level) + 1));
        growth.falls = gain < growth.last_gain ? growth.falls + 1 : 0;
        growth.last_gain = gain;
        if (gain > 0 && (!best || gain > best->gain))
          best = FoundAtom{{static_cast<std::uint32_t>(place.sample), place.parameter, width, growth.level}, gain, {}};
      }
  }

  /// At sample n, the worst of its stretch.
  bool add_atom(Eigen::Index n) {
    std::optional<FoundAtom> best;
    for (const std::size_t most : {std::size_t{4}, std::size_t{24}}) {
      for (const Eigen::Index parameter : promising(n, most)) {
        std::optional<FoundAtom> candidate = best_atom(parameter, n);
        if (candidate && (!best || candidate->gain > best->gain)) best = std::move(candidate);
      }
      if (best) break;
    }
    if (!best) return settle_sample(n) || restore_sample(n);
    apply(*best);
    put(best->atom);
    return true;
  }

  void put(const LevelAtom& atom) {
    put_atom(atom, stretch_at(static_cast<Eigen::Index>(atom.sample)).atoms);
    add_values(atom);
  }

  void add_values(const LevelAtom& atom) {
    add_atom_values(atom, *clip_, steps_, values_);
    const BlockRange reached = reach_of(static_cast<Eigen::Index>(atom.sample), atom.width).blocks();
    std::fill_n(has_old_error_.begin() + reached.first, reached.count, char{1});
  }

  /// The samples that an atom changes.
  struct Reach {
    Eigen::Index first = 0, end = 0;

    BlockRange blocks() const { return BlockRange::of(first, end - first); }
  };

  Reach reach_of(Eigen::Index n, int width) const {
    const Eigen::Index half = (Eigen::Index{1} << width) - 1;
    return {std::max<Eigen::Index>(0, n - half), std::min(samples_, n + half + 1)};
  }

  void apply(const FoundAtom& candidate) {
    const LevelAtom& atom = candidate.atom;
    const Spread spread = spread_of(static_cast<Eigen::Index>(atom.sample), atom.width,
                                    atom.level * steps_.anchor(atom.parameter), candidate.effect.blocks);
    add_effect(map_, candidate.effect, spread.shares, errors_of(candidate.effect.blocks));
    measure(spread.reached);
  }

  /// What one level of each moving parameter does to one sample's errors: error rows x moving parameters.
  Eigen::MatrixXf level_effects(Eigen::Index n) const {
    Eigen::MatrixXf effects = Eigen::MatrixXf::Zero(map_.error_rows(), moving_);
    for (Eigen::Index i = 0; i < moving_; ++i) {
      const Effect effect = map_.effect(i, BlockRange::of(n, 1));
      for (std::size_t k = 0; k < effect.points.size(); ++k) {
        const Eigen::Index q = effect.points[k], count = map_.row_count(q);
        effects.col(i).segment(map_.first_row(q), count) =
            strictness_(n) * static_cast<float>(step_of(i)) *
            effect.values.row(n % lanes).segment(effect.column(k, 0), count).transpose().matrix();
      }
    }
    return effects;
  }

  /// Per error row the square of its point's error in units of the aim.
  Eigen::VectorXf squares(const Eigen::VectorXf& error) const {
    const auto unit = static_cast<float>(1 / (aim_ * aim_));
    Eigen::VectorXf square(error.size());
    for (Eigen::Index q = 0; q < map_.seen_count(); ++q) {
      const Eigen::Index e = map_.first_row(q), count = map_.row_count(q);
      square.segment(e, count).setConstant(unit * error.segment(e, count).squaredNorm());
    }
    return square;
  }

  /// Few parameters of one sample that together bring it within the aim: matching pursuit in the eighth-power norm.
  bool settle_sample(Eigen::Index n) {
    constexpr Eigen::Index most = 32;
    const Eigen::MatrixXf effects = level_effects(n);
    const Eigen::VectorXf start = errors_of(n).transpose().matrix();
    Eigen::VectorXf error = start, amounts;
    std::vector<Eigen::Index> chosen;
    while (static_cast<Eigen::Index>(chosen.size()) < std::min(most, moving_)) {
      chosen.push_back(most_useful(effects, error, chosen));
      Eigen::MatrixXf columns(effects.rows(), static_cast<Eigen::Index>(chosen.size()));
      for (std::size_t k = 0; k < chosen.size(); ++k)
        columns.col(static_cast<Eigen::Index>(k)) = effects.col(chosen[k]);
      amounts.conservativeResizeLike(Eigen::VectorXf::Zero(columns.cols()));
      lower_peaks(columns, start, amounts);
      const Eigen::VectorXf levels = amounts.array().round();
      error = start + columns * levels;
      if (squares(error).maxCoeff() <= 1) return settle(n, chosen, levels);
    }
    return false;
  }

  /// False, and nothing changed, where the linear map promised too much.
  bool settle(Eigen::Index n, const std::vector<Eigen::Index>& chosen, const Eigen::VectorXf& levels) {
    std::vector<LevelAtom> atoms;
    for (std::size_t k = 0; k < chosen.size(); ++k)
      if (const auto level = static_cast<std::int32_t>(levels(static_cast<Eigen::Index>(k))); level != 0)
        atoms.push_back({static_cast<std::uint32_t>(n), static_cast<int>(parameter(chosen[k])), 0, level});
    const Rows error = exact_error(n, atoms);
    if (squares(error.matrix()).maxCoeff() > 1) return false;
    for (const LevelAtom& atom : atoms) put(atom);
    errors_of(n) = error.col(0).transpose();
    measure(BlockRange::of(n, 1));
    return true;
  }

  /// The errors of sample n with these atoms of its own added, times its strictness.
  Rows exact_error(Eigen::Index n, const std::vector<LevelAtom>& atoms) const {
    Eigen::MatrixXd values = values_.col(n);
    for (const LevelAtom& atom : atoms) values(atom.parameter, 0) += atom.level * steps_.anchor(atom.parameter);
    return strictness_(n) * (map_.positions(values) - wanted_.col(n));
  }

  Eigen::Index most_useful(const Eigen::MatrixXf& effects, const Eigen::VectorXf& error,
                           const std::vector<Eigen::Index>& chosen) const {
    const Eigen::VectorXf weight = squares(error).array().cube();
    const Eigen::VectorXf pull = effects.transpose() * weight.cwiseProduct(error);
    const Eigen::VectorXf norm = effects.cwiseAbs2().transpose() * weight;
    Eigen::ArrayXf use = pull.array().abs() / (norm.array() + 1e-12f * static_cast<float>(aim_ * aim_)).sqrt();
    for (const Eigen::Index i : chosen) use(i) = -1;
    Eigen::Index best = 0;
    use.maxCoeff(&best);
    return best;
  }

  /// Iteratively reweighted least squares towards the smallest sum of eighth powers of |start + columns * amounts|.
  void lower_peaks(const Eigen::MatrixXf& columns, const Eigen::VectorXf& start, Eigen::VectorXf& amounts) const {
    constexpr int most_steps = 12;
    for (int k = 0; k < most_steps; ++k) {
      const Eigen::VectorXf error = start + columns * amounts;
      const Eigen::VectorXf square = squares(error);
      if (square.maxCoeff() < 0.9f) return;
      const Eigen::VectorXf weight = square.array().cube() + 1e-3f;
      const Eigen::MatrixXd weighted = (weight.asDiagonal() * columns).cast<double>();
      Eigen::MatrixXd normal = columns.cast<double>().transpose() * weighted;
      normal.diagonal() *= 1.001;
      const Eigen::VectorXd step = normal.ldlt().solve(-(weighted.transpose() * error.cast<double>()));
      if (!step.allFinite()) return;
      amounts += (step / 4).cast<float>();
    }
  }

  /// Where the linear map does not lead under the bound: brings to their true values as few targets as the sample needs
  /// to be within the aim. False where that was done and did not last.
  bool restore_sample(Eigen::Index n) {
    if (++restored_[static_cast<std::size_t>(n)] > most_restorations) return false;
    take_back(n);
    int tries = 400;
    const std::vector<LevelAtom> atoms = needed_atoms(
        missing_by_target(layout_, steps_, n, 1, values_),
        [&](const std::vector<LevelAtom>& some) { return sample_excess(exact_error(n, some).matrix()); }, tries);
    for (const LevelAtom& atom : atoms) put(atom);
    errors_of(n) = exact_error(n, {}).col(0).transpose();
    measure(BlockRange::of(n, 1));
    return true;
  }

  /// Removes the atoms of sample n alone: where the map was wrong, they made things worse.
  void take_back(Eigen::Index n) {
    std::erase_if(stretch_at(n).atoms, [&](LevelAtom atom) {
      if (atom.sample != static_cast<std::uint32_t>(n) || atom.width != 0) return false;
      atom.level = -atom.level;
      add_values(atom);
      return true;
    });
  }

  /// What the squared errors of one sample, in units of the aim, lie above the bound.
  double sample_excess(const Eigen::VectorXf& error) const {
    const Eigen::VectorXf square = squares(error);
    double sum = 0;
    for (Eigen::Index q = 0; q < map_.seen_count(); ++q)
      sum += static_cast<double>(std::max(0.0f, square(map_.first_row(q)) - 1.0f));
    return sum;
  }

  /// For samples where the linear map does not lead under the bound.
  void restore_all() {
    for (Eigen::Index n = 0; n < samples_; ++n)
      if (static_cast<double>(worst_square_(n)) > bound_ * bound_) restore_sample(n);
  }

  const ClipLayout& layout_;
  const ParameterSteps& steps_;
  MotionMap& map_;
  const Rows& wanted_;
  double bound_, aim_;
  int threads_;
  Eigen::Index samples_, blocks_, moving_;
  LevelClip* clip_ = nullptr;                         ///< that is corrected
  SampleRow asked_, strictness_;                      ///< by the caller; with what is aimed lower
  SampleRow worst_square_;                            ///< per sample: the largest squared error
  Eigen::Array<int, 1, Eigen::Dynamic> worst_point_;  ///< per sample
  LaneRows error_;                                    ///< times the strictness
  Eigen::MatrixXd values_;                            ///< what the levels mean, all parameters x samples
  std::vector<char> has_old_error_;                   ///< per block: values have changed, exact errors are not known
  std::vector<char> has_old_map_;                     ///< per block: the linear map is of other values
  std::vector<int> restored_;                         ///< per sample: how often
  std::vector<Stretch> stretches_;
};

Corrections::Corrections(const ClipLayout& layout, const ParameterSteps& steps, MotionMap& map, const Rows& wanted,
                         double bound, int threads)
    : corrector_(std::make_unique<Corrector>(layout, steps, map, wanted, bound, threads)) {}

Corrections::~Corrections() = default;

bool Corrections::correct(LevelClip& clip, const SampleRow& strictness, std::size_t most_atoms) {
  return corrector_->run(clip, strictness, most_atoms);
}

}  // namespace nmc::codec
