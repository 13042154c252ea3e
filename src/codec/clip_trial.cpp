#include "codec/clip_trial.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "codec/atoms.h"
#include "codec/between.h"
#include "codec/corrections.h"
#include "codec/refinement.h"
#include "codec/seam.h"

namespace nmc::codec {
namespace {

/// The part of the tolerance that is aimed at: the rest covers what lies between samples and points.
constexpr double aim = 0.985;

/// A usual error after repair from which corrections never make the smallest candidate.
constexpr float hopeless_repaired = 1.07f;

constexpr double worth_pruning = 1.04;  ///< of the smallest candidate's bytes

/// Samples: what is known of longer clips takes too much memory to be kept from round to round.
constexpr Eigen::Index most_remembered = 20'000;

/// What is done to one trial after its training: corrected, pruned, measured, counted.
class TrialWork {
 public:
  TrialWork(const TrialClip& clip, Workbench& bench)
      : context_(clip.context),
        prepared_(clip.prepared),
        clip_(clip.source),
        records_(clip.records),
        share_(clip.share),
        bench_(bench) {}

  void finish(std::size_t limit, bool prunes, Trial& trial) {
    if (trial.bytes >= limit) return;
    LevelClip& levels = trial.levels;
    // More bytes of atoms than of weights, or more than two atoms a sample, are a sign of steps that are too coarse.
    constexpr std::size_t atom_bits = 14;  // about
    const std::size_t usual = 2 * levels.times.size() * atom_bits / 8;
    const std::size_t bytes = std::min(trial.bytes, limit < unlimited ? limit - trial.bytes : usual);
    const std::size_t room = levels.atoms.size() + 20 + bytes * 8 / atom_bits;
    if (trial.settings.iterations > 0 && context_.parts.refinement) {
      trial.usual_error = usual_error(levels);
      if (trial.is_hopeless()) return;
      repair(levels, prepared_.layout, prepared_.steps, map(), prepared_.wanted, goal() * 0.99, threads());
      if (usual_error(levels) > hopeless_repaired) return;
    }
    trial.kept = bring_within_bound(levels, room, trial.settings.iterations > 0);
    trial.bytes = bytes_of(levels);
    const bool is_small = static_cast<double>(trial.bytes) < worth_pruning * static_cast<double>(limit);
    if (trial.kept && is_small && prunes && context_.parts.refinement) prune_levels(room, trial);
    record(trial);
  }

  void record(Trial& trial) const {
    if (!records_) return;
    if (is_excerpt()) {
      const auto whole = static_cast<std::size_t>(std::lround(static_cast<double>(trial.bytes) / share_));
      const double error = std::sqrt(static_cast<double>(square_errors(trial.levels).maxCoeff()));
      trial.seen.push_back({whole, error, false, false, basis_name(trial.settings.basis), trial.settings.jumps});
      return;
    }
    const motion::ErrorProfile profile = error_profile(trial.levels);
    trial.seen.push_back({trial.bytes, *std::max_element(profile.max_error.begin(), profile.max_error.end()),
                          trial.kept, false, basis_name(trial.settings.basis), trial.settings.jumps});
  }

  /// The median over the samples of the largest error, in units of the tolerance.
  float usual_error(const LevelClip& levels) const {
    SampleRow largest = square_errors(levels);
    const auto middle = largest.begin() + largest.size() / 2;
    std::nth_element(largest.begin(), middle, largest.end());
    return std::sqrt(*middle) / static_cast<float>(context_.bound.tolerance);
  }

  std::size_t bytes_of(const LevelClip& clip) const {
    ClipSet alone = context_.set;
    alone.clips = {clip};
    const PartBits bits = count_bits(alone);
    return static_cast<std::size_t>((bits.anchors + bits.weights + bits.atoms) / 8) + 1;
  }

 private:
  MotionMap& map() const { return bench_.map; }
  int threads() const { return bench_.threads; }
  double goal() const { return aim * context_.bound.tolerance; }

  /// Takes the pruned levels where they end with fewer bytes.
  void prune_levels(std::size_t room, Trial& trial) {
    LevelClip pruned = trial.levels;
    prune(pruned, prepared_.layout, prepared_.steps, map(), prepared_.wanted, goal(), threads());
    if (!bring_within_bound(pruned, room, true)) return;
    const std::size_t bytes = bytes_of(pruned);
    if (bytes >= trial.bytes) return;
    trial.levels = std::move(pruned);
    trial.bytes = bytes;
  }

  bool is_excerpt() const { return share_ < 1; }

