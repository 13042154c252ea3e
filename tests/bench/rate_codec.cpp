#include "rate_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>

#include "gltf/cost.h"
#include "rate_process.h"

namespace nmc::bench {
namespace {

std::string method_name(const codec::CompressOptions& options) {
  if (options.profile == codec::Profile::paper) return "`--profile paper`";
  const codec::Parts& parts = options.parts;
  if (!parts.kinematics) return "without kinematics in the loss";
  if (!parts.rising_norm) return "without the rising norm";
  if (!parts.quantisation_aware) return "without training";
  if (!parts.refinement) return "without repair and pruning";
  if (!parts.corrections) return "without corrections";
  if (!parts.fitted_windows) return "with even windows";
  if (options.contact_weight == 1) return "contact weight 1, not 3";
  return default_method(options.effort);
}

/// How many clips stay as keys, and why.
std::string note_of(const std::vector<codec::ClipResult>& clips) {
  const auto count = [&](codec::Outcome outcome) {
    return std::count_if(clips.begin(), clips.end(),
                         [&](const codec::ClipResult& clip) { return clip.outcome == outcome; });
  };
  std::string note;
  if (const auto kept = count(codec::Outcome::kept_over_tolerance))
    note += fmt::format("not reached on {} of {} clips, which stay as keys", kept, clips.size());
  if (const auto kept = count(codec::Outcome::kept_larger))
    note += fmt::format("{}{} clips stay as keys: would be larger", note.empty() ? "" : "; ", kept);
  return note;
}

}  // namespace

void measure_result(const Reference& reference, const gltf::Document& made, Measurement& row) {
  const gltf::AnimationCost cost = gltf::total_cost(made);
  row.key_bytes = cost.key_bytes;
  row.json_bytes = cost.json_bytes;
  const FileError error = reference.error(made);
  row.error = error.all;
  row.joint_error = error.joints;
  row.jitter = error.jitter;
  row.loop_seam = error.loop_seam.value_or(Measurement::no_loop);
  row.contact_drift = error.contact_drift;
}

Measurement measure_cost(const std::filesystem::path& path) {
  const gltf::AnimationCost cost = gltf::total_cost(gltf::read_document(path));
  Measurement row;
  row.method = "as it is";
  row.reached = true;
  row.key_bytes = cost.key_bytes;
  row.json_bytes = cost.json_bytes;
  return row;
}

Measurement measure_codec(const std::filesystem::path& path, const codec::CompressOptions& options) {
  const gltf::Document document = gltf::read_document(path);
  const auto start = std::chrono::steady_clock::now();
  const codec::CompressResult result = codec::compress(document, options);
  Measurement row;
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  row.peak_bytes = peak_resident_bytes();
  row.method = method_name(options);
  row.joints_only = options.profile == codec::Profile::paper;
  row.reached = true;
  row.note = note_of(result.clips);
  measure_result(Reference(path), result.document, row);
  return row;
}

std::vector<codec::CompressOptions> ablations(const codec::CompressOptions& options) {
  std::vector<codec::CompressOptions> all(7, options);
  all[0].parts.kinematics = false;
  all[1].parts.rising_norm = false;
  all[2].parts.quantisation_aware = false;
  all[3].parts.refinement = false;
  all[4].parts.corrections = false;
  all[5].parts.fitted_windows = false;
  all[6].contact_weight = 1;
  return all;
}

Measurement measure_clips_apart(const std::filesystem::path& path, const codec::CompressOptions& options) {
  const gltf::Document document = gltf::read_document(path);
  std::vector<std::string> names;
  for (const codec::ClipResult& clip : codec::compress(document, options).clips) names.push_back(clip.name);
  Measurement sum;
  sum.method = "without sharing: each clip in a set of its own";
  sum.reached = true;
  for (const std::string& name : names) {
    codec::CompressOptions alone = options;
    std::copy_if(names.begin(), names.end(), std::back_inserter(alone.exclude),
                 [&](const std::string& other) { return other != name; });
    const codec::CompressResult result = codec::compress(document, alone);
    for (const codec::ClipResult& clip : result.clips)
      if (clip.name == name) {
        sum.key_bytes += clip.keys_after;
        sum.json_bytes += clip.json_after;
        sum.error = std::max(sum.error, clip.error.max / result.size);
        sum.jitter = std::max(sum.jitter, clip.error.jitter / result.size);
        if (clip.error.loop_seam) sum.loop_seam = std::max(sum.loop_seam, *clip.error.loop_seam / result.size);
        sum.contact_drift = std::max(sum.contact_drift, clip.error.contact_drift / result.size);
      }
  }
  return sum;
}

}  // namespace nmc::bench
