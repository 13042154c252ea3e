#include "codec/clip_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "base/parallel.h"
#include "codec/clip_trial.h"
#include "codec/excerpt.h"
#include "codec/search_plan.h"

namespace nmc::codec {
namespace {

constexpr int most_at_once = 3;  ///< trials: a move and those that follow it if it fails

/// Steps of the exponent that make a usual error, in units of the tolerance, about one; below zero: coarser.
int steps_to_tolerance(float usual_error) {
  constexpr double most = 4;  // octaves
  return static_cast<int>(std::lround(4 * std::clamp(std::log2(static_cast<double>(usual_error)), -most, most)));
}

class ClipSearch {
 public:
  /// Makes up to `at_once` trials at once.
  ClipSearch(const TrialClip& clip, int effort, const SearchPlan& plan, int at_once, std::vector<Candidate>* tried)
      : context_(clip.context),
        effort_(effort),
        tried_(tried),
        samples_(clip.prepared.layout.values.cols()),
        clip_(clip),
        plan_(plan) {
    for (int k = 0; k < at_once; ++k) benches_.push_back(make_workbench(clip_, 1));
  }

  /// The smallest levels found from these cuts.
  LevelClip run(std::vector<SparseSettings> cuts) {
    const bool from_each_cut = effort_ > 5;
    if (plan_.guesses && !context_.is_late()) cuts = {guessed(cuts)};
    Trial current = best_cut(std::move(cuts), from_each_cut);
    const bool searched = from_each_cut && current.kept;
    if (!current.kept) current = first_within_bound(current);
    if (!current.kept) return result(current.settings);
    std::optional<Trial> last;
    if (!searched) descend(current, &last);
    if (plan_.last_iterations > 0) take(last ? *last : make(last_of(current), &current, best_bytes_, bench()));
    return result(current.settings);
  }

  /// The trainings, one going on from the other, that led to the smallest levels found from these cuts; the last one
  /// longer by plan.last_iterations.
  std::vector<SparseSettings> best_trainings(std::vector<SparseSettings> cuts) {
    Trial current = best_cut(std::move(cuts), false);
    if (!current.kept) current = first_within_bound(current);
    if (current.kept) descend(current, nullptr);
    std::vector<SparseSettings> trainings = std::move(current.earlier);
    trainings.push_back(current.settings);
    if (current.settings.iterations > 0) trainings.back().iterations += plan_.last_iterations;
    return trainings;
  }

  /// What these trainings lead to, one going on from the other; where no time is left before them, untrained levels.
  LevelClip run_trainings(std::vector<SparseSettings> trainings) {
    if (context_.is_late()) {
      trainings.resize(1);
      trainings.front().iterations = 0;
    }
    CutTrials trials(1);
    Trial& trained = trials.front();
    for (std::size_t k = 0; k < trainings.size(); ++k) {
      const SparseSettings& settings = trainings[k];
      const TrainingState start = std::move(trained.state);
      trained = train_trial(clip_, settings, k > 0 ? &start : nullptr, bench());
    }
    finish_cut(bench(), trials);
    for (const Trial& trial : trials) take(trial);
    Trial& last = trials.back();
    return result(last.kept ? last.settings : first_within_bound(last).settings);
  }

  /// Of what run found; the largest number where nothing is within the bound.
  std::size_t bytes() const { return best_bytes_; }

 private:
  static constexpr Eigen::Index worth_threads = 500;  ///< samples from which threads help a single trial
  static constexpr int stride = 3;                    ///< of the search, in quarters of an octave of step size
  static constexpr int finest = 24;                   ///< step exponent

  /// The smallest levels found; where none are within the bound, the transform at the finest steps.
  LevelClip result(const SparseSettings& last) {
    if (best_) return *best_;
    SparseSettings plain = last;
    plain.iterations = 0;
    plain.jumps = false;
    plain.step_exponent = finest;
    return train_trial(clip_, plain, nullptr, bench()).levels;
  }

  /// The bench of a trial that is made alone.
  Workbench& bench() {
    benches_.front().threads = threads_of_each(1);
    return benches_.front();
  }

