#include "codec/standard_profile.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <optional>

#include "base/parallel.h"
#include "codec/clip_layout.h"
#include "codec/corrections.h"
#include "codec/motion_map.h"
#include "codec/sparse_training.h"
#include "motion/error.h"

namespace nmc::codec {
namespace {

/// Anchors' steps are this much finer than slots' (2^(-exponent / 4)).
constexpr int anchor_exponent = 10;

/// The part of the tolerance that is aimed at: the rest covers what lies between samples and points.
constexpr double aim = 0.985;

/// How long the search for one clip may take, by effort.
struct SearchPlan {
  int first_iterations = 100;  ///< of the first training of each cut
  int iterations = 200;        ///< of all later ones
  int climbs = 4;              ///< trainings that look for the best step
  int rates = 2;               ///< trainings that look for the best weight of a bit
};

SearchPlan plan_of(int effort) {
  if (effort <= 1) return {80, 80, 1, 0};
  if (effort <= 3) return {100, 150, 2, 0};
  if (effort <= 5) return {120, 250, 4, 2};
  if (effort <= 7) return {250, 500, 6, 4};
  return {500, 1200, 8, 6};
}

std::vector<std::uint32_t> even_windows(std::size_t samples, std::size_t length) {
  const std::size_t last = samples - 1;
  const std::size_t windows = std::max<std::size_t>(1, (last + length / 2) / length);
  std::vector<std::uint32_t> boundaries;
  for (std::size_t k = 0; k <= windows; ++k) boundaries.push_back(static_cast<std::uint32_t>(k * last / windows));
  return boundaries;
}

/// Bases and window cuts worth trying for a clip.
std::vector<SparseSettings> cuts_of(std::size_t samples) {
  std::vector<SparseSettings> cuts;
  const auto whole = static_cast<std::uint32_t>(samples);
  if (samples <= 400) cuts.push_back({Basis::cosine, {0, whole}, 0, 0, 0, 1});
  if (samples >= 8 && samples <= 400) cuts.push_back({Basis::periodic, {0, whole - 1}, 0, 0, 0, 1});
  if (samples > 200) cuts.push_back({Basis::sine, even_windows(samples, 128), 0, 0, 0, 1});
  return cuts;
}

/// A clip in the set's parameters, with where its points should be.
struct Prepared {
  ClipLayout layout;
  ParameterSteps steps;
  Eigen::MatrixXd coded;  ///< the layout's values, fixed targets as they are coded
  Rows wanted;            ///< positions of all points
  Rows offset;            ///< what the rounding of fixed targets moves the training's points by
};

/// Every joint and, for each node, its few points that lie farthest apart: enough to train on.
Points thin(const Points& points, std::size_t per_node) {
  std::map<int, std::vector<std::size_t>> of_node;
  Points thinned;
  thinned.morphs = points.morphs;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto first = points.influences.begin() + points.first[i],
               last = points.influences.begin() + points.first[i + 1];
    const auto leading =
        std::max_element(first, last, [](const Influence& a, const Influence& b) { return a.weight < b.weight; });
    of_node[leading->node].push_back(i);
  }
  const auto place = [&](std::size_t i) {
    const auto first = points.influences.begin() + points.first[i],
               last = points.influences.begin() + points.first[i + 1];
    const auto leading =
        std::max_element(first, last, [](const Influence& a, const Influence& b) { return a.weight < b.weight; });
    return glm::dvec3(leading->offset[0], leading->offset[1], leading->offset[2]);
  };
  for (const auto& [node, members] : of_node) {
    std::vector<glm::dvec3> chosen{glm::dvec3(0.0)};
    std::vector<bool> taken(members.size());
    for (std::size_t round = 0; round < std::min(per_node, members.size()); ++round) {
      std::size_t best = 0;
      double farthest = -1;
      for (std::size_t k = 0; k < members.size(); ++k) {
        double nearest = std::numeric_limits<double>::max();
        for (const glm::dvec3& other : chosen) nearest = std::min(nearest, glm::distance(other, place(members[k])));
        if (!taken[k] && nearest > farthest) {
          farthest = nearest;
          best = k;
        }
      }
      taken[best] = true;
      chosen.push_back(place(members[best]));
      const std::size_t i = members[best];
      thinned.add(points.influences.data() + points.first[i], points.influences.data() + points.first[i + 1]);
    }
  }
  return thinned;
}

std::int32_t to_level(double value, double step) { return static_cast<std::int32_t>(std::lround(value / step)); }

}  // namespace

