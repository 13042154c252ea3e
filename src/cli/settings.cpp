#include "cli/settings.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.h"
#include "cli/command.h"
#include "cli/nearest.h"
#include "cli/tolerance.h"

namespace nmc::cli {
namespace {

using nlohmann::json;

[[noreturn]] void refuse(const std::string& sentence) { throw Error(ErrorCode::usage, sentence); }

/// The values of one JSON object, each asked for by name; what nobody asked for is refused at the end.
class Reader {
 public:
  Reader(const json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object.is_object()) refuse(fmt::format("{} must be an object {{...}}.", where_));
  }

  void text(const char* key, const std::function<void(const std::string&, const std::string& name)>& take) {
    if (const json* value = find(key)) {
      if (!value->is_string()) refuse(fmt::format("{} must be a text in quotes.", name(key)));
      take(value->get<std::string>(), name(key));
    }
  }
  void flag(const char* key, std::optional<bool>& flag) {
    if (const json* value = find(key)) {
      if (!value->is_boolean()) refuse(fmt::format("{} must be true or false.", name(key)));
      flag = value->get<bool>();
    }
  }
  void whole(const char* key, int low, int high, std::optional<int>& number) {
    if (const json* value = find(key)) {
      if (!value->is_number_integer() || value->get<double>() < low || value->get<double>() > high)
        refuse(fmt::format("{} must be a whole number from {} to {}.", name(key), low, high));
      number = value->get<int>();
    }
  }
  void real(const char* key, double above_or_from, double high, bool from, std::optional<double>& number) {
    if (const json* value = find(key)) {
      const double given = value->is_number() ? value->get<double>() : std::nan("");
      if (!(from ? given >= above_or_from : given > above_or_from) || !(given <= high))
        refuse(
            fmt::format("{} must be a number {} {}.", name(key), from ? "from" : "above",
                        high < 1e12 ? fmt::format("{} to {}", above_or_from, high) : fmt::format("{}", above_or_from)));
      number = given;
    }
  }
  void list(const char* key, const std::function<void(const json&, const std::string& name)>& take) {
    if (const json* value = find(key)) {
      if (!value->is_array()) refuse(fmt::format("{} must be a list [...].", name(key)));
      for (std::size_t i = 0; i < value->size(); ++i) take((*value)[i], fmt::format("{}[{}]", name(key), i));
    }
  }
  bool has(const char* key) { return find(key) != nullptr; }

  void finish() const {
    for (const auto& [key, value] : object_.items()) {
      bool known = false;
      for (const std::string& k : known_) known = known || k == key;
      if (!known) refuse(fmt::format("{}: there is no setting '{}'{}", where_, key, did_you_mean(key, known_)));
    }
  }

 private:
  std::string name(const char* key) const { return fmt::format("{}: {}", where_, key); }
  const json* find(const char* key) {
    known_.emplace_back(key);
    const auto found = object_.find(key);
    return found == object_.end() ? nullptr : &*found;
  }

