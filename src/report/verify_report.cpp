#include "report/verify_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/compress_report.h"
#include "report/format.h"
#include "report/table.h"

namespace nmc::report {
namespace {

using codec::Verification;
using codec::VerifiedClip;

}  // namespace

bool holds(const VerifiedClip& clip, const VerifyContext& context) {
  return (context.joints_alone ? clip.joint_share_of_tolerance : clip.share_of_tolerance) <= 1;
}

bool holds(const Verification& result, const VerifyContext& context) {
  return std::all_of(result.clips.begin(), result.clips.end(),
                     [&](const VerifiedClip& c) { return holds(c, context); });
}

std::string verify_text(const Verification& result, const VerifyContext& context) {
  std::string out = fmt::format("{} against {}\n", printable(context.other), printable(context.original));
  if (!result.clips.empty()) {
    Table errors({{"animation", Align::left},
                  {"max error"},
                  {"distance", Align::right, 1},
                  {"max joint", Align::right, 2},
                  {"mean error", Align::right, 3},
                  {"99%", Align::right, 4},
                  {"worst joint", Align::left},
                  {"at"},
                  {"holds", Align::left}});
    Table motion({{"animation", Align::left}, {"rotation"}, {"jitter"}, {"loop seam"}, {"drift"}});
    for (const VerifiedClip& clip : result.clips) {
      const motion::ErrorReport& e = clip.error;
      const auto percent = [&](double length) { return format_percent(length / result.size); };
      errors.add_row({clip.name, percent(e.max), format_length(e.max), percent(e.max_joint), percent(e.mean),
                      percent(e.percentile_99), node_label(context.node_names, e.max_node),
                      format_seconds(e.max_seconds), holds(clip, context) ? "yes" : "NO"});
      motion.add_row({clip.name, fmt::format("{:.3g} deg", e.max_rotation_degrees), format_length(e.jitter),
                      e.loop_seam ? format_length(*e.loop_seam) : "-", format_length(e.contact_drift)});
    }
    out += fmt::format("\n{}\n{}\n", errors.text(), motion.text());
  }
  const auto over =
      std::count_if(result.clips.begin(), result.clips.end(), [&](const auto& c) { return !holds(c, context); });
  const std::string bound =
      fmt::format("the tolerance {} = {} of the character's size ({}){}{}", format_length(result.tolerance),
                  format_percent(result.tolerance / result.size), format_length(result.size),
                  context.has_exceptions ? ", with exceptions," : "", context.joints_alone ? ", on joints alone," : "");
  if (over == 0) return out + fmt::format("{} holds for all {} animations\n", bound, result.clips.size());
  return out + fmt::format("{} does not hold for {} of {} animations\n", bound, over, result.clips.size());
}

nlohmann::ordered_json verify_json(const Verification& result, const VerifyContext& context) {
  nlohmann::ordered_json json{{"command", "verify"},
                              {"version", context.version},
                              {"original", context.original},
                              {"file", context.other},
                              {"size_world_units", result.size},
                              {"tolerance_world_units", result.tolerance},
                              {"tolerance_fraction_of_size", result.tolerance / result.size},
                              {"joints_alone", context.joints_alone},
                              {"holds", holds(result, context)}};
  json["animations"] = nlohmann::ordered_json::array();
  for (const VerifiedClip& clip : result.clips) {
    nlohmann::ordered_json row{
        {"name", clip.name},
        {"holds", holds(clip, context)},
        {"tolerance_world_units", clip.tolerance},
        {"finest_tolerance_world_units", clip.finest_tolerance},
        {"share_of_tolerance", context.joints_alone ? clip.joint_share_of_tolerance : clip.share_of_tolerance}};
    row["error"] = error_json(clip.error, result.size, context.node_names);
    json["animations"].push_back(std::move(row));
  }
  return json;
}

}  // namespace nmc::report