struct StandardEncoder::State {
  const Source& source;
  const CompressOptions& options;
  motion::ErrorMeter meter;
  SetFrame frame;
  ClipSet set;  ///< targets, steps and references; clips of the whole file, in order
  Points training_points;
  std::vector<Prepared> prepared;  ///< per clip
  std::vector<double> seconds;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();

  /// The user's time limit has passed: no clip looks any further than its first result.
  bool is_late() const {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    return options.time_limit_seconds > 0 && spent.count() > options.time_limit_seconds;
  }

  State(const Source& s, const CompressOptions& o)
      : source(s), options(o), meter(s.skeleton, s.all_points), training_points(thin(s.points, 4)) {}

  void make_set();
  void prepare(Prepared& clip) const;
  ParameterSteps steps_for(const ClipLayout& layout) const;
  std::size_t bytes_of(const LevelClip& clip) const;
  LevelClip train(std::size_t clip) const;
  bool within_bound(std::size_t clip, LevelClip& levels, std::size_t most_atoms) const;
  void choose_references(ClipSet& chosen) const;
};

ParameterSteps StandardEncoder::State::steps_for(const ClipLayout& layout) const {
  const auto count = static_cast<Eigen::Index>(layout.parameters.size());
  ParameterSteps steps{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Parameter& parameter = layout.parameters[static_cast<std::size_t>(i)];
    steps.slot(i) = slot_step(set, set.targets[parameter.target], parameter.axis);
    steps.anchor(i) = anchor_step(set, set.targets[parameter.target], parameter.axis);
  }
  return steps;
}

void StandardEncoder::State::prepare(Prepared& clip) const {
  clip.steps = steps_for(clip.layout);
  clip.coded = clip.layout.values;
  for (Eigen::Index i = 0; i < clip.coded.rows(); ++i)
    if (!clip.layout.parameters[static_cast<std::size_t>(i)].moves)
      clip.coded.row(i).setConstant(fixed_level(clip.layout, clip.steps, i) * clip.steps.anchor(i));
  const MotionMap exact(source.skeleton, frame, clip.layout, source.points, clip.layout.values);
  clip.wanted = exact.positions(clip.layout.values);
  const MotionMap exact_training(source.skeleton, frame, clip.layout, training_points, clip.layout.values);
  const MotionMap coded_training(source.skeleton, frame, clip.layout, training_points, clip.coded);
  clip.offset = coded_training.positions(clip.layout.values) - exact_training.positions(clip.layout.values);
}