  int threads_of_each(std::size_t trials) const {
    return samples_ < worth_threads ? 1 : std::max(1, context_.threads / static_cast<int>(trials));
  }

  /// Calls body(i, bench) for i in [0, count), as many at once as there are benches.
  template <typename Body>
  void at_once(std::size_t count, const Body& body) {
    for (std::size_t first = 0; first < count; first += benches_.size()) {
      const std::size_t some = std::min(benches_.size(), count - first);
      for (Workbench& bench : benches_) bench.threads = threads_of_each(some);
      parallel_for(some, static_cast<int>(some), [&](std::size_t k) { body(first + k, benches_[k]); });
    }
  }

  /// The cut that is smallest untrained, where rounding takes about all of the tolerance; the plan gets its steps.
  SparseSettings guessed(const std::vector<SparseSettings>& cuts) {
    plan_.first_exponent += rounded(cuts.front(), bench()).finer;
    std::vector<Rounded> all(cuts.size());
    at_once(cuts.size(), [&](std::size_t k, Workbench& bench) { all[k] = rounded(cuts[k], bench); });
    for (const Rounded& one : all) note(one.seen);
    const auto least =
        std::min_element(all.begin(), all.end(), [](const Rounded& a, const Rounded& b) { return a.bytes < b.bytes; });
    plan_.first_exponent += least->finer;
    return cuts[static_cast<std::size_t>(least - all.begin())];
  }

  struct Rounded {
    std::size_t bytes;
    int finer;  ///< steps of the exponent until the usual error is the tolerance
    std::vector<Candidate> seen;
  };

  /// A cut without training, at the plan's steps.
  Rounded rounded(SparseSettings cut, Workbench& bench) const {
    cut.step_exponent = plan_.first_exponent;
    cut.rate = plan_.first_rate;
    cut.iterations = 0;
    Trial trial = train_trial(clip_, cut, nullptr, bench);
    return {trial.bytes, steps_to_tolerance(usual_error(clip_, trial.levels, bench)), std::move(trial.seen)};
  }

  /// A cut's first trial, and one at finer steps where that one's are far too coarse.
  using CutTrials = std::vector<Trial>;

  /// The best of the first trials of all cuts, or of what is found from each of them.
  Trial best_cut(std::vector<SparseSettings> settings, bool from_each_cut) {
    std::vector<CutTrials> cuts = trained_cuts(std::move(settings));
    std::size_t least = unlimited;
    for (const CutTrials& cut : cuts) least = std::min(least, cut.front().bytes);
    at_once(cuts.size(), [&](std::size_t k, Workbench& bench) {
      const bool is_small =
          static_cast<double>(cuts[k].front().bytes) <= plan_.worth_correcting * static_cast<double>(least);
      if (is_small && (k == 0 || !context_.is_late())) finish_cut(bench, cuts[k]);
    });
    Trial best;
    for (CutTrials& cut : cuts) {
      for (const Trial& trial : cut) take(trial);
      Trial& trial = cut.back();
      if (from_each_cut && trial.kept) descend(trial, nullptr);
      if (best.settings.boundaries.empty() || trial.beats(best)) best = std::move(trial);
    }
    return best;
  }

  /// One trial of each cut, not corrected; where no time is left, of the first alone.
  std::vector<CutTrials> trained_cuts(std::vector<SparseSettings> settings) {
    std::vector<CutTrials> cuts(settings.size());
    at_once(cuts.size(), [&](std::size_t k, Workbench& bench) {
      const bool is_late = context_.is_late();
      settings[k].step_exponent = plan_.first_exponent;
      settings[k].rate = plan_.first_rate;
      settings[k].iterations = is_late ? 0 : plan_.first_iterations;
      cuts[k].push_back(is_late && k > 0 ? Trial{.settings = settings[k]}
                                         : train_trial(clip_, settings[k], nullptr, bench));
    });
    return cuts;
  }

  /// Corrects a cut's trial. Cuts are compared at steps that they can keep the bound with: where the first ones are far
  /// off, at as much finer ones as the error is too large.
  void finish_cut(Workbench& bench, CutTrials& trials) const {
    constexpr int most = 8;
    Trial& first = trials.front();
    finish_trial(clip_, unlimited, plan_.prunes, bench, first);
    if (!first.is_hopeless() || context_.is_late()) return;
    const int finer = std::clamp(steps_to_tolerance(first.usual_error), 1, most);
    Trial again = make(neighbour(first, finer, 1, plan_.iterations), &first, unlimited, bench);
    trials.push_back(std::move(again));
  }