  /// Per sample the largest squared error.
  SampleRow square_errors(const LevelClip& levels) const {
    const Eigen::MatrixXd values = values_of_levels(levels, prepared_.steps, prepared_.layout.values.cols(), threads());
    const Rows error = map().positions(values, threads()) - prepared_.wanted;
    SampleRow largest = SampleRow::Zero(error.cols());
    for (Eigen::Index q = 0; q < map().seen_count(); ++q)
      largest = largest.max(error.middleRows(map().first_row(q), map().row_count(q)).square().colwise().sum());
    return largest;
  }

  /// Corrects; measures what the levels mean between the file's keys and at every vertex; where that is above the
  /// bound, corrects the samples around it further. `closes_loops`: rather than a loop with a seam, none.
  bool bring_within_bound(LevelClip& levels, std::size_t most_atoms, bool closes_loops) {
    if (!context_.parts.corrections) return is_within_bound(error_profile(levels));
    constexpr int rounds = 8, first_rounds = 3;
    SampleRow strictness = SampleRow::Ones(prepared_.layout.values.cols());
    std::optional<Corrections> corrections;
    Measured measured;
    for (int round = 0; round < rounds; ++round) {
      if (!corrections)
        corrections.emplace(prepared_.layout, prepared_.steps, map(), prepared_.wanted, goal(), threads());
      if (!corrections->correct(levels, strictness, most_atoms)) return false;
      if (is_excerpt()) return true;
      if (strictness.size() > most_remembered) corrections.reset();
      if (context_.exact_ends)
        restore_ends(levels);
      else if (prepared_.loops && (closes_loops || round < rounds / 2))  // better a seam than no end
        close_seam(levels, end_signs(prepared_.layout), prepared_.layout.values.cols());
      measure(levels, measured);
      motion::ErrorProfile profile = measured.profile;
      if (is_within_bound(profile)) return true;
      if (round < first_rounds)
        mend_flips(profile, 1.5, Mending::tips, levels);
      else
        mend_flips(profile, 1, Mending::true_poses, levels);
      // What is corrected next may break what has just been mended.
      if (round >= first_rounds) {
        measure(levels, measured);
        if (is_within_bound(measured.profile)) return true;
      }
      tighten(profile, 1 + 0.1 * round, strictness);
    }
    return false;
  }

  /// Atoms that make the first and the last pose what they were.
  void restore_ends(LevelClip& levels) const {
    const Eigen::Index samples = prepared_.layout.values.cols();
    const Eigen::MatrixXd values = values_of_levels(levels, prepared_.steps, samples, threads());
    for (const Eigen::Index end : {Eigen::Index{0}, samples - 1})
      put_atoms(joined(missing_by_target(prepared_.layout, prepared_.steps, end, 1, values)), levels.atoms);
    tidy_atoms(levels.atoms);
  }

  motion::ErrorProfile error_profile(const LevelClip& levels) const {
    Measured measured;
    measure(levels, measured);
    return measured.profile;
  }

  /// What levels mean, and their errors.
  struct Measured {
    Eigen::MatrixXd values;  ///< all parameters x samples; empty: not remembered
    motion::ErrorProfile profile;
  };

  /// Only times beside samples whose values have changed are looked at again.
  void measure(const LevelClip& levels, Measured& measured) const {
    Eigen::MatrixXd values = values_of_levels(levels, prepared_.steps, prepared_.layout.values.cols(), threads());
    const Animation decoded =
        with_kept(clip_, clip_of_parameters(clip_.clip, context_.frame, prepared_.layout, values));
    if (measured.values.size() == 0) {
      measured.profile = context_.meter.profile(clip_.original, decoded, threads());
    } else {
      std::vector<bool> stale(measured.profile.seconds.size());
      for (std::size_t k = 0; k < stale.size(); ++k) {
        const Eigen::Index next = next_sample(measured.profile.seconds[k]);
        for (const Eigen::Index n : {std::max<Eigen::Index>(next - 1, 0), std::min(next, values.cols() - 1)})
          if (values.col(n) != measured.values.col(n)) stale[k] = true;
      }
      context_.meter.renew(measured.profile, stale, clip_.original, decoded, threads());
    }
    if (values.cols() <= most_remembered) measured.values = std::move(values);
  }

  /// The first sample after a time, up to the number of samples.
  Eigen::Index next_sample(double seconds) const {
    const std::vector<float>& times = clip_.clip.times;
    return std::upper_bound(times.begin(), times.end(), seconds) - times.begin();
  }

  bool is_within_bound(const motion::ErrorProfile& profile) const {
    return *std::max_element(profile.max_error.begin(), profile.max_error.end()) <=
           kept_share * context_.bound.tolerance;
  }

