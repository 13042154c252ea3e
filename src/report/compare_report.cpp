#include "report/compare_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "report/format.h"
#include "report/table.h"

namespace nmc::report {
namespace {

using baselines::Comparison;
using baselines::Encoding;
using baselines::MethodResult;

std::string rate(std::size_t frames, double seconds) {
  if (!(seconds > 0)) return "";
  return format_bytes(static_cast<std::size_t>(static_cast<double>(frames) / seconds));
}

std::string why_not(const MethodResult& method, double size) {
  if (!method.failure.empty()) return method.failure;
  if (method.curve.empty()) return "";
  const auto least = std::min_element(method.curve.begin(), method.curve.end(),
                                      [](const Encoding& a, const Encoding& b) { return a.max_error < b.max_error; });
  return fmt::format("not reached; least error {}", format_percent(least->max_error / size));
}

Table tolerance_table(const Comparison& result, const CompareContext& context, std::size_t t) {
  Table table({{"method", Align::left},
               {"bytes"},
               {"ratio"},
               {"max error"},
               {"at joints"},
               {"mean error"},
               {"encode frames/s"},
               {"decode frames/s"},
               {"", Align::left}});
  for (const MethodResult& method : result.methods) {
    if (!method.best[t]) {
      table.add_row({std::string(method.method->name), "-", "", "", "", "", "", "", why_not(method, result.size)});
      continue;
    }
    const Encoding& best = method.curve[*method.best[t]];
    table.add_row({std::string(method.method->name), format_bytes(best.bytes.size()),
                   format_ratio(context.original_bytes, best.bytes.size()),
                   format_percent(best.max_error / result.size), format_percent(best.max_joint / result.size),
                   format_percent(best.mean_error / result.size), rate(result.frames, best.encode_seconds),
                   rate(result.frames, best.decode_seconds)});
  }
  return table;
}

}  // namespace

std::string compare_text(const Comparison& result, const CompareContext& context) {
  std::string text =
      fmt::format("{}: {} animation{}, {} frames, {} bytes of keys; errors are shares of {}\n",
                  printable(context.input), result.clips, result.clips == 1 ? "" : "s", format_bytes(result.frames),
                  format_bytes(context.original_bytes), format_length(result.size));
  for (std::size_t t = 0; t < result.tolerances.size(); ++t)
    text += fmt::format("\ntolerance {}\n{}", format_percent(result.tolerances[t]),
                        tolerance_table(result, context, t).text());
  return text;
}

nlohmann::ordered_json compare_json(const Comparison& result, const CompareContext& context) {
  const auto encoding_json = [&](const Encoding& made) {
    nlohmann::ordered_json json;
    json["knob"] = made.knob;
    json["bytes"] = made.bytes.size();
    json["ratio"] =
        static_cast<double>(context.original_bytes) / static_cast<double>(std::max<std::size_t>(1, made.bytes.size()));
    json["maxError"] = made.max_error / result.size;
    json["maxJointError"] = made.max_joint / result.size;
    json["meanError"] = made.mean_error / result.size;
    json["encodeSeconds"] = made.encode_seconds;
    json["decodeSeconds"] = made.decode_seconds;
    return json;
  };
  nlohmann::ordered_json json;
  json["command"] = "compare";
  json["version"] = context.version;
  json["input"] = context.input;
  json["animations"] = result.clips;
  json["frames"] = result.frames;
  json["size"] = result.size;
  json["originalBytes"] = context.original_bytes;
  json["tolerances"] = result.tolerances;
  json["methods"] = nlohmann::ordered_json::array();
  for (const MethodResult& method : result.methods) {
    nlohmann::ordered_json entry;
    entry["name"] = method.method->name;
    entry["source"] = method.method->source;
    entry["knobMeans"] = method.method->knob;
    if (!method.failure.empty()) entry["failure"] = method.failure;
    entry["atTolerances"] = nlohmann::ordered_json::array();
    for (const std::optional<std::size_t>& best : method.best)
      entry["atTolerances"].push_back(best ? encoding_json(method.curve[*best]) : nlohmann::ordered_json());
    entry["curve"] = nlohmann::ordered_json::array();
    for (const Encoding& made : method.curve) entry["curve"].push_back(encoding_json(made));
    json["methods"].push_back(std::move(entry));
  }
  return json;
}

std::string compare_csv(const Comparison& result, const CompareContext& context) {
  std::string text =
      "method,tolerance,knob,bytes,ratio,max_error,max_joint_error,mean_error,encode_seconds,decode_seconds\n";
  for (const MethodResult& method : result.methods)
    for (std::size_t i = 0; i < method.curve.size(); ++i) {
      const Encoding& made = method.curve[i];
      std::string tolerances;
      for (std::size_t t = 0; t < result.tolerances.size(); ++t)
        if (method.best[t] == i) tolerances += fmt::format("{}{}", tolerances.empty() ? "" : " ", result.tolerances[t]);
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{}\n", method.method->name, tolerances, made.knob, made.bytes.size(),
                      static_cast<double>(context.original_bytes) /
                          static_cast<double>(std::max<std::size_t>(1, made.bytes.size())),
                      made.max_error / result.size, made.max_joint / result.size, made.mean_error / result.size,
                      made.encode_seconds, made.decode_seconds);
    }
  return text;
}

}  // namespace nmc::report