  static SparseSettings neighbour(const Trial& trial, int exponent, double rate, int iterations) {
    SparseSettings settings = trial.settings;
    settings.step_exponent += exponent;
    settings.rate *= rate;
    settings.iterations = iterations;
    return settings;
  }

  /// Finer steps until the bound is kept; at last without training and without jumps.
  Trial first_within_bound(const Trial& coarse) {
    Trial trial = coarse;
    for (int k = 0; k < 4 && !trial.kept && !context_.is_late(); ++k)
      trial = make_and_take(neighbour(trial, stride, 0.8, std::max(plan_.first_iterations, plan_.iterations)), &trial);
    SparseSettings plain = coarse.settings;
    plain.iterations = 0;
    plain.jumps = false;
    plain.rate = 0.05;  // of the trainings that go on from here
    for (plain.step_exponent = 4; !trial.kept && plain.step_exponent <= finest; plain.step_exponent += 4)
      trial = make_and_take(plain, nullptr);
    return trial;
  }

  SparseSettings last_of(const Trial& trial) const {
    SparseSettings settings = trial.settings;
    settings.iterations = plan_.last_iterations;
    return settings;
  }

  /// Whichever neighbour is smaller, as long as there is one. Trials that follow a move if it fails are made beside it;
  /// one that does not follow is dropped, so that the threads change nothing. `last`: the last training of what is
  /// found, where it could be made beside others (null: not wanted).
  void descend(Trial& current, std::optional<Trial>* last) {
    struct Move {
      int exponent;
      double rate;
    };
    constexpr std::array<Move, 4> all{{{-stride, 1}, {0, 2}, {0, 0.5}, {stride, 1}}};
    // Finer steps hardly ever make a smaller clip.
    const std::span<const Move> moves(all.data(), effort_ > 5 ? 4 : 3);
    auto left = static_cast<std::size_t>(plan_.trials);
    for (std::size_t failed = 0, at = 0; failed < moves.size() && left > 0;) {
      const std::size_t follow = std::min(moves.size() - failed, left);
      std::vector<Trial> next(std::min(benches_.size(), follow));
      const bool has_last = last && plan_.last_iterations > 0 && benches_.size() > follow;
      at_once(next.size() + (has_last ? 1 : 0), [&](std::size_t k, Workbench& bench) {
        if (k == next.size()) {
          last->emplace(make(last_of(current), &current, current.bytes, bench));
          return;
        }
        const Move& move = moves[(at + k) % moves.size()];
        next[k] = make(neighbour(current, move.exponent, move.rate, plan_.iterations), &current, current.bytes, bench);
      });
      for (Trial& trial : next) {
        --left;
        take(trial);
        if (trial.beats(current)) {
          current = std::move(trial);
          if (last) last->reset();
          failed = 0;
          break;
        }
        ++failed;
        at = (at + 1) % moves.size();
      }
    }
  }

  /// A trial made alone that may become the best one.
  Trial make_and_take(const SparseSettings& settings, const Trial* from) {
    Trial trial = make(settings, from, best_bytes_, bench());
    take(trial);
    return trial;
  }

  /// A trial that may get below `limit` bytes and goes on `from` another (null: none); an empty one where no time is
  /// left and there is something to take.
  Trial make(SparseSettings settings, const Trial* from, std::size_t limit, Workbench& bench) const {
    if (context_.is_late()) {
      if (best_) return {.settings = settings};
      settings.iterations = 0;
    }
    Trial trial = train_trial(clip_, settings, from ? &from->state : nullptr, bench);
    if (from) {
      trial.earlier = from->earlier;
      trial.earlier.push_back(from->settings);
    }
    finish_trial(clip_, limit, plan_.prunes, bench, trial);
    return trial;
  }