/// Steps from how far a unit of each parameter moves the farthest point; the reference pose in whole steps.
void StandardEncoder::State::make_set() {
  std::vector<const motion::Clip*> clips;
  for (const ClipSource& clip : source.clips) clips.push_back(&clip.clip);
  frame = mean_frame(source.skeleton, clips);
  std::vector<std::vector<double>> square(frame.targets.size(), std::vector<double>(4, 0.0));
  std::vector<std::vector<double>> weight(frame.targets.size(), std::vector<double>(4, 0.0));
  std::vector<Eigen::VectorXd> reaches(clips.size());
  std::vector<ClipLayout> layouts(clips.size());
  parallel_for(clips.size(), options.threads, [&](std::size_t c) {
    layouts[c] = layout_clip(*clips[c], frame);
    MotionMap map(source.skeleton, frame, layouts[c], training_points, layouts[c].values, FreeParameters::all);
    map.linearise(layouts[c].values);
    reaches[c] = map.reach();
  });
  for (auto& w : square) w.resize(64, 0.0);
  for (auto& w : weight) w.resize(64, 0.0);
  for (std::size_t c = 0; c < clips.size(); ++c)
    for (std::size_t i = 0; i < layouts[c].parameters.size(); ++i) {
      const Parameter& parameter = layouts[c].parameters[i];
      const auto axis = static_cast<std::size_t>(std::min(parameter.axis, 63));
      const double samples = static_cast<double>(layouts[c].values.cols());
      const double reach = reaches[c](static_cast<Eigen::Index>(i));
      square[parameter.target][axis] += samples * reach * reach;
      weight[parameter.target][axis] += samples;
    }
  set.base_step = static_cast<float>(source.tolerance / source.size);
  set.anchor_exponent = anchor_exponent;
  for (std::size_t t = 0; t < frame.targets.size(); ++t) {
    const NodeTarget& target = frame.targets[t];
    SetTarget made{target.path, target.width, {}, {}, {}};
    for (int a = 0; a < target.width; ++a) {
      const auto k = static_cast<std::size_t>(std::min(a, 63));
      const double reach = weight[t][k] > 0 ? std::sqrt(square[t][k] / weight[t][k]) : 0.0;
      const double least = target.path == Path::translation ? 1e-3 : 0.01 * source.size;
      const double relative = std::max(reach, least) / source.size;
      made.step_exponents.push_back(std::clamp(static_cast<int>(std::lround(2 * std::log2(relative))), -100, 100));
    }
    if (target.path == Path::rotation) {
      made.step_exponents[3] = made.step_exponents[2];  // the format stores three
      const glm::dvec3 v = motion::rotation_vector(frame.rotation_reference[t]);
      glm::dvec3 quantised(0.0);
      for (int a = 0; a < 3; ++a) {
        const double step = anchor_step(set, made, a);
        made.reference.push_back(to_level(v[a], step));
        quantised[a] = static_cast<float>(static_cast<float>(made.reference.back()) * step);
      }
      frame.rotation_reference[t] = motion::rotation_of_vector(quantised);
    } else {
      for (int a = 0; a < target.width; ++a) {
        const double step = anchor_step(set, made, a), usual = target.path == Path::scale ? 1.0 : 0.0;
        made.reference.push_back(to_level(frame.value_reference[t][static_cast<std::size_t>(a)] - usual, step));
        frame.value_reference[t][static_cast<std::size_t>(a)] = usual + made.reference.back() * step;
      }
    }
    set.targets.push_back(std::move(made));
  }
  prepared.resize(clips.size());
  parallel_for(clips.size(), options.threads, [&](std::size_t c) {
    prepared[c].layout = layout_clip(*clips[c], frame);
    prepare(prepared[c]);
  });
}

std::size_t StandardEncoder::State::bytes_of(const LevelClip& clip) const {
  ClipSet alone = set;
  alone.clips = {clip};
  const PartBits bits = count_bits(alone);
  return static_cast<std::size_t>((bits.anchors + bits.weights + bits.atoms) / 8) + 1;
}

/// Measures what the levels mean between the file's keys and at every vertex; where that is above the bound, corrects
/// further.
bool StandardEncoder::State::within_bound(std::size_t index, LevelClip& levels, std::size_t most_atoms) const {
  const ClipSource& clip = source.clips[index];
  const Prepared& from = prepared[index];
  MotionMap map(source.skeleton, frame, from.layout, source.points, from.coded);
  double bound = aim * source.tolerance;
  for (int round = 0; round < 6; ++round) {
    const bool okk = correct(levels, from.layout, from.steps, map, from.wanted, bound, most_atoms);
    if (!okk) return false;
    const Eigen::MatrixXd values = values_of_levels(levels, from.steps, from.layout.values.cols());
    Animation decoded = motion::to_animation(clip_of_parameters(clip.clip, frame, from.layout, values));
    decoded.curves.insert(decoded.curves.end(), clip.kept.curves.begin(), clip.kept.curves.end());
    const std::vector<double> errors = meter.profile(clip.original, decoded).max_error;
    const double largest = *std::max_element(errors.begin(), errors.end());
    if (largest <= 0.999 * source.tolerance) return true;
    bound *= 0.99 * source.tolerance / largest;
  }
  return false;
}

