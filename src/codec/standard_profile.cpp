#include "codec/standard_profile.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "codec/clip_search.h"
#include "codec/set_steps.h"

namespace nmc::codec {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

StandardEncoder::StandardEncoder(const Source& source, const CompressOptions& options,
                                 const std::vector<std::size_t>& clips, int precision) {
  const auto start = std::chrono::steady_clock::now();
  const std::size_t count = clips.size();
  if (count == 0) return;
  const Bound& bound = source.bounds[source.clips[clips.front()].bound];
  const motion::ErrorMeter meter(source.skeleton, all_points_of(source, bound));
  SharedPart shared = make_shared_part(source, clips, precision, options.threads);
  const int threads = options.threads > 0 ? options.threads : hardware_threads();
  const auto is_over = [&](double share) {
    return options.time_limit_seconds > 0 && seconds_since(start) > share * options.time_limit_seconds;
  };
  const SearchContext context{.source = source,
                              .bound = bound,
                              .frame = shared.frame,
                              .set = shared.set,
                              .meter = meter,
                              .is_late = [&] { return is_over(1); },
                              .is_half_over = [&] { return is_over(0.5); },
                              .effort = options.effort,
                              .threads = std::max(1, threads / static_cast<int>(std::min<std::size_t>(count, 64))),
                              .exact_ends = options.exact_ends,
                              .parts = options.parts};
  std::vector<std::vector<LevelClip>> levels(count);
  seconds_.resize(count);
  candidates_.resize(count);
  StepProgress progress(options.progress, count);
  parallel_for(count, options.threads, [&](std::size_t i) {
    const auto clip_start = std::chrono::steady_clock::now();
    levels[i] = search_clip(context, prepare_clip(context, clips[i], options.contact_weight), clips[i],
                            options.record_candidates || options.explain ? &candidates_[i] : nullptr);
    seconds_[i] = seconds_since(clip_start);
    progress.done(source.clips[clips[i]].name);
  });
  targets_ = shared.frame.targets;
  set_ = std::move(shared.set);
  choose_clips(levels, set_);
  for (std::size_t i = 0; i < count; ++i) place_[clips[i]] = i;
}

EncodedSet StandardEncoder::encode(const std::vector<std::size_t>& clips) const {
  EncodedSet encoded;
  encoded.targets = targets_;
  ClipSet chosen = set_;
  chosen.clips.clear();
  for (const std::size_t i : clips) {
    chosen.clips.push_back(set_.clips[place_.at(i)]);
    encoded.seconds.push_back(seconds_[place_.at(i)]);
    encoded.candidates.push_back(candidates_[place_.at(i)]);
    int most = 0;
    for (const LevelWindow& window : chosen.clips.back().windows)
      for (const LevelWeight& weight : window.weights) most = std::max(most, weight.feature);
    encoded.frequencies.push_back(most);
  }
  choose_references(chosen);
  encoded.clips = clips;
  encoded.stream = write_clip_set(chosen);
  return encoded;
}

void choose_clips(const std::vector<std::vector<LevelClip>>& choices, ClipSet& set) {
  set.clips.clear();
  for (const std::vector<LevelClip>& clip : choices) set.clips.push_back(clip.front());
  if (std::all_of(choices.begin(), choices.end(), [](const auto& clip) { return clip.size() == 1; })) return;
  const auto size_of = [](ClipSet& tried) {
    choose_references(tried);
    return write_clip_set(tried).size();
  };
  std::size_t least = size_of(set);
  for (std::size_t i = 0; i < choices.size(); ++i)
    for (std::size_t k = 1; k < choices[i].size(); ++k) {
      ClipSet other = set;
      other.clips[i] = choices[i][k];
      const std::size_t bytes = size_of(other);
      if (bytes >= least) continue;
      least = bytes;
      set = std::move(other);
    }
}

void choose_references(ClipSet& chosen) {
  const auto pose_of = [&](const LevelClip& clip, bool last) {
    std::vector<std::int32_t> pose;
    std::size_t parameters = 0;
    for (std::size_t t = 0; t < chosen.targets.size(); ++t)
      parameters += static_cast<std::size_t>(parameter_count(chosen.targets[t], clip.states[t]));
    std::size_t at = last && parameters ? clip.anchors.size() - parameters : 0;
    for (std::size_t t = 0; t < chosen.targets.size(); ++t) {
      const int count = parameter_count(chosen.targets[t], clip.states[t]);
      for (int a = 0; a < chosen.targets[t].width; ++a)
        pose.push_back(a < count && clip.states[t] != State::quaternion ? clip.anchors[at + static_cast<std::size_t>(a)]
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
