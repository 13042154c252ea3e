#include "codec/standard_sets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <iterator>
#include <utility>

#include "base/parallel.h"
#include "codec/standard_profile.h"

namespace nmc::codec {
namespace {

/// Appends a set of those clips that are better off compressed (clips that must stay are taken out and the rest coded
/// again). Returns the clips that are not within the tolerance.
std::vector<std::size_t> encode_standard_set(const Source& source, const CompressOptions& options, const Judge& judge,
                                             std::vector<std::size_t> clips, int precision,
                                             std::vector<ClipResult>& results, std::vector<EncodedSet>& sets) {
  const StandardEncoder encoder(source, options, clips, precision);
  std::vector<std::size_t> missed;
  while (!clips.empty()) {
    EncodedSet set = encoder.encode(clips);
    judge(set, results);
    std::vector<std::size_t> good;
    for (const std::size_t i : clips) {
      const Outcome outcome = results[static_cast<std::size_t>(source.clips[i].animation)].outcome;
      if (outcome == Outcome::compressed) good.push_back(i);
      if (outcome == Outcome::kept_over_tolerance) missed.push_back(i);
    }
    if (good.size() == clips.size()) {
      sets.push_back(std::move(set));
      break;
    }
    clips = std::move(good);
  }
  return missed;
}

/// A joint that turns by nearly half a turn from one key to the next is in between as exact as its keys are many times
/// over: which way it turns depends on the last bits.
bool has_flips(const motion::Clip& clip) {
  constexpr double half_turn_share = 0.95;
  for (const motion::Track& track : clip.tracks) {
    if (track.path != Path::rotation) continue;
    for (std::size_t k = 4; k < track.values.size(); k += 4) {
      double dot = 0;
      for (std::size_t a = 0; a < 4; ++a)
        dot += static_cast<double>(track.values[k + a]) * static_cast<double>(track.values[k + a - 4]);
      if (std::abs(dot) < std::cos(half_turn_share * glm::half_pi<double>())) return true;
    }
  }
  return false;
}

/// What one precision of anchors makes of some clips.
struct Attempt {
  std::vector<EncodedSet> sets;
  std::vector<ClipResult> results;
  std::vector<std::size_t> missed;

  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const EncodedSet& set : sets) sum += set.stream.size();
    return sum;
  }
};

/// Sets of those clips that are within the bound at the usual precision. In clips of few keys most bytes are poses,
/// which are then tried at coarser steps as well, at the same time.
Attempt encode_at_usual_precision(const Source& source, const CompressOptions& options, const Judge& judge,
                                  const std::vector<std::size_t>& clips, const std::vector<ClipResult>& results) {
  constexpr std::size_t few_keys = 64;
  constexpr std::array coarser{0, 3, 6, 9};  // the usual precision first
  const int usual = options.exact_ends ? StandardEncoder::exact_precision : StandardEncoder::usual_precision;
  std::size_t keys = 0;
  for (const std::size_t i : clips) keys += source.clips[i].clip.times.size();
  std::vector<Attempt> attempts(keys > few_keys || options.exact_ends ? 1 : coarser.size());
  const int threads = options.threads > 0 ? options.threads : hardware_threads();
  parallel_for(attempts.size(), threads, [&](std::size_t k) {
    CompressOptions own = options;
    own.threads = std::max(1, threads / static_cast<int>(attempts.size()));
    if (k > 0) own.progress = nullptr;
    Attempt& made = attempts[k];
    made.results = results;
    made.missed = encode_standard_set(source, own, judge, clips, usual - coarser[k], made.results, made.sets);
  });
  Attempt best = std::move(attempts.front());
  if (attempts.size() == 1) return best;
  std::vector<PoseRecord> poses{{0, best.bytes(), true}};
  for (std::size_t k = 1; k < attempts.size(); ++k) {
    Attempt& other = attempts[k];
    const bool reached = other.missed == best.missed && other.sets.size() == best.sets.size();
    poses.push_back({coarser[k], other.bytes(), reached});
    if (reached && other.bytes() < best.bytes()) best = std::move(other);
  }
  if (options.explain)
    for (EncodedSet& set : best.sets) set.poses = poses;
  return best;
}

}  // namespace

std::vector<EncodedSet> encode_standard_sets(const Source& source, const CompressOptions& options, const Judge& judge,
                                             std::vector<ClipResult>& results) {
  const int finest_precision =
      options.exact_ends ? StandardEncoder::exact_precision : StandardEncoder::finest_precision;
  std::vector<EncodedSet> sets;
  for (std::size_t b = 0; b < source.bounds.size(); ++b) {
    std::vector<std::size_t> usual, fine;
    for (std::size_t i = 0; i < source.clips.size(); ++i)
      if (source.clips[i].bound == b) (has_flips(source.clips[i].clip) ? fine : usual).push_back(i);
    Attempt made = encode_at_usual_precision(source, options, judge, usual, results);
    results = std::move(made.results);
    std::move(made.sets.begin(), made.sets.end(), std::back_inserter(sets));
    fine.insert(fine.end(), made.missed.begin(), made.missed.end());
    std::sort(fine.begin(), fine.end());
    encode_standard_set(source, options, judge, fine, finest_precision, results, sets);
  }
  return sets;
}

}  // namespace nmc::codec