  /// Where the error between two samples is `far` times the bound or more, what goes wrong there is set right on both
  /// sides; errors that are mended count as zero from then on.
  void mend_flips(motion::ErrorProfile& profile, double far, Mending mending, LevelClip& levels) const {
    const std::vector<std::vector<Flip>> runs = flips(profile, far);
    if (runs.empty()) return;
    Eigen::MatrixXd values = values_of_levels(levels, prepared_.steps, prepared_.layout.values.cols(), threads());
    const BetweenInput input{clip_, context_.frame, prepared_.layout, prepared_.steps, context_.meter};
    std::vector<std::vector<LevelAtom>> atoms(runs.size());
    const int tries = tries_of_each(runs);
    parallel_for(runs.size(), threads(), [&](std::size_t r) {
      for (const Flip& flip : runs[r])
        if (mend_between(input, flip.next, profile.seconds[flip.time], goal(), mending, tries, values, atoms[r]))
          profile.max_error[flip.time] = 0;
    });
    put_atoms(joined(atoms), levels.atoms);
    tidy_atoms(levels.atoms);
  }

  struct Flip {
    std::size_t time;   ///< of the profile
    Eigen::Index next;  ///< sample at or after it
  };

  /// How much is tried for each flip, so that all of them take no longer than measuring the clip a few times.
  int tries_of_each(const std::vector<std::vector<Flip>>& runs) const {
    constexpr int always = 1000, a_sample = 4;
    std::size_t flips = 0;
    for (const std::vector<Flip>& run : runs) flips += run.size();
    const std::size_t all = always + a_sample * clip_.clip.times.size();
    return static_cast<int>(std::min<std::size_t>(most_tries, all / flips));
  }

  /// Times whose error is `far` times the bound or more; those that share a sample are in one run.
  std::vector<std::vector<Flip>> flips(const motion::ErrorProfile& profile, double far) const {
    std::vector<std::vector<Flip>> runs;
    for (std::size_t k = 0; k < profile.seconds.size(); ++k) {
      if (!(profile.max_error[k] > far * context_.bound.tolerance)) continue;
      const Eigen::Index next = next_sample(profile.seconds[k]);
      if (next == 0 || next == std::ssize(clip_.clip.times)) continue;
      if (runs.empty() || next > runs.back().back().next + 1) runs.emplace_back();
      runs.back().push_back({k, next});
    }
    return runs;
  }

  /// Makes the samples next to each time above the bound stricter, by `least` or more.
  void tighten(const motion::ErrorProfile& profile, double least, SampleRow& strictness) const {
    constexpr double most = 1.5;  // at once
    const double bound = kept_share * context_.bound.tolerance;
    SampleRow factor = SampleRow::Ones(strictness.size());
    for (std::size_t k = 0; k < profile.seconds.size(); ++k) {
      if (profile.max_error[k] <= bound) continue;
      const Eigen::Index next = next_sample(profile.seconds[k]);
      const auto worse = static_cast<float>(std::clamp(profile.max_error[k] / goal(), least, std::max(least, most)));
      for (const Eigen::Index n : {next - 1, next})
        if (n >= 0 && n < strictness.size()) factor(n) = std::max(factor(n), worse);
    }
    strictness *= factor;
  }

  const SearchContext& context_;
  const PreparedClip& prepared_;
  const ClipSource& clip_;
  bool records_;
  double share_;
  Workbench& bench_;
};

}  // namespace

Workbench make_workbench(const TrialClip& clip, int threads) {
  return {MotionMap(clip.context.source.skeleton, clip.context.frame, clip.prepared.layout,
                    points_of(clip.context.source, clip.context.bound), clip.prepared.coded),
          threads};
}

Trial train_trial(const TrialClip& clip, const SparseSettings& settings, const TrainingState* start, Workbench& bench) {
  const PreparedClip& prepared = clip.prepared;
  TrainedClip trained = train_sparse({.layout = &prepared.layout,
                                      .steps = &prepared.steps,
                                      .offset = prepared.offset,
                                      .emphasis = prepared.emphasis,
                                      .tolerance = clip.context.bound.tolerance,
                                      .threads = bench.threads,
                                      .parts = clip.context.parts,
                                      .atoms = &prepared.jumps,
                                      .start = start},
                                     bench.map, settings);
  Trial trial{.settings = settings, .state = std::move(trained.state), .levels = std::move(trained.levels)};
  trial.levels.times = clip.source.clip.times;
  trial.levels.states = prepared.layout.states;
  const TrialWork work(clip, bench);
  trial.bytes = work.bytes_of(trial.levels);
  work.record(trial);
  return trial;
}

float usual_error(const TrialClip& clip, const LevelClip& levels, Workbench& bench) {
  return TrialWork(clip, bench).usual_error(levels);
}

void finish_trial(const TrialClip& clip, std::size_t limit, bool prunes, Workbench& bench, Trial& trial) {
  TrialWork(clip, bench).finish(limit, prunes, trial);
}

}  // namespace nmc::codec
