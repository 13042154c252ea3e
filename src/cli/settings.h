// What a user asks of a compression, on the command line or in a settings file (docs/settings.schema.json).
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "codec/compress.h"

namespace nmc::cli {

/// What was said; what was not is empty.
struct Settings {
  std::optional<std::string> profile;  ///< "default" or "paper"
  std::optional<codec::Tolerance> tolerance;
  std::vector<codec::ToleranceRule> rules;
  std::vector<codec::Selector> keep;
  std::vector<std::string> exclude;  ///< names of animations
  std::optional<bool> exact_ends;
  std::optional<bool> keep_resting;
  std::optional<std::size_t> target_bytes;
  std::optional<int> effort;
  std::optional<int> max_frequencies;
  std::optional<double> contact_weight;
  std::optional<double> time_limit_seconds;
  std::optional<bool> optional;
  std::optional<bool> fallback;
};

/// The options of the command line before they are understood.
struct SettingsArguments {
  std::string file;
  Settings said;                       ///< what needs no reading
  std::vector<std::string> tolerance;  ///< amounts, some with selectors
  std::vector<std::string> keep;       ///< selectors
  std::string target_size;
  bool exact_ends = false;
  bool keep_resting = false;
  bool optional = false;
  bool fallback = false;
};

/// Adds the options to a parser.
std::shared_ptr<SettingsArguments> add_settings(CLI::App& app);

/// Adds --tolerance and --settings alone, for commands that measure.
std::shared_ptr<SettingsArguments> add_tolerances(CLI::App& app);

/// Reads the settings file, where there is one, and puts the command line over it: single values replace those of the
/// file, exceptions and exclusions are added behind. Throws Error: io, usage (a value out of range, an unknown key,
/// things that contradict each other).
Settings read_settings(const SettingsArguments& arguments);

/// The bytes of a settings file. Throws Error (io).
std::string read_settings_text(const std::string& path);

/// The settings of a file. Throws Error as read_settings.
Settings read_settings_file(const std::string& path);

/// What the codec gets; the rest of the options are as they were.
void apply(const Settings& settings, codec::CompressOptions& options);

}  // namespace nmc::cli
