#include "codec/compress.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <iterator>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "codec/decoded_set.h"
#include "codec/paper_profile.h"
#include "codec/source.h"
#include "codec/standard_profile.h"
#include "gltf/cost.h"

namespace nmc::codec {
namespace {

/// JSON that a compressed animation needs besides its name: the object with one stub channel, and its share of
/// accessors.
constexpr std::size_t stub_json_bytes = 230;

double share_of_tolerance(const motion::ErrorReport& error, const Bound& bound, Profile profile) {
  return (profile == Profile::paper ? error.max_joint : error.max) / bound.tolerance;
}

/// What the decoder gives for each clip of a set, measured against the file; the outcomes go into the results.
void judge(const Source& source, const CompressOptions& options, const motion::ErrorMeter& meter, const EncodedSet& set,
           std::vector<ClipResult>& results) {
  const Bound& bound = source.bounds[source.clips[set.clips.front()].bound];
  std::optional<motion::ErrorMeter> scaled;
  if (bound.all_points) scaled.emplace(source.skeleton, *bound.all_points);
  const DecodedSet decoded(set.stream, "the new clip set");
  const std::vector<int> nodes = nodes_of(set);
  double clip_bits = 0;
  for (std::size_t i = 0; i < set.clips.size(); ++i) clip_bits += decoded.clip_bits(i);
  const double shared_bytes = std::max(0.0, static_cast<double>(set.stream.size()) - clip_bits / 8);
  parallel_for(set.clips.size(), options.threads, [&](std::size_t i) {
    const ClipSource& clip = source.clips[set.clips[i]];
    ClipResult& result = results[static_cast<std::size_t>(clip.animation)];
    const Animation shown = with_kept(clip, decoded.clip(i, nodes));
    result.error = meter.report(clip.original, shown);
    result.frequencies = set.frequencies[i];
    result.seconds = set.seconds[i];
    result.candidates = set.candidates[i];
    result.keys_after =
        static_cast<std::size_t>(decoded.clip_bits(i) / 8 + shared_bytes / static_cast<double>(set.clips.size()));
    result.outcome = Outcome::compressed;
    result.share_of_tolerance = share_of_tolerance(result.error, bound, options.profile);
    if (scaled) result.share_of_tolerance = scaled->report(clip.original, shown).max / bound.tolerance;
    if (!(result.share_of_tolerance <= 1)) {
      result.outcome = Outcome::kept_over_tolerance;
      result.reason = options.profile == Profile::paper ? "not within the tolerance at the most frequencies"
                                                        : "not within the tolerance";
    } else if (result.keys_after + stub_json_bytes >= result.keys_before + result.json_before) {
      result.outcome = Outcome::kept_larger;
      result.reason = "would become larger";
    }
  });
}

std::vector<EncodedSet> encode_paper_sets(const Source& source, const CompressOptions& options,
                                          const motion::ErrorMeter& meter, std::vector<ClipResult>& results) {
  std::vector<PaperClip> clips(source.clips.size());
  StepProgress progress(options.progress, clips.size());
  parallel_for(clips.size(), options.threads, [&](std::size_t i) {
    clips[i] = encode_paper(source, i, options);
    progress.done(source.clips[i].name);
  });
  std::vector<EncodedSet> sets;
  for (PaperClip& clip : clips) {
    judge(source, options, meter, clip.set, results);
    const ClipSource& from = source.clips[clip.set.clips.front()];
    if (results[static_cast<std::size_t>(from.animation)].outcome == Outcome::compressed)
      sets.push_back(std::move(clip.set));
  }
  return sets;
}

/// Appends a set of those clips that are better off compressed (clips that must stay are taken out and the rest coded
/// again). Returns the clips that are not within the tolerance.
std::vector<std::size_t> encode_standard_set(const Source& source, const CompressOptions& options,
                                             const motion::ErrorMeter& meter, std::vector<std::size_t> clips,
                                             int precision, std::vector<ClipResult>& results,
                                             std::vector<EncodedSet>& sets) {
  const StandardEncoder encoder(source, options, clips, precision);
  std::vector<std::size_t> missed;
  while (!clips.empty()) {
    EncodedSet set = encoder.encode(clips);
    judge(source, options, meter, set, results);
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
/// which are then tried at coarser steps as well.
Attempt encode_at_usual_precision(const Source& source, const CompressOptions& options, const motion::ErrorMeter& meter,
                                  const std::vector<std::size_t>& clips, const std::vector<ClipResult>& results) {
  constexpr std::size_t few_keys = 64;
  constexpr std::array coarser{3, 6, 9};
  const auto attempt = [&](const CompressOptions& with, int precision) {
    Attempt made{{}, results, {}};
    made.missed = encode_standard_set(source, with, meter, clips, precision, made.results, made.sets);
    return made;
  };
  const int usual = options.exact_ends ? StandardEncoder::exact_precision : StandardEncoder::usual_precision;
  Attempt best = attempt(options, usual);
  std::size_t keys = 0;
  for (const std::size_t i : clips) keys += source.clips[i].clip.times.size();
  if (keys > few_keys || options.exact_ends) return best;
  CompressOptions quiet = options;
  quiet.progress = nullptr;
  for (const int step : coarser) {
    Attempt other = attempt(quiet, usual - step);
    if (other.missed == best.missed && other.sets.size() == best.sets.size() && other.bytes() < best.bytes())
      best = std::move(other);
  }
  return best;
}

/// For each bound one set of all clips that have it, another with finer steps for those that need it.
std::vector<EncodedSet> encode_standard_sets(const Source& source, const CompressOptions& options,
                                             const motion::ErrorMeter& meter, std::vector<ClipResult>& results) {
  const int finest_precision =
      options.exact_ends ? StandardEncoder::exact_precision : StandardEncoder::finest_precision;
  std::vector<EncodedSet> sets;
  for (std::size_t b = 0; b < source.bounds.size(); ++b) {
    std::vector<std::size_t> usual, fine;
    for (std::size_t i = 0; i < source.clips.size(); ++i)
      if (source.clips[i].bound == b) (has_flips(source.clips[i].clip) ? fine : usual).push_back(i);
    Attempt made = encode_at_usual_precision(source, options, meter, usual, results);
    results = std::move(made.results);
    std::move(made.sets.begin(), made.sets.end(), std::back_inserter(sets));
    fine.insert(fine.end(), made.missed.begin(), made.missed.end());
    std::sort(fine.begin(), fine.end());
    encode_standard_set(source, options, meter, fine, finest_precision, results, sets);
  }
  return sets;
}

}  // namespace

CompressResult compress(const gltf::Document& document, const CompressOptions& options) {
  const gltf::CompressedContent present = gltf::read_compression(document);
  if (!present.animations.empty())
    throw Error(ErrorCode::invalid_input,
                document.name + ": its animations are compressed already; decode it first (gltf-nmc decode)");
  Source source = read_source(document, options);
  CompressResult result;
  result.size = source.size;
  result.tolerance = source.tolerance;
  result.clips = source.results;
  const std::vector<gltf::AnimationCost> before = gltf::animation_costs(document);
  for (ClipResult& clip : result.clips) {
    clip.keys_before = clip.keys_after = before[static_cast<std::size_t>(clip.animation)].key_bytes;
    clip.json_before = clip.json_after = before[static_cast<std::size_t>(clip.animation)].json_bytes;
  }
  const motion::ErrorMeter meter(source.skeleton, source.all_points);
  const std::vector<EncodedSet> sets = options.profile == Profile::paper
                                           ? encode_paper_sets(source, options, meter, result.clips)
                                           : encode_standard_sets(source, options, meter, result.clips);
  result.document = document;
  if (!sets.empty()) {
    gltf::CompressionEdit edit = compression_edit(source, sets);
    edit.requirement = options.requirement;
    result.notes = gltf::apply_compression(result.document, edit);
  }
  for (std::string& sentence : unused_patterns(source, options)) result.notes.push_back(std::move(sentence));
  const std::vector<gltf::AnimationCost> after = gltf::animation_costs(result.document);
  const std::size_t compressed = static_cast<std::size_t>(std::count_if(
      result.clips.begin(), result.clips.end(), [](const ClipResult& c) { return c.outcome == Outcome::compressed; }));
  std::size_t listed = 0;
  for (const gltf::AnimationCost& cost : after) listed += cost.json_bytes;
  const std::size_t total = gltf::total_cost(result.document).json_bytes;
  const std::size_t shared = compressed && total > listed ? (total - listed) / compressed : 0;
  for (ClipResult& clip : result.clips) {
    const gltf::AnimationCost& cost = after[static_cast<std::size_t>(clip.animation)];
    const bool taken = clip.outcome == Outcome::compressed;
    clip.keys_after = cost.key_bytes + (taken ? clip.keys_after : 0);
    clip.json_after = cost.json_bytes + (taken ? shared : 0);
    if (taken) continue;
    clip.error = {};
    clip.share_of_tolerance = 0;
  }
  return result;
}

}  // namespace nmc::codec
