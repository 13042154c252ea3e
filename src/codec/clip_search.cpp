#include "codec/clip_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "base/parallel.h"
#include "codec/clip_trial.h"
#include "codec/features.h"
#include "codec/windows.h"

namespace nmc::codec {
namespace {

/// How long the search for one clip may take, by effort.
struct SearchPlan {
  int first_iterations = 100;  ///< of the first training of each cut
  int iterations = 100;        ///< of each later one, which starts where the best one ended
  int trials = 8;              ///< later trainings
  int last_iterations = 0;     ///< of one more at the best settings
  bool prunes = true;          ///< takes from what is within the bound what the bound can do without
  /// Of the fewest bytes that a cut was trained to, up to which a cut is corrected: more hardly ever ends as less.
  double worth_correcting = 1.2;
};

/// Long clips have more to learn from in each training and get fewer of them, so that time stays linear.
SearchPlan plan_of(int effort, Eigen::Index samples) {
  const int fewer = static_cast<int>(std::clamp<Eigen::Index>(samples / 160, 1, 5));
  if (effort <= 1) return {30, 20, 0, 0, false, 1};
  if (effort <= 2) return {60, 40, 3 / fewer, 0};
  if (effort <= 3) return {80, 60, 6 / fewer, 0};
  if (effort <= 5) return {100, 70, std::max(2, 7 / fewer), fewer > 2 ? 0 : 100};
  if (effort <= 7) return {250, 200, 16, 400};
  return {500, 400, 24, 1000};
}

/// The searches of an effort.
std::vector<int> efforts_of(int effort) {
  std::vector<int> efforts;
  for (const int lower : {5, 7})
    if (lower < effort) efforts.push_back(lower);
  efforts.push_back(effort);
  return efforts;
}

/// Longer clips are smallest with coarser steps and dearer bits.
constexpr Eigen::Index short_samples = 120;

/// Bases and windows worth trying for a clip. Most clips with jumps are smaller when these are taken out first.
std::vector<SparseSettings> cuts_of(const SearchContext& context, const PreparedClip& clip, int effort, int threads) {
  std::vector<SparseSettings> cuts;
  const Eigen::Index samples = clip.layout.values.cols();
  const bool loops = clip.loops, jumps = !clip.jumps.empty();
  const auto whole = static_cast<std::uint32_t>(samples);
  if (samples <= 400 && !loops) cuts.push_back({.basis = Basis::cosine, .boundaries = {0, whole}});
  if (samples >= 8 && samples <= 400) {
    // What is periodic would be wrong by opposite errors at the two ends of a spin.
    const bool spins = (end_signs(clip.layout).array() < 0).any();
    const Basis basis = loops && spins ? Basis::sine : Basis::periodic;
    cuts.push_back({.basis = basis, .boundaries = {0, whole - 1}});
  }
  if (samples >= 8 && context.parts.fitted_windows)
    cuts.push_back(
        {.basis = Basis::sine,
         .boundaries = fitted_windows(clip.layout, clip.steps, clip.jumps, samples > short_samples ? -6 : 1, threads)});
  else if (samples > 200)
    cuts.push_back({.basis = Basis::sine, .boundaries = even_windows(static_cast<std::size_t>(samples), 128)});
  for (SparseSettings& cut : cuts) {
    cut.loops = loops;
    cut.jumps = jumps;
  }
  if (jumps && effort > 2) {
    const std::vector<SparseSettings> with = cuts;
    for (SparseSettings cut : with) {
      cut.jumps = false;
      cuts.push_back(cut);
    }
  }
  return cuts;
}

class ClipSearch {
 public:
  ClipSearch(const SearchContext& context, int effort, const PreparedClip& prepared, std::size_t index,
             std::vector<Candidate>* tried)
      : context_(context),
        effort_(effort),
        tried_(tried),
        samples_(prepared.layout.values.cols()),
        clip_{context, prepared, context.source.clips[index], tried != nullptr},
        plan_(plan_of(effort, samples_)) {
    const int at_once = samples_ > memory_for_one ? 1 : std::clamp(context.threads, 1, most_at_once);
    for (int k = 0; k < at_once; ++k) benches_.push_back(make_workbench(clip_, 1));
  }

  LevelClip run() {
    const bool from_each_cut = effort_ > 5;
    Trial current = best_cut(from_each_cut);
    const bool searched = from_each_cut && current.kept;
    if (!current.kept) current = first_within_bound(current);
    if (current.kept && !searched) descend(current);
    if (plan_.last_iterations > 0 && current.kept) {
      SparseSettings last = current.settings;
      last.iterations = plan_.last_iterations;
      make_and_take(last, &current.state);
    }
    if (best_) return *best_;
    SparseSettings plain = current.settings;
    plain.iterations = 0;
    plain.jumps = false;
    plain.step_exponent = finest;
    return train_trial(clip_, plain, nullptr, bench()).levels;
  }

  /// Of what run found; the largest number where nothing is within the bound.
  std::size_t bytes() const { return best_bytes_; }

