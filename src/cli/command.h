// What a subcommand is: options on a CLI11 parser and the work to do once they are parsed.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace nmc::cli {

inline constexpr const char* version = NMC_VERSION;

/// The work of a parsed command. Returns the exit code; throws Error.
using Run = std::function<int()>;

// Each adds its options to `app` and returns its work.
Run compress_command(CLI::App& app);
Run compare_command(CLI::App& app);
Run decode_command(CLI::App& app);
Run inspect_command(CLI::App& app);
Run verify_command(CLI::App& app);
Run import_command(CLI::App& app);
Run help_command(CLI::App& app);

struct Command {
  const char* name;
  const char* description;
  Run (*add)(CLI::App& app);
};

/// All commands; the first is the one where none is named.
std::span<const Command> all_commands();

/// Gives `app` the command's name, description and options; returns its work.
Run make_app(CLI::App& app, const Command& command);

/// Checks for options: a sentence's second half where the value does not fit, as CLI11 wants it.
CLI::Validator whole_number(int low, int high);
CLI::Validator number(double low, double high);
CLI::Validator positive_number();
CLI::Validator one_of(const std::vector<std::string>& words);

/// A failure's sentence on standard error, safe for a terminal.
void print_failure(const std::string& sentence);

/// Writes to standard output. Throws Error (io) when it cannot be written.
void print(const std::string& text);

}  // namespace nmc::cli
