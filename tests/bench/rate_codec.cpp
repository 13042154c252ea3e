#include "rate_codec.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "gltf/cost.h"
#include "rate_process.h"

namespace nmc::bench {
namespace {

std::string method_name(const codec::CompressOptions& options) {
  if (options.profile == codec::Profile::paper) return "`--profile paper`";
  return fmt::format("default, effort {}", options.effort);
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

}  // namespace nmc::bench
