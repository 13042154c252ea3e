#include "report/inspect_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/format.h"
#include "report/table.h"

namespace nmc::report {
namespace {

using codec::InspectedClip;
using codec::InspectedPart;
using codec::InspectedSet;
using codec::KeptRecord;
using codec::PoseRecord;
using codec::SearchRecord;
using codec::TriedKind;
using Json = nlohmann::ordered_json;

/// "12" for one window, "3 to 17 in 5 windows" for more.
std::string frequencies_text(const std::vector<int>& frequencies) {
  if (frequencies.empty()) return "-";
  const auto [low, high] = std::minmax_element(frequencies.begin(), frequencies.end());
  if (frequencies.size() == 1) return std::to_string(*low);
  return fmt::format("{} to {} in {} windows", *low, *high, frequencies.size());
}

std::string parts_table(const InspectedSet& set) {
  std::size_t all_bits = 0;
  for (const InspectedPart& part : set.parts) all_bits += part.bits;
  Table table({{"part", Align::left}, {"bytes"}, {"share"}});
  for (const InspectedPart& part : set.parts) {
    const double share = all_bits > 0 ? static_cast<double>(part.bits) / static_cast<double>(all_bits) : 0;
    table.add_row({part.name, format_bytes((part.bits + 7) / 8), fmt::format("{:.1f}%", 100 * share)});
  }
  return table.text();
}

std::string clips_table(const InspectedSet& set) {
  Table table({{"animation", Align::left},
               {"index"},
               {"frames"},
               {"length"},
               {"basis", Align::left},
               {"frequencies"},
               {"nonzero weights"},
               {"corrections"}});
  for (const InspectedClip& clip : set.clips) {
    table.add_row({clip.name, std::to_string(clip.animation), std::to_string(clip.frames),
                   format_seconds(clip.duration_seconds), clip.basis, frequencies_text(clip.frequencies),
                   format_bytes(clip.nonzero_weights), format_bytes(clip.corrections)});
  }
  return table.text();
}

/// "  name: part; part; ..." in lines of at most 100 columns, unless a part is longer.
std::string listed(const std::string& name, const std::vector<std::string>& parts) {
  constexpr std::size_t widest = 100, longest_name = 40;
  std::string text, line = "  " + shorten(printable(name), longest_name) + ":";
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string part = parts[i] + (i + 1 < parts.size() ? ";" : "");
    if (display_width(line) + 1 + display_width(part) > widest) {
      text += line + '\n';
      line = "   ";
    }
    line += ' ' + part;
  }
  return text + line + '\n';
}

/// What was tried; `taken`: the first of it, if within the bound.
std::vector<std::string> search_parts(const SearchRecord& search, bool taken) {
  std::vector<std::string> parts;
  for (const TriedKind& kind : search.tried) {
    const bool first = taken && parts.empty() && kind.within_bound;
    parts.push_back(fmt::format("{}{}{} {} B{}", shorten(printable(kind.basis), 20), kind.jumps ? ", jumps apart," : "",
                                kind.within_bound ? "" : " given up at", format_bytes(kind.bytes),
                                first ? " was the smallest" : ""));
  }
  parts.push_back(
      fmt::format("keys {} B and {} B of JSON", format_bytes(search.key_bytes), format_bytes(search.json_bytes)));
  return parts;
}

std::vector<std::string> pose_parts(const std::vector<PoseRecord>& poses) {
  const auto worse = [](const PoseRecord& a, const PoseRecord& b) {
    return a.within_bound != b.within_bound ? a.within_bound : a.bytes < b.bytes;
  };
  const auto best = std::min_element(poses.begin(), poses.end(), worse);
  std::vector<std::string> parts;
  for (auto pose = poses.begin(); pose != poses.end(); ++pose) {
    std::string part =
        pose->coarser == 0 ? "usual steps" : fmt::format("{:.1f} times coarser", std::exp2(pose->coarser / 4.0));
    part += pose->within_bound ? fmt::format(" {} B", format_bytes(pose->bytes)) : " over the bound";
    parts.push_back(part + (pose == best && pose->within_bound ? " was the smallest" : ""));
  }
  return parts;
}

/// What was tried for the clips of a set; empty where the file does not say.
std::string set_search(const InspectedSet& set) {
  std::string text;
  for (const InspectedClip& clip : set.clips)
    if (clip.search) text += listed(clip.name, search_parts(*clip.search, true));
  if (!text.empty()) text = "\ntried, bytes of each clip alone within the bound:\n" + text;
  if (!set.poses.empty())
    text += "\ntried for the poses, bytes of the stream:\n" + listed("poses", pose_parts(set.poses));
  return text;
}

std::string kept_text(const InspectContext& context) {
  std::string text;
  for (const KeptRecord& kept : context.kept) {
    const auto index = static_cast<std::size_t>(kept.animation);
    if (index >= context.animation_names.size()) continue;
    std::vector<std::string> parts = search_parts(kept.search, false);
    parts.insert(parts.begin(), shorten(printable(kept.reason), 80));
    text += listed(context.animation_names[index], parts);
  }
  return text.empty() ? text : "\nstay as keys:\n" + text;
}

bool has_record(const std::vector<InspectedSet>& sets) {
  return std::any_of(sets.begin(), sets.end(), [](const InspectedSet& set) {
    return std::any_of(set.clips.begin(), set.clips.end(), [](const InspectedClip& clip) { return clip.search; });
  });
}

Json search_json(const SearchRecord& search) {
  Json json{{"key_bytes", search.key_bytes}, {"json_bytes", search.json_bytes}, {"tried", Json::array()}};
  for (const TriedKind& kind : search.tried)
    json["tried"].push_back(
        {{"basis", kind.basis}, {"jumps", kind.jumps}, {"bytes", kind.bytes}, {"within_bound", kind.within_bound}});
  return json;
}

Json poses_json(const std::vector<PoseRecord>& poses) {
  Json json = Json::array();
  for (const PoseRecord& pose : poses)
    json.push_back(
        {{"step", std::exp2(pose.coarser / 4.0)}, {"bytes", pose.bytes}, {"within_bound", pose.within_bound}});
  return json;
}

Json kept_json(const std::vector<KeptRecord>& kept) {
  Json json = Json::array();
  for (const KeptRecord& one : kept)
    json.push_back({{"animation", one.animation}, {"reason", one.reason}, {"search", search_json(one.search)}});
  return json;
}

Json set_json(const InspectedSet& set) {
  Json json{{"stream_bytes", set.stream_bytes}, {"targets", set.targets}, {"model", set.model}};
  json["parts"] = Json::array();
  for (const InspectedPart& part : set.parts) json["parts"].push_back({{"name", part.name}, {"bits", part.bits}});
  json["clips"] = Json::array();
  for (const InspectedClip& clip : set.clips) {
    json["clips"].push_back({{"animation", clip.animation},
                             {"name", clip.name},
                             {"frames", clip.frames},
                             {"duration_seconds", clip.duration_seconds},
                             {"frequencies", clip.frequencies},
                             {"nonzero_weights", clip.nonzero_weights},
                             {"basis", clip.basis},
                             {"corrections", clip.corrections},
                             {"search", clip.search ? search_json(*clip.search) : Json()}});
  }
  json["poses"] = poses_json(set.poses);
  return json;
}

std::size_t clip_count(const std::vector<InspectedSet>& sets) {
  std::size_t count = 0;
  for (const InspectedSet& set : sets) count += set.clips.size();
  return count;
}

}  // namespace

