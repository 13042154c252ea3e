#include "report/compress_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/format.h"
#include "report/table.h"

namespace nmc::report {
namespace {

using codec::ClipResult;
using codec::CompressResult;
using codec::Outcome;
using Json = nlohmann::ordered_json;

std::size_t bytes_before(const ClipResult& clip) { return clip.keys_before + clip.json_before; }
std::size_t bytes_after(const ClipResult& clip) { return clip.keys_after + clip.json_after; }

struct Totals {
  std::size_t clips = 0, compressed = 0, frames = 0;
  std::size_t keys_before = 0, json_before = 0, keys_after = 0, json_after = 0;
  double duration_seconds = 0, seconds = 0;
  double max_error = 0, max_joint_error = 0;

  std::size_t before() const { return keys_before + json_before; }
  std::size_t after() const { return keys_after + json_after; }
};

Totals sum(const std::vector<ClipResult>& clips) {
  Totals t;
  for (const ClipResult& clip : clips) {
    ++t.clips;
    t.compressed += clip.outcome == Outcome::compressed ? 1 : 0;
    t.frames += clip.frames;
    t.keys_before += clip.keys_before;
    t.json_before += clip.json_before;
    t.keys_after += clip.keys_after;
    t.json_after += clip.json_after;
    t.duration_seconds += clip.duration_seconds;
    t.seconds += clip.seconds;
    t.max_error = std::max(t.max_error, clip.error.max);
    t.max_joint_error = std::max(t.max_joint_error, clip.error.max_joint);
  }
  return t;
}

std::string remark(const ClipResult& clip) {
  if (clip.outcome == Outcome::compressed) return "";
  return clip.reason.empty() ? "stays" : "stays: " + clip.reason;
}

std::vector<std::string> clip_cells(const ClipResult& clip, double size, const CompressContext& context) {
  std::vector<std::string> cells{clip.name,
                                 std::to_string(clip.frames),
                                 std::to_string(clip.joints),
                                 format_seconds(clip.duration_seconds),
                                 format_bytes(bytes_before(clip)),
                                 format_bytes(bytes_after(clip))};
  if (clip.outcome == Outcome::compressed) {
    const bool paper = context.profile == codec::Profile::paper;
    cells.insert(cells.end(),
                 {format_ratio(bytes_before(clip), bytes_after(clip)), format_percent(clip.error.max / size),
                  format_length(clip.error.max), paper ? format_percent(clip.error.max_joint / size) : "",
                  format_percent(clip.error.mean / size), node_label(context.node_names, clip.error.max_node),
                  format_seconds(clip.error.max_seconds)});
  } else {
    cells.insert(cells.end(), {"stays", "", "", "", "", "", ""});
  }
  cells.push_back(format_seconds(clip.seconds));
  return cells;
}

/// Reasons can be long: they stand below the table, equal ones together.
std::string stays_text(const std::vector<ClipResult>& clips) {
  std::vector<std::pair<std::string, std::vector<std::string>>> groups;
  for (const ClipResult& clip : clips) {
    const std::string why = remark(clip);
    if (why.empty()) continue;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == why; });
    if (group == groups.end()) group = groups.insert(groups.end(), {why, {}});
    group->second.push_back(printable(clip.name));
  }
  std::string out;
  for (const auto& [why, names] : groups) out += fmt::format("{}: {}\n", fmt::join(names, ", "), printable(why));
  return out;
}

Json clip_json(const ClipResult& clip, double size, const CompressContext& context) {
  Json json{{"animation", clip.animation},
            {"name", clip.name},
            {"outcome", outcome_name(clip.outcome)},
            {"reason", clip.reason},
            {"frames", clip.frames},
            {"joints", clip.joints},
            {"duration_seconds", clip.duration_seconds},
            {"bytes_before", bytes_before(clip)},
            {"bytes_after", bytes_after(clip)},
            {"key_bytes_before", clip.keys_before},
            {"json_bytes_before", clip.json_before},
            {"key_bytes_after", clip.keys_after},
            {"json_bytes_after", clip.json_after},
            {"frequencies", clip.frequencies},
            {"seconds_spent", clip.seconds},
            {"tolerance_world_units", clip.tolerance},
            {"finest_tolerance_world_units", clip.finest_tolerance},
            {"share_of_tolerance", clip.share_of_tolerance}};
  json["error"] = error_json(clip.error, size, context.node_names);
  return json;
}

Json totals_json(const Totals& t, double size) {
  return {{"animations", t.clips},
          {"compressed", t.compressed},
          {"frames", t.frames},
          {"duration_seconds", t.duration_seconds},
          {"bytes_before", t.before()},
          {"bytes_after", t.after()},
          {"key_bytes_before", t.keys_before},
          {"json_bytes_before", t.json_before},
          {"key_bytes_after", t.keys_after},
          {"json_bytes_after", t.json_after},
          {"max_world_units", t.max_error},
          {"max_fraction_of_size", t.max_error / size},
          {"max_joint_world_units", t.max_joint_error},
          {"max_joint_fraction_of_size", t.max_joint_error / size}};
}

}  // namespace

const char* profile_name(codec::Profile profile) { return profile == codec::Profile::paper ? "paper" : "default"; }

const char* outcome_name(Outcome outcome) {
  switch (outcome) {
    case Outcome::compressed:
      return "compressed";
    case Outcome::kept_over_tolerance:
      return "kept_over_tolerance";
    case Outcome::kept_larger:
      return "kept_larger";
    case Outcome::kept_nothing_to_take:
      return "kept_nothing_to_take";
  }
  throw std::logic_error("an outcome without a name");
}

