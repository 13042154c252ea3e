#include "report/inspect_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/format.h"
#include "report/table.h"

namespace nmc::report {
namespace {

using codec::InspectedClip;
using codec::InspectedPart;
using codec::InspectedSet;
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
                             {"corrections", clip.corrections}});
  }
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
  }
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
  return json;
}

}  // namespace nmc::report