 private:
  static constexpr Eigen::Index worth_threads = 1000;     ///< samples from which threads help a single trial
  static constexpr Eigen::Index memory_for_one = 20'000;  ///< samples from which trials at once take too much memory
  static constexpr int most_at_once = 3;                  ///< a move and those that follow it if it fails
  static constexpr int stride = 3;                        ///< of the search, in quarters of an octave of step size
  static constexpr int finest = 24;                       ///< step exponent

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

  /// A cut's first trial, and one at finer steps where that one's are far too coarse.
  using CutTrials = std::vector<Trial>;

  /// The best of the first trials of all cuts, or of what is found from each of them.
  Trial best_cut(bool from_each_cut) {
    std::vector<CutTrials> cuts = trained_cuts();
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
      if (from_each_cut && trial.kept) descend(trial);
      if (best.settings.boundaries.empty() || trial.beats(best)) best = std::move(trial);
    }
    return best;
  }

  /// One trial of each cut, not corrected; where no time is left, of the first alone.
  std::vector<CutTrials> trained_cuts() {
    const bool is_long = samples_ > short_samples;
    std::vector<SparseSettings> settings = cuts_of(context_, clip_.prepared, effort_, bench().threads);
    std::vector<CutTrials> cuts(settings.size());
    at_once(cuts.size(), [&](std::size_t k, Workbench& bench) {
      const bool is_late = context_.is_late();
      settings[k].step_exponent = is_long ? -2 : 1;
      settings[k].rate = is_long ? 0.45 : 0.2;
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
    const int finer = std::clamp(static_cast<int>(std::lround(4 * std::log2(first.usual_error))), 1, most);
    Trial again = make(neighbour(first, finer, 1, plan_.iterations), &first.state, unlimited, bench);
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
      trial = make_and_take(neighbour(trial, stride, 0.8, plan_.first_iterations), &trial.state);
    SparseSettings plain = coarse.settings;
    plain.iterations = 0;
    plain.jumps = false;
    plain.rate = 0.05;  // of the trainings that go on from here
    for (plain.step_exponent = 4; !trial.kept && plain.step_exponent <= finest; plain.step_exponent += 4)
      trial = make_and_take(plain, nullptr);
    return trial;
  }

  /// Whichever neighbour is smaller, as long as there is one. Trials that follow a move if it fails are made beside it;
  /// one that does not follow is dropped, so that the threads change nothing.
  void descend(Trial& current) {
    struct Move {
      int exponent;
      double rate;
    };
    constexpr std::array<Move, 4> all{{{-stride, 1}, {0, 2}, {0, 0.5}, {stride, 1}}};
    // Finer steps hardly ever make a smaller clip.
    const std::span<const Move> moves(all.data(), effort_ > 5 ? 4 : 3);
    auto left = static_cast<std::size_t>(plan_.trials);
    for (std::size_t failed = 0, at = 0; failed < moves.size() && left > 0;) {
      std::vector<Trial> next(std::min({benches_.size(), moves.size() - failed, left}));
      at_once(next.size(), [&](std::size_t k, Workbench& bench) {
        const Move& move = moves[(at + k) % moves.size()];
        next[k] =
            make(neighbour(current, move.exponent, move.rate, plan_.iterations), &current.state, current.bytes, bench);
      });
      for (Trial& trial : next) {
        --left;
        take(trial);
        if (trial.beats(current)) {
          current = std::move(trial);
          failed = 0;
          break;
        }
        ++failed;
        at = (at + 1) % moves.size();
      }
    }
  }

  /// A trial made alone that may become the best one.
  Trial make_and_take(const SparseSettings& settings, const TrainingState* start) {
    Trial trial = make(settings, start, best_bytes_, bench());
    take(trial);
    return trial;
  }

  /// A trial that may get below `limit` bytes; an empty one where no time is left and there is something to take.
  Trial make(SparseSettings settings, const TrainingState* start, std::size_t limit, Workbench& bench) const {
    if (context_.is_late()) {
      if (best_) return {.settings = settings};
      settings.iterations = 0;
    }
    Trial trial = train_trial(clip_, settings, start, bench);
    finish_trial(clip_, limit, plan_.prunes, bench, trial);
    return trial;
  }

  /// Keeps what the trial is made of if it is the smallest, and what is recorded of it.
  void take(const Trial& trial) {
    if (tried_) tried_->insert(tried_->end(), trial.seen.begin(), trial.seen.end());
    if (!trial.kept || trial.bytes >= best_bytes_) return;
    best_bytes_ = trial.bytes;
    best_ = trial.levels;
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

}  // namespace

std::vector<LevelClip> search_clip(const SearchContext& context, const PreparedClip& prepared, std::size_t index,
                                   std::vector<Candidate>* tried) {
  // Longer trainings end elsewhere, not always at fewer bytes: high efforts have what the lower ones find as well.
  std::vector<LevelClip> found;
  std::size_t least = unlimited;
  for (const int effort : efforts_of(context.effort)) {
    if (least != unlimited && context.is_late()) break;
    ClipSearch search(context, effort, prepared, index, tried);
    LevelClip levels = search.run();
    if (!found.empty() && search.bytes() >= least) continue;
    if (least == unlimited) found.clear();  // not within the tolerance
    least = search.bytes();
    found.push_back(std::move(levels));
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