std::string node_label(const std::vector<std::string>& node_names, int node) {
  if (node < 0) return "";
  const auto index = static_cast<std::size_t>(node);
  const bool named = index < node_names.size() && !node_names[index].empty();
  return named ? node_names[index] : fmt::format("node {}", node);
}

Json error_json(const motion::ErrorReport& error, double size, const std::vector<std::string>& node_names) {
  Json json{{"max_world_units", error.max},
            {"max_fraction_of_size", error.max / size},
            {"mean_world_units", error.mean},
            {"mean_fraction_of_size", error.mean / size},
            {"percentile_99_world_units", error.percentile_99},
            {"max_joint_world_units", error.max_joint},
            {"max_joint_fraction_of_size", error.max_joint / size},
            {"max_rotation_degrees", error.max_rotation_degrees},
            {"max_morph_weight", error.max_morph_weight},
            {"jitter_world_units", error.jitter},
            {"loop_seam_world_units", nullptr},
            {"contact_drift_world_units", error.contact_drift},
            {"worst_node", nullptr},
            {"worst_name", nullptr},
            {"worst_seconds", error.max_seconds}};
  if (error.loop_seam) json["loop_seam_world_units"] = *error.loop_seam;
  if (error.max_node >= 0) {
    json["worst_node"] = error.max_node;
    json["worst_name"] = node_label(node_names, error.max_node);
  }
  return json;
}

std::string compress_text(const CompressResult& result, const CompressContext& context) {
  const bool paper = context.profile == codec::Profile::paper;
  std::string out = fmt::format("{} -> {}, profile {}\n", printable(context.input), printable(context.output),
                                profile_name(context.profile));
  out += fmt::format("tolerance {} = {} of the character's size ({}){}\n", format_length(result.tolerance),
                     format_percent(result.tolerance / result.size), format_length(result.size),
                     paper ? ", on joints alone" : "");
  const Totals totals = sum(result.clips);
  const auto worst = [&](double error) {
    return totals.compressed > 0 ? format_percent(error / result.size) : std::string();
  };
  if (!result.clips.empty()) {
    Table table({{"animation", Align::left},
                 {"frames"},
                 {"joints", Align::right, 5},
                 {"length", Align::right, 3},
                 {"bytes before"},
                 {"after"},
                 {"ratio"},
                 {"max error"},
                 {"distance", Align::right, 2},
                 {"max joint error"},
                 {"mean error", Align::right, 4},
                 {"worst joint", Align::left},
                 {"at"},
                 {"spent", Align::right, 1}});
    for (const ClipResult& clip : result.clips) table.add_row(clip_cells(clip, result.size, context));
    table.add_rule();
    table.add_row({"total", std::to_string(totals.frames), "", format_seconds(totals.duration_seconds),
                   format_bytes(totals.before()), format_bytes(totals.after()),
                   format_ratio(totals.before(), totals.after()), worst(totals.max_error),
                   totals.compressed > 0 ? format_length(totals.max_error) : "",
                   paper ? worst(totals.max_joint_error) : "", "", "", "", format_seconds(context.seconds)});
    out += fmt::format("\n{}\n{}", table.text(), stays_text(result.clips));
  }
  out += fmt::format("file: {} -> {} bytes ({})\n", format_bytes(context.file_bytes_before),
                     format_bytes(context.file_bytes_after),
                     format_ratio(context.file_bytes_before, context.file_bytes_after));
  for (const std::string& note : result.notes) out += fmt::format("note: {}\n", printable(note));
  return out;
}

std::string cached_text(const Json& report) {
  const Json& totals = report["totals"];
  const auto bytes = [](const Json& object, const char* key) { return object[key].get<std::size_t>(); };
  std::string out = fmt::format("{} -> {}: from the cache\n", printable(report["input"].get_ref<const std::string&>()),
                                printable(report["output"].get_ref<const std::string&>()));
  out += fmt::format("{} of {} animations compressed, {} -> {} bytes ({}), max error {}\n", bytes(totals, "compressed"),
                     bytes(totals, "animations"), format_bytes(bytes(totals, "bytes_before")),
                     format_bytes(bytes(totals, "bytes_after")),
                     format_ratio(bytes(totals, "bytes_before"), bytes(totals, "bytes_after")),
                     format_percent(totals["max_fraction_of_size"].get<double>()));
  out += fmt::format("file: {} -> {} bytes ({})\n", format_bytes(bytes(report, "file_bytes_before")),
                     format_bytes(bytes(report, "file_bytes_after")),
                     format_ratio(bytes(report, "file_bytes_before"), bytes(report, "file_bytes_after")));
  for (const Json& note : report["notes"])
    out += fmt::format("note: {}\n", printable(note.get_ref<const std::string&>()));
  return out;
}

Json compress_json(const CompressResult& result, const CompressContext& context) {
  Json json{{"command", "compress"},
            {"version", context.version},
            {"input", context.input},
            {"output", context.output},
            {"profile", profile_name(context.profile)},
            {"size_world_units", result.size},
            {"tolerance_world_units", result.tolerance},
            {"tolerance_fraction_of_size", result.tolerance / result.size},
            {"file_bytes_before", context.file_bytes_before},
            {"file_bytes_after", context.file_bytes_after},
            {"seconds_spent", context.seconds}};
  json["totals"] = totals_json(sum(result.clips), result.size);
  json["animations"] = Json::array();
  for (const ClipResult& clip : result.clips) json["animations"].push_back(clip_json(clip, result.size, context));
  json["notes"] = result.notes;
  return json;
}

}  // namespace nmc::report