  const json& object_;
  std::string where_;
  std::vector<std::string> known_;
};

void read_rule(const json& value, const std::string& where, Settings& settings) {
  Reader reader(value, where);
  codec::Selector selector;
  const auto pattern = [](std::string& target) {
    return [&target](const std::string& text, const std::string& name) {
      if (text.empty()) refuse(fmt::format("{} is an empty pattern; * stands for every name.", name));
      target = text;
    };
  };
  reader.text("clip", pattern(selector.clip));
  reader.text("joint", pattern(selector.joint));
  reader.text("channel",
              [&](const std::string& text, const std::string& name) { selector.path = parse_channel(text, name); });
  std::optional<codec::Tolerance> tolerance;
  reader.text("tolerance",
              [&](const std::string& text, const std::string& name) { tolerance = parse_tolerance(text, name); });
  std::optional<bool> keep;
  reader.flag("keep", keep);
  reader.finish();
  if (tolerance.has_value() == keep.value_or(false))
    refuse(fmt::format("{} needs either a tolerance or \"keep\": true.", where));
  if (tolerance)
    settings.rules.push_back({selector, *tolerance});
  else
    settings.keep.push_back(selector);
}

void check_profile(const std::string& profile, const std::string& where) {
  if (profile != "default" && profile != "paper")
    refuse(fmt::format("{}: '{}' is no profile: there are default and paper.", where, profile));
}

Settings from_json(const json& object, const std::string& path) {
  Settings settings;
  Reader reader(object, path);
  reader.text("$schema", [](const std::string&, const std::string&) {});
  reader.text("profile", [&](const std::string& text, const std::string& name) {
    check_profile(text, name);
    settings.profile = text;
  });
  reader.text("tolerance", [&](const std::string& text, const std::string& name) {
    settings.tolerance = parse_tolerance(text, name);
  });
  reader.list("rules", [&](const json& rule, const std::string& name) { read_rule(rule, name, settings); });
  reader.list("exclude", [&](const json& entry, const std::string& name) {
    if (!entry.is_string()) refuse(fmt::format("{} must be a text in quotes.", name));
    settings.exclude.push_back(entry.get<std::string>());
  });
  reader.flag("exact_ends", settings.exact_ends);
  reader.flag("keep_resting", settings.keep_resting);
  reader.text("target_size", [&](const std::string& text, const std::string& name) {
    settings.target_bytes = parse_byte_count(text, name);
  });
  reader.whole("effort", 1, 9, settings.effort);
  reader.whole("max_frequencies", 0, 1000, settings.max_frequencies);
  reader.real("contact_weight", 1, 100, true, settings.contact_weight);
  reader.real("time_limit_seconds", 0, 1e12, false, settings.time_limit_seconds);
  reader.flag("optional", settings.optional);
  reader.flag("fallback", settings.fallback);
  reader.finish();
  return settings;
}

template <typename T>
void replace(const std::optional<T>& given, std::optional<T>& value) {
  if (given) value = given;
}

void refuse_contradictions(const Settings& s) {
  const bool paper = s.profile == "paper";
  if (s.optional.value_or(false) && s.fallback.value_or(false))
    refuse("--optional and --fallback contradict each other: give one of them.");
  if (s.max_frequencies && !paper) refuse("--max-frequencies belongs to --profile paper: add it, or leave both out.");
  if (s.tolerance && s.target_bytes) refuse("--tolerance and --target-size contradict each other: give one of them.");
  if (!paper) return;
  if (s.effort) refuse("--effort does not exist in --profile paper: use --max-frequencies or --time-limit.");
  if (s.contact_weight) refuse("--contact-weight does not exist in --profile paper: leave it out.");
  if (!s.rules.empty()) refuse("--profile paper knows one tolerance for everything: leave the others out.");
  if (s.exact_ends.value_or(false)) refuse("--exact-ends does not exist in --profile paper: leave it out.");
  if (s.keep_resting.value_or(false)) refuse("--keep-resting does not exist in --profile paper: leave it out.");
  if (s.target_bytes) refuse("--target-size does not exist in --profile paper: leave it out.");
}

}  // namespace

std::shared_ptr<SettingsArguments> add_tolerances(CLI::App& app) {
  const auto a = std::make_shared<SettingsArguments>();
  app.add_option("--tolerance", a->tolerance,
                 "largest error that may be seen: a share of the character's\n"
                 "size, above 0% to 100%, or a length above 0: 2mm, 1cm,\n"
                 "0.01m (default 0.1%). For some channels only, and repeated:\n"
                 "0.02%,joint=*Hand* or 1%,clip=Idle*,joint=Prop,channel=scale;\n"
                 "the last one that fits counts")
      ->type_name("AMOUNT")
      ->allow_extra_args(false)
      ->group("Error bound");
  app.add_option("--settings", a->file,
                 "read these settings from a JSON file; what the command line\nsays counts more (default none)")
      ->type_name("FILE")
      ->group("Error bound");
  return a;
}