std::string inspect_text(const std::vector<InspectedSet>& sets, const InspectContext& context) {
  std::string out = fmt::format("{}: {} bytes, {} animations, {} compressed\n", printable(context.file),
                                format_bytes(context.file_bytes), context.animation_names.size(), clip_count(sets));
  for (std::size_t s = 0; s < sets.size(); ++s) {
    const InspectedSet& set = sets[s];
    out += fmt::format("\nclip set {}: {} bytes, {} targets; {}\n\n{}", s, format_bytes(set.stream_bytes), set.targets,
                       printable(set.model), clips_table(set));
    if (!set.parts.empty()) out += fmt::format("\n{}", parts_table(set));
    out += set_search(set);
  }
  out += kept_text(context);
  if (!sets.empty() && !has_record(sets))
    out += "\nThe file does not say what else was tried; one compressed with --explain does.\n";
  return out;
}

Json inspect_json(const std::vector<InspectedSet>& sets, const InspectContext& context) {
  Json json{{"command", "inspect"},
            {"version", context.version},
            {"file", context.file},
            {"file_bytes", context.file_bytes},
            {"animations", context.animation_names},
            {"compressed_animations", clip_count(sets)}};
  json["clip_sets"] = Json::array();
  for (const InspectedSet& set : sets) json["clip_sets"].push_back(set_json(set));
  json["kept"] = kept_json(context.kept);
  return json;
}

}  // namespace nmc::report
