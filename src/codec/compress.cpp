#include "codec/compress.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "codec/decoded_set.h"
#include "codec/paper_profile.h"
#include "codec/search_record.h"
#include "codec/source.h"
#include "codec/standard_sets.h"
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

/// What the user should know of channels that are in no clip.
std::vector<std::string> resting_notes(const Source& source, const std::vector<EncodedSet>& sets) {
  std::size_t resting = 0, channels = 0;
  for (const EncodedSet& set : sets)
    for (const std::size_t clip : set.clips) {
      resting += source.clips[clip].resting.size();
      channels += source.clips[clip].resting.size() + source.clips[clip].channels.size();
    }
  if (resting == 0) return {};
  return {
      std::to_string(resting) + " of " + std::to_string(channels) +
      " channels hold what their node has without animation, in every animation: left out (--keep-resting keeps them)"};
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
  const Judge judge_here = [&](const EncodedSet& set, std::vector<ClipResult>& results) {
    judge(source, options, meter, set, results);
  };
  const std::vector<EncodedSet> sets = options.profile == Profile::paper
                                           ? encode_paper_sets(source, options, meter, result.clips)
                                           : encode_standard_sets(source, options, judge_here, result.clips);
  result.document = document;
  if (!sets.empty()) {
    gltf::CompressionEdit edit = compression_edit(source, sets);
    edit.requirement = options.requirement;
    if (options.explain) put_search_records(result.clips, sets, edit);
    result.notes = gltf::apply_compression(result.document, edit);
    for (std::string& sentence : resting_notes(source, sets)) result.notes.push_back(std::move(sentence));
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