std::shared_ptr<SettingsArguments> add_settings(CLI::App& app) {
  const auto a = add_tolerances(app);
  app.add_option("--keep", a->keep,
                 "leave channels as they are: a pattern for joints, or\n"
                 "clip=PATTERN,joint=PATTERN,channel=NAME in parts; may be\nrepeated (default none)")
      ->type_name("PATTERN")
      ->allow_extra_args(false)
      ->group("Error bound");
  app.add_option("--exclude", a->said.exclude, "leave this animation as it is; may be repeated (default none)")
      ->type_name("NAME")
      ->allow_extra_args(false)
      ->group("Error bound");
  app.add_flag("--exact-ends", a->exact_ends,
               "first and last pose of each clip within a hundredth of the\ntolerance, for clips that join; profile "
               "default only")
      ->group("Error bound");
  app.add_flag("--keep-resting", a->keep_resting,
               "also channels that hold what their node has without\n"
               "animation in every animation; profile default only")
      ->group("Error bound");
  app.add_option("--target-size", a->target_size,
                 "find the smallest tolerance at which all animations fit\n"
                 "these bytes (1B to 1TB: 40KB, 1.5MB); profile default only\n(default none)")
      ->type_name("BYTES")
      ->group("Error bound");
  app.add_option("--profile", a->said.profile,
                 "default: the smallest file that keeps the tolerance on\n"
                 "joints and skin; paper: the published method, the tolerance\n"
                 "on joints alone (default default)")
      ->type_name("default|paper")
      ->check(one_of({"default", "paper"}))
      ->group("Method");
  app.add_option("--effort", a->said.effort, "1 (fast) to 9 (smallest file); profile default only (default 5)")
      ->type_name("N")
      ->check(whole_number(1, 9))
      ->group("Method");
  app.add_option("--contact-weight", a->said.contact_weight,
                 "1 to 100: how often the error of points that stand still\ncounts; profile default only (default 3)")
      ->type_name("X")
      ->check(number(1, 100))
      ->group("Method");
  app.add_option("--max-frequencies", a->said.max_frequencies,
                 "where Algorithm 1 gives up, 0 to 1000; profile paper only\n(default 40)")
      ->type_name("N")
      ->check(whole_number(0, 1000))
      ->group("Method");
  app.add_option("--time-limit", a->said.time_limit_seconds,
                 "stop searching after this time, above 0; what is not done\nstays as it is (default none)")
      ->type_name("SECONDS")
      ->check(positive_number())
      ->group("Method");
  app.add_flag("--optional", a->optional, "readers without the extension show the model, standing still")
      ->group("File");
  app.add_flag("--fallback", a->fallback, "the original keys stay in the file as well")->group("File");
  return a;
}

std::string read_settings_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file.is_open() || file.bad()) throw Error(ErrorCode::io, fmt::format("{} cannot be read.", path));
  return text;
}

Settings read_settings_file(const std::string& path) {
  const std::string text = read_settings_text(path);
  json object;
  try {
    object = json::parse(text);
  } catch (const json::parse_error& error) {
    refuse(fmt::format("{} is no JSON: byte {} cannot stand where it stands.", path, error.byte));
  }
  return from_json(object, path);
}

Settings read_settings(const SettingsArguments& a) {
  Settings settings;
  if (!a.file.empty()) settings = read_settings_file(a.file);
  replace(a.said.profile, settings.profile);
  const Tolerances tolerances = parse_tolerances(a.tolerance);
  if (tolerances.has_all) settings.tolerance = tolerances.all;
  settings.rules.insert(settings.rules.end(), tolerances.rules.begin(), tolerances.rules.end());
  for (const std::string& text : a.keep) settings.keep.push_back(parse_selector(text, "--keep"));
  settings.exclude.insert(settings.exclude.end(), a.said.exclude.begin(), a.said.exclude.end());
  if (a.exact_ends) settings.exact_ends = true;
  if (a.keep_resting) settings.keep_resting = true;
  if (!a.target_size.empty()) settings.target_bytes = parse_byte_count(a.target_size, "--target-size");
  replace(a.said.effort, settings.effort);
  replace(a.said.max_frequencies, settings.max_frequencies);
  replace(a.said.contact_weight, settings.contact_weight);
  replace(a.said.time_limit_seconds, settings.time_limit_seconds);
  if (a.optional) settings.optional = true;
  if (a.fallback) settings.fallback = true;
  refuse_contradictions(settings);
  return settings;
}

void apply(const Settings& settings, codec::CompressOptions& options) {
  options.profile = settings.profile == "paper" ? codec::Profile::paper : codec::Profile::standard;
  options.tolerance = settings.tolerance.value_or(options.tolerance);
  options.rules = settings.rules;
  options.keep = settings.keep;
  options.exclude = settings.exclude;
  options.exact_ends = settings.exact_ends.value_or(options.exact_ends);
  options.keep_resting = settings.keep_resting.value_or(options.keep_resting);
  options.effort = settings.effort.value_or(options.effort);
  options.max_frequencies = settings.max_frequencies.value_or(options.max_frequencies);
  options.contact_weight = settings.contact_weight.value_or(options.contact_weight);
  options.time_limit_seconds = settings.time_limit_seconds.value_or(options.time_limit_seconds);
  if (settings.optional.value_or(false)) options.requirement = gltf::Requirement::optional;
  if (settings.fallback.value_or(false)) options.requirement = gltf::Requirement::fallback;
}

}  // namespace nmc::cli