/// The search for one clip's best levels: cuts, then steps, then the weight of a bit, each by real bytes at a kept
/// bound.
class ClipSearch {
 public:
  ClipSearch(const StandardEncoder::State& state, std::size_t index)
      : state_(state),
        index_(index),
        map_(state.source.skeleton, state.frame, state.prepared[index].layout, state.training_points,
             state.prepared[index].coded) {}

  LevelClip run() {
    const std::size_t samples = state_.source.clips[index_].clip.times.size();
    const SearchPlan plan = plan_of(state_.options.effort);
    const std::vector<SparseSettings> cuts = cuts_of(samples);
    const int start = samples > 120 ? -3 : 1;
    std::vector<std::size_t> bytes;
    for (const SparseSettings& cut : cuts)
      bytes.push_back(offer(cut, start, usual_rate, cuts.size() > 1 ? plan.first_iterations : plan.iterations));
    const SparseSettings& cut =
        cuts[static_cast<std::size_t>(std::min_element(bytes.begin(), bytes.end()) - bytes.begin())];
    climb(cut, start, plan);
    // Where even that is not within the bound, finer and finer steps without training.
    for (int exponent = 4; !best_ && exponent <= 24; exponent += 4) offer(cut, exponent, 0, 0);
    if (best_) return *best_;
    return levels_for(cut, 24, 0, 0);
  }

 private:
  static constexpr double usual_rate = 0.2;

  LevelClip levels_for(SparseSettings cut, int exponent, double rate, int iterations) {
    const Prepared& from = state_.prepared[index_];
    cut.tolerance = state_.source.tolerance;
    cut.step_exponent = exponent;
    cut.rate = rate;
    cut.iterations = iterations;
    LevelClip levels = train_sparse({&from.layout, &from.steps, &from.offset}, map_, cut);
    levels.times = state_.source.clips[index_].clip.times;
    levels.states = from.layout.states;
    return levels;
  }

  /// Trains, corrects, and keeps the result if it is the smallest. Returns its bytes, or more where it is not within
  /// the bound.
  std::size_t offer(const SparseSettings& cut, int exponent, double rate, int iterations) {
    if (state_.is_late()) {
      if (best_) return std::numeric_limits<std::size_t>::max();
      iterations = 0;
    }
    LevelClip levels = levels_for(cut, exponent, rate, iterations);
    const std::size_t plain = state_.bytes_of(levels);
    if (plain >= best_bytes_) return plain;
    const std::size_t room = best_ ? (best_bytes_ - plain) * 8 / 14 : 20 + 2 * levels.times.size();
    const bool kept = state_.within_bound(index_, levels, room);
    const std::size_t bytes = state_.bytes_of(levels);
    if (!kept)
      return std::max(bytes, best_bytes_ == std::numeric_limits<std::size_t>::max() ? 2 * bytes : best_bytes_ + 1);
    if (bytes < best_bytes_) {
      best_bytes_ = bytes;
      best_ = std::move(levels);
    }
    return bytes;
  }

  void climb(const SparseSettings& cut, int start, const SearchPlan& plan) {
    int left = plan.climbs;
    int exponent = start;
    std::size_t least = offer(cut, start, usual_rate, plan.iterations);
    for (const int direction : {-3, 3}) {
      bool moved = false;
      while (left-- > 0) {
        const std::size_t bytes = offer(cut, exponent + direction, usual_rate, plan.iterations);
        if (bytes >= least) break;
        least = bytes;
        exponent += direction;
        moved = true;
      }
      if (moved) break;
    }
    left = plan.rates;
    double rate = usual_rate;
    for (const double factor : {2.0, 0.5}) {
      bool moved = false;
      while (left-- > 0) {
        const std::size_t bytes = offer(cut, exponent, rate * factor, plan.iterations);
        if (bytes >= least) break;
        least = bytes;
        rate *= factor;
        moved = true;
      }
      if (moved) break;
    }
  }

