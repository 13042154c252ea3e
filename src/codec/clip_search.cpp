#include "codec/clip_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "codec/atoms.h"
#include "codec/between.h"
#include "codec/contacts.h"
#include "codec/corrections.h"
#include "codec/features.h"
#include "codec/jumps.h"
#include "codec/refinement.h"
#include "codec/set_steps.h"
#include "codec/windows.h"

namespace nmc::codec {
namespace {

/// The part of the tolerance that is aimed at: the rest covers what lies between samples and points.
constexpr double aim = 0.985;

constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

/// How long the search for one clip may take, by effort.
struct SearchPlan {
  int first_iterations = 100;  ///< of the first training of each cut
  int iterations = 100;        ///< of each later one, which starts where the best one ended
  int trials = 8;              ///< later trainings
  int last_iterations = 0;     ///< of one more at the best settings
  bool prunes = true;          ///< takes from what is within the bound what the bound can do without
};

/// Long clips have more to learn from in each training and get fewer of them, so that time stays linear.
SearchPlan plan_of(int effort, std::size_t samples) {
  const int fewer = static_cast<int>(std::clamp<std::size_t>(samples / 160, 1, 5));
  if (effort <= 1) return {30, 20, 0, 0, false};
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
constexpr std::size_t short_samples = 120;

/// Bases and windows worth trying for a clip. Most clips with jumps are smaller when these are taken out first.
std::vector<SparseSettings> cuts_of(const SearchContext& context, const PreparedClip& clip, int effort, int threads) {
  std::vector<SparseSettings> cuts;
  const auto samples = static_cast<std::size_t>(clip.layout.values.cols());
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
    cuts.push_back({.basis = Basis::sine, .boundaries = even_windows(samples, 128)});
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

/// A trained, corrected candidate.
struct Trial {
  SparseSettings settings;
  TrainingState state;
  std::size_t bytes = unlimited;
  bool kept = false;  ///< within the tolerance

  bool beats(const Trial& other) const { return kept != other.kept ? kept : bytes < other.bytes; }
};

class ClipSearch {
 public:
  ClipSearch(const SearchContext& context, int effort, const PreparedClip& prepared, std::size_t index,
             std::vector<Candidate>* tried)
      : context_(context),
        effort_(effort),
        tried_(tried),
        prepared_(prepared),
        clip_(context.source.clips[index]),
        plan_(plan_of(effort, clip_.clip.times.size())),
        threads_(clip_.clip.times.size() < worth_threads ? 1 : context.threads),
        map_(context.source.skeleton, context.frame, prepared.layout, points_of(context.source, context.bound),
             prepared.coded) {}

  LevelClip run() {
    const bool from_each_cut = effort_ > 5;
    Trial current = best_cut(from_each_cut);
    const bool searched = from_each_cut && current.kept;
    if (!current.kept) current = first_within_bound(current);
    if (current.kept && !searched) descend(current);
    if (plan_.last_iterations > 0 && current.kept) {
      SparseSettings last = current.settings;
      last.iterations = plan_.last_iterations;
      offer(last, &current.state, best_bytes_);
    }
    if (best_) return *best_;
    SparseSettings plain = current.settings;
    plain.iterations = 0;
    plain.jumps = false;
    plain.step_exponent = finest;
    return levels_for(plain, nullptr).levels;
  }

  /// Of what run found; the largest number where nothing is within the bound.
  std::size_t bytes() const { return best_bytes_; }

 private:
  static constexpr std::size_t worth_threads = 1000;  ///< samples from which threads gain more than they cost
  static constexpr int stride = 3;                    ///< of the search, in quarters of an octave of step size
  static constexpr int finest = 24;                   ///< step exponent
  /// Usual errors, after training and after its repair, from which corrections never make the smallest candidate.
  static constexpr float hopeless = 1.2f, hopeless_repaired = 1.07f;
  static constexpr double worth_pruning = 1.04;  ///< of the smallest candidate's bytes

  /// The best of the first trainings of all cuts, or of what is found from each of them.
  Trial best_cut(bool from_each_cut) {
    Trial best;
    for (SparseSettings& settings : cuts_of(context_, prepared_, effort_, threads_)) {
      const bool is_long = clip_.clip.times.size() > short_samples;
      settings.step_exponent = is_long ? -3 : 1;
      settings.rate = is_long ? 0.3 : 0.2;
      settings.iterations = plan_.first_iterations;
      Trial trial = offer(settings, nullptr, from_each_cut ? unlimited : best_bytes_);
      if (from_each_cut && trial.kept) descend(trial);
      if (best.settings.boundaries.empty() || trial.beats(best)) best = std::move(trial);
    }
    return best;
  }

  Trial neighbour(const Trial& current, int exponent, double rate, int iterations) {
    SparseSettings settings = current.settings;
    settings.step_exponent += exponent;
    settings.rate *= rate;
    settings.iterations = iterations;
    return offer(settings, &current.state, current.kept ? current.bytes : best_bytes_);
  }

  /// Finer steps until the bound is kept; at last without training and without jumps.
  Trial first_within_bound(const Trial& coarse) {
    Trial trial = coarse;
    for (int k = 0; k < 4 && !trial.kept; ++k) trial = neighbour(trial, stride, 0.8, plan_.first_iterations);
    SparseSettings plain = coarse.settings;
    plain.iterations = 0;
    plain.jumps = false;
    plain.rate = 0.05;  // of the trainings that go on from here
    for (plain.step_exponent = 4; !trial.kept && plain.step_exponent <= finest; plain.step_exponent += 4)
      trial = offer(plain, nullptr, best_bytes_);
    return trial;
  }

  /// Whichever neighbour is smaller, as long as there is one.
  void descend(Trial& current) {
    struct Move {
      int exponent;
      double rate;
    };
    constexpr std::array<Move, 4> all{{{-stride, 1}, {0, 2}, {0, 0.5}, {stride, 1}}};
    // Finer steps hardly ever make a smaller clip.
    const std::span<const Move> moves(all.data(), effort_ > 5 ? 4 : 3);
    int left = plan_.trials;
    for (std::size_t failed = 0, at = 0; failed < moves.size() && left > 0; --left) {
      Trial trial = neighbour(current, moves[at].exponent, moves[at].rate, plan_.iterations);
      if (trial.beats(current)) {
        current = std::move(trial);
        failed = 0;
      } else {
        ++failed;
        at = (at + 1) % moves.size();
      }
    }
  }

  TrainedClip levels_for(const SparseSettings& settings, const TrainingState* start) {
    TrainedClip trained = train_sparse({.layout = &prepared_.layout,
                                        .steps = &prepared_.steps,
                                        .offset = &prepared_.offset,
                                        .emphasis = &prepared_.emphasis,
                                        .tolerance = context_.bound.tolerance,
                                        .threads = threads_,
                                        .parts = context_.parts,
                                        .atoms = &prepared_.jumps,
                                        .start = start},
                                       map_, settings);
    trained.levels.times = clip_.clip.times;
    trained.levels.states = prepared_.layout.states;
    return trained;
  }

  /// Trains and corrects what may get below `limit` bytes, and keeps the result if it is the smallest.
  Trial offer(SparseSettings settings, const TrainingState* start, std::size_t limit) {
    Trial trial{settings, {}, unlimited, false};
    if (context_.is_late()) {
      if (best_) return trial;
      settings.iterations = 0;
    }
    TrainedClip trained = levels_for(settings, start);
    trial.state = std::move(trained.state);
    LevelClip& levels = trained.levels;
    trial.bytes = bytes_of(levels);
    record(settings, levels, trial.bytes, false);
    if (trial.bytes >= limit) return trial;
    // An atom costs about 14 bits; more bytes of them than of weights are a sign of steps that are too coarse.
    const std::size_t room =
        levels.atoms.size() + 20 +
        std::min(trial.bytes, limit < unlimited ? limit - trial.bytes : levels.times.size() * 14 / 8) * 8 / 14;
    if (settings.iterations > 0 && context_.parts.refinement) {
      if (usual_error(levels) > hopeless) return trial;
      repair(levels, prepared_.layout, prepared_.steps, map_, prepared_.wanted, aim * context_.bound.tolerance * 0.99,
             threads_);
      if (usual_error(levels) > hopeless_repaired) return trial;
    }
    trial.kept = bring_within_bound(levels, room);
    const std::size_t was = bytes_of(levels);
    if (trial.kept && plan_.prunes && context_.parts.refinement &&
        static_cast<double>(was) < worth_pruning * static_cast<double>(limit)) {
      LevelClip pruned = levels;
      prune(pruned, prepared_.layout, prepared_.steps, map_, prepared_.wanted, aim * context_.bound.tolerance,
            threads_);
      const bool ok = bring_within_bound(pruned, room);
      if (ok && bytes_of(pruned) < was) levels = std::move(pruned);
    }
    trial.bytes = bytes_of(levels);
    record(settings, levels, trial.bytes, trial.kept);
    if (!trial.kept || trial.bytes >= best_bytes_) return trial;
    best_bytes_ = trial.bytes;
    best_ = std::move(levels);
    return trial;
  }

  void record(const SparseSettings& settings, const LevelClip& levels, std::size_t bytes, bool kept) const {
    if (!tried_) return;
    const motion::ErrorProfile profile = error_profile(levels);
    tried_->push_back({bytes, *std::max_element(profile.max_error.begin(), profile.max_error.end()), kept, false,
                       basis_name(settings.basis), settings.jumps});
  }

  /// The median over the samples of the largest error, in units of the tolerance.
  float usual_error(const LevelClip& levels) const {
    const Eigen::MatrixXd values = values_of_levels(levels, prepared_.steps, prepared_.layout.values.cols());
    const Rows error = map_.positions(values, threads_) - prepared_.wanted;
    SampleRow largest = SampleRow::Zero(error.cols());
    for (Eigen::Index q = 0; q < map_.seen_count(); ++q)
      largest = largest.max(error.middleRows(map_.first_row(q), map_.row_count(q)).square().colwise().sum());
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

  /// Corrects; measures what the levels mean between the file's keys and at every vertex; where that is above the
  /// bound, corrects the samples around it further.
  bool bring_within_bound(LevelClip& levels, std::size_t most_atoms) {
    if (!context_.parts.corrections) return is_within_bound(error_profile(levels));
    constexpr int rounds = 8, first_rounds = 3;
    SampleRow strictness = SampleRow::Ones(prepared_.layout.values.cols());
    for (int round = 0; round < rounds; ++round) {
      if (!correct(levels, prepared_.layout, prepared_.steps, map_, prepared_.wanted, aim * context_.bound.tolerance,
                   strictness, most_atoms, threads_))
        return false;
      if (context_.exact_ends)
        restore_ends(levels);
      else if (prepared_.loops && round < rounds / 2)  // better a seam than no end
        close_seam(levels);
      motion::ErrorProfile profile = error_profile(levels);
      if (is_within_bound(profile)) return true;
      mend_flips(profile, round < first_rounds ? 1.5 : 1, levels);
      // What is corrected next may break what has just been mended.
      if (round >= first_rounds && is_within_bound(error_profile(levels))) return true;
      tighten(profile, 1 + 0.1 * round, strictness);
    }
    return false;
  }

  /// Atoms that make the first and the last pose what they were.
  void restore_ends(LevelClip& levels) const {
    const Eigen::Index samples = prepared_.layout.values.cols();
    const Eigen::MatrixXd values = values_of_levels(levels, prepared_.steps, samples);
    for (const Eigen::Index end : {Eigen::Index{0}, samples - 1})
      for (const std::vector<LevelAtom>& atoms : missing_by_target(prepared_.layout, prepared_.steps, end, 1, values))
        for (const LevelAtom& atom : atoms) put_atom(atom, levels.atoms);
    tidy_atoms(levels.atoms);
  }

  /// What atoms change at one end of a loop they change at the other as well, or they would open the seam that the
  /// anchors close. The less corrected end follows: the other one needs what it has.
  void close_seam(LevelClip& levels) const {
    const Eigen::Index last = prepared_.layout.values.cols() - 1;
    const Eigen::VectorXd signs = end_signs(prepared_.layout);
    mirror_atoms(levels, last, signs);
    const Eigen::VectorXd at_first = atom_levels(levels, 0), at_last = atom_levels(levels, last);
    const bool first_leads = at_first.cwiseAbs().sum() > at_last.cwiseAbs().sum();
    const Eigen::VectorXd change =
        first_leads ? signs.cwiseProduct(at_first) - at_last : signs.cwiseProduct(at_last) - at_first;
    const auto follower = static_cast<std::uint32_t>(first_leads ? last : 0);
    for (Eigen::Index i = 0; i < change.size(); ++i)
      if (const auto level = static_cast<std::int32_t>(std::lround(change(i))); level != 0)
        put_atom({follower, static_cast<int>(i), 0, level}, levels.atoms);
    tidy_atoms(levels.atoms);
  }

  /// An atom that only overlaps an end adds a part of a step there, which no atom of the other end's own could: it gets
  /// its mirror image.
  static void mirror_atoms(LevelClip& levels, Eigen::Index last, const Eigen::VectorXd& signs) {
    std::vector<LevelAtom> images;
    for (const LevelAtom& atom : levels.atoms) {
      if (atom.width == LevelAtom::jump_width) continue;
      const auto at = static_cast<Eigen::Index>(atom.sample);
      const Eigen::Index away = std::min(at, last - at);
      if (away == 0 || away >= Eigen::Index{1} << atom.width) continue;
      LevelAtom image = atom;
      image.sample = static_cast<std::uint32_t>(last - at);
      if (signs(atom.parameter) < 0) image.level = -image.level;
      const bool has_image = std::any_of(levels.atoms.begin(), levels.atoms.end(), [&](const LevelAtom& other) {
        return other.sample == image.sample && other.parameter == image.parameter && other.width == image.width;
      });
      if (!has_image) images.push_back(image);
    }
    for (const LevelAtom& image : images) put_atom(image, levels.atoms);
  }

  /// What atoms add to each parameter at one end of the clip, in their steps.
  Eigen::VectorXd atom_levels(const LevelClip& levels, Eigen::Index sample) const {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(prepared_.layout.values.rows());
    for (const LevelAtom& atom : levels.atoms)
      if (atom.width != LevelAtom::jump_width)
        sum(atom.parameter) +=
            atom.level * atom_share(std::abs(sample - static_cast<Eigen::Index>(atom.sample)), atom.width);
    return sum;
  }

  motion::ErrorProfile error_profile(const LevelClip& levels) const {
    const Eigen::MatrixXd values = values_of_levels(levels, prepared_.steps, prepared_.layout.values.cols());
    return context_.meter.profile(
        clip_.original, with_kept(clip_, clip_of_parameters(clip_.clip, context_.frame, prepared_.layout, values)),
        threads_);
  }

  bool is_within_bound(const motion::ErrorProfile& profile) const {
    return *std::max_element(profile.max_error.begin(), profile.max_error.end()) <=
           kept_share * context_.bound.tolerance;
  }

  /// Where the error between two samples is `far` times the bound or more, what goes wrong there is set right on both
  /// sides; errors that are mended count as zero from then on.
  void mend_flips(motion::ErrorProfile& profile, double far, LevelClip& levels) const {
    const std::vector<float>& times = clip_.clip.times;
    Eigen::MatrixXd values;
    for (std::size_t k = 0; k < profile.seconds.size(); ++k) {
      if (!(profile.max_error[k] > far * context_.bound.tolerance)) continue;
      const auto next = std::upper_bound(times.begin(), times.end(), profile.seconds[k]) - times.begin();
      if (next == 0 || next == std::ssize(times)) continue;
      if (values.size() == 0) values = values_of_levels(levels, prepared_.steps, prepared_.layout.values.cols());
      if (mend_between({clip_, context_.frame, prepared_.layout, prepared_.steps, context_.meter}, next,
                       profile.seconds[k], aim * context_.bound.tolerance, values, levels))
        profile.max_error[k] = 0;
    }
    tidy_atoms(levels.atoms);
  }

  /// Makes the samples next to each time above the bound stricter, by `least` or more.
  void tighten(const motion::ErrorProfile& profile, double least, SampleRow& strictness) const {
    constexpr double most = 1.5;  // at once
    const double bound = kept_share * context_.bound.tolerance, goal = aim * context_.bound.tolerance;
    const std::vector<float>& times = clip_.clip.times;
    SampleRow factor = SampleRow::Ones(strictness.size());
    for (std::size_t k = 0; k < profile.seconds.size(); ++k) {
      if (profile.max_error[k] <= bound) continue;
      const auto next = std::upper_bound(times.begin(), times.end(), profile.seconds[k]) - times.begin();
      const auto worse = static_cast<float>(std::clamp(profile.max_error[k] / goal, least, std::max(least, most)));
      for (const std::ptrdiff_t n : {next - 1, next})
        if (n >= 0 && n < strictness.size()) factor(n) = std::max(factor(n), worse);
    }
    strictness *= factor;
  }

  const SearchContext& context_;
  int effort_;
  std::vector<Candidate>* tried_;
  const PreparedClip& prepared_;
  const ClipSource& clip_;
  SearchPlan plan_;
  int threads_;
  MotionMap map_;
  std::optional<LevelClip> best_;
  std::size_t best_bytes_ = unlimited;
};

/// Whether the last pose is the first one again, as motion::ErrorReport means it.
bool is_loop(const Rows& positions, Eigen::Index points, double size) {
  constexpr Eigen::Index fewest = 8;
  if (positions.cols() < fewest) return false;
  const Rows gap = (positions.rightCols(1) - positions.leftCols(1)).square();
  float most = 0;
  for (Eigen::Index q = 0; q < points; ++q) most = std::max(most, gap.middleRows(3 * q, 3).sum());
  for (Eigen::Index morph = 3 * points; morph < gap.rows(); ++morph) most = std::max(most, gap(morph, 0));
  return std::sqrt(static_cast<double>(most)) <= motion::loop_gap * size;
}

}  // namespace

PreparedClip prepare_clip(const SearchContext& context, std::size_t index, double contact_weight) {
  PreparedClip clip;
  const motion::Clip& motion = context.source.clips[index].clip;
  clip.layout = layout_clip(motion, context.frame);
  clip.steps = steps_for(context.set, clip.layout);
  clip.jumps = find_jumps(clip.layout, clip.steps);
  Eigen::MatrixXd coded = clip.layout.values;
  for (Eigen::Index i = 0; i < coded.rows(); ++i)
    if (!clip.layout.parameters[static_cast<std::size_t>(i)].moves)
      coded.row(i).setConstant(fixed_level(clip.layout, clip.steps, i) * clip.steps.anchor(i));
  const Points& points = points_of(context.source, context.bound);
  const auto positions = [&](const Eigen::MatrixXd& fixed) {
    return MotionMap(context.source.skeleton, context.frame, clip.layout, points, fixed).positions(clip.layout.values);
  };
  clip.wanted = positions(clip.layout.values);
  clip.offset = in_blocks(positions(coded) - clip.wanted);
  clip.coded = coded.col(0);
  clip.loops = is_loop(clip.wanted, static_cast<Eigen::Index>(points.size()), context.source.size);
  clip.emphasis =
      in_blocks(contact_emphasis(clip.wanted, points.size(), motion.times, context.source.size, contact_weight));
  return clip;
}

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