  /// Keeps what the trial is made of if it is the smallest, and what is recorded of it.
  void take(const Trial& trial) {
    note(trial.seen);
    if (!trial.kept || trial.bytes >= best_bytes_) return;
    best_bytes_ = trial.bytes;
    best_ = trial.levels;
  }

  void note(const std::vector<Candidate>& seen) {
    if (tried_) tried_->insert(tried_->end(), seen.begin(), seen.end());
  }

  const SearchContext& context_;
  int effort_;
  std::vector<Candidate>* tried_;
  Eigen::Index samples_;
  TrialClip clip_;
  SearchPlan plan_;
  std::vector<Workbench> benches_;
  std::optional<LevelClip> best_;
  std::size_t best_bytes_ = unlimited;
};

struct Found {
  LevelClip levels;
  std::size_t bytes;  ///< ClipSearch::bytes
};

/// Settings are searched on the excerpt, then all of the clip takes them.
Found search_on_excerpt(const TrialClip& clip, int effort, const std::vector<SparseSettings>& cuts,
                        const Excerpt& excerpt, std::vector<Candidate>* tried) {
  SearchContext context = clip.context;
  if (context.is_half_over) context.is_late = context.is_half_over;  // the other half is the whole clip's
  const SearchPlan plan = excerpt_plan_of(effort, std::ssize(clip.prepared.offset));
  const TrialClip part{context, excerpt.clip, excerpt.source, clip.records, excerpt.share};
  std::vector<SparseSettings> cuts_of_part = cuts;
  for (SparseSettings& cut : cuts_of_part) {
    cut.boundaries = excerpt.boundaries;
    cut.loops = false;
  }
  const int at_once = std::clamp(context.threads, 1, most_at_once);
  std::vector<SparseSettings> trainings =
      ClipSearch(part, effort, plan, at_once, tried).best_trainings(std::move(cuts_of_part));
  for (SparseSettings& training : trainings) {
    training.boundaries = cuts.front().boundaries;
    training.loops = cuts.front().loops;
  }
  ClipSearch search(clip, effort, plan, 1, tried);
  LevelClip levels = search.run_trainings(std::move(trainings));
  return {std::move(levels), search.bytes()};
}

Found search_at(const TrialClip& clip, int effort, std::vector<Candidate>* tried) {
  constexpr Eigen::Index memory_for_one = 20'000;  // samples from which trials at once take too much memory
  const Eigen::Index samples = clip.prepared.layout.values.cols();
  std::vector<SparseSettings> cuts = cuts_of(clip.context, clip.prepared, effort);
  if (const Eigen::Index part = excerpt_samples(effort, samples); part > 0)
    if (const std::optional<Excerpt> excerpt = excerpt_of(clip.prepared, cuts.front().boundaries, part))
      return search_on_excerpt(clip, effort, cuts, *excerpt, tried);
  const int at_once = samples > memory_for_one ? 1 : std::clamp(clip.context.threads, 1, most_at_once);
  ClipSearch search(clip, effort, plan_of(effort, samples), at_once, tried);
  LevelClip levels = search.run(std::move(cuts));
  return {std::move(levels), search.bytes()};
}

}  // namespace

std::vector<LevelClip> search_clip(const SearchContext& context, const PreparedClip& prepared, std::size_t index,
                                   std::vector<Candidate>* tried) {
  const TrialClip clip{context, prepared, context.source.clips[index], tried != nullptr};
  // Longer trainings end elsewhere, not always at fewer bytes: high efforts have what the lower ones find as well.
  std::vector<LevelClip> found;
  std::size_t least = unlimited;
  for (const int effort : efforts_of(context.effort)) {
    if (least != unlimited && context.is_late()) break;
    Found one = search_at(clip, effort, tried);
    if (!found.empty() && one.bytes >= least) continue;
    if (least == unlimited) found.clear();  // not within the tolerance
    least = one.bytes;
    found.push_back(std::move(one.levels));
  }
  if (!tried) return found;
  const auto smaller = [](const Candidate& a, const Candidate& b) {
    return a.kept != b.kept ? a.kept : a.bytes < b.bytes;
  };
  const auto best = std::min_element(tried->begin(), tried->end(), smaller);
  if (best != tried->end() && best->kept) best->chosen = true;
  return found;
}

}  // namespace nmc::codec