  const StandardEncoder::State& state_;
  std::size_t index_;
  MotionMap map_;
  std::optional<LevelClip> best_;
  std::size_t best_bytes_ = std::numeric_limits<std::size_t>::max();
};

LevelClip StandardEncoder::State::train(std::size_t index) const { return ClipSearch(*this, index).run(); }

StandardEncoder::StandardEncoder(const Source& source, const CompressOptions& options)
    : state_(std::make_unique<State>(source, options)) {
  if (source.clips.empty()) return;
  state_->make_set();
  state_->set.clips.resize(source.clips.size());
  state_->seconds.resize(source.clips.size());
  std::mutex lock;
  std::size_t done = 0;
  parallel_for(source.clips.size(), options.threads, [&](std::size_t i) {
    const auto start = std::chrono::steady_clock::now();
    state_->set.clips[i] = state_->train(i);
    state_->seconds[i] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!options.progress) return;
    const std::lock_guard guard(lock);
    options.progress(static_cast<double>(++done) / static_cast<double>(source.clips.size()), source.clips[i].name);
  });
}

StandardEncoder::~StandardEncoder() = default;

EncodedSet StandardEncoder::encode(const std::vector<std::size_t>& clips) {
  EncodedSet encoded;
  encoded.targets = state_->frame.targets;
  ClipSet chosen = state_->set;
  chosen.clips.clear();
  for (const std::size_t i : clips) {
    chosen.clips.push_back(state_->set.clips[i]);
    encoded.seconds.push_back(state_->seconds[i]);
    int most = 0;
    for (const LevelWindow& window : chosen.clips.back().windows)
      for (const LevelWeight& weight : window.weights) most = std::max(most, weight.feature);
    encoded.frequencies.push_back(most);
  }
  state_->choose_references(chosen);
  encoded.clips = clips;
  encoded.stream = write_clip_set(chosen);
  return encoded;
}

/// Each clip's first anchor pose is predicted from the earlier clip whose last one is nearest, in bits.
void StandardEncoder::State::choose_references(ClipSet& chosen) const {
  const auto pose_of = [&](const LevelClip& clip, bool last) {
    std::vector<std::int32_t> pose;
    std::size_t parameters = 0;
    for (std::size_t t = 0; t < chosen.targets.size(); ++t)
      parameters += static_cast<std::size_t>(parameter_count(chosen.targets[t], clip.states[t]));
    std::size_t at = last && parameters ? clip.anchors.size() - parameters : 0;
    for (std::size_t t = 0; t < chosen.targets.size(); ++t) {
      const int count = parameter_count(chosen.targets[t], clip.states[t]);
      for (int a = 0; a < chosen.targets[t].width; ++a)
        pose.push_back(a < count && clip.states[t] != codec::State::quaternion
                           ? clip.anchors[at + static_cast<std::size_t>(a)]
                           : 0);
      at += static_cast<std::size_t>(count);
    }
    return pose;
  };
  std::vector<std::vector<std::int32_t>> ends;
  for (LevelClip& clip : chosen.clips) {
    const std::vector<std::int32_t> first = pose_of(clip, false);
    double least = std::numeric_limits<double>::max();
    for (int r = -1; r < static_cast<int>(ends.size()); ++r) {
      double bits = 0;
      for (std::size_t i = 0; i < first.size(); ++i)
        bits += std::log2(1.0 + 3.0 * std::pow(first[i] - (r < 0 ? 0 : ends[static_cast<std::size_t>(r)][i]), 2));
      if (bits < least) {
        least = bits;
        clip.reference = r;
      }
    }
    ends.push_back(pose_of(clip, true));
  }
}

}  // namespace nmc::codec
