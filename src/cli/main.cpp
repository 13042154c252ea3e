// The command line: chooses the command, turns every failure into one sentence and an exit code.
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "cli/command.h"
#include "cli/interrupt.h"
#include "cli/reference.h"

namespace nmc::cli {
namespace {

constexpr std::array<Command, 7> commands{{
    {"compress", "Compresses the animations of a glTF file; the error stays within a tolerance.", compress_command},
    {"decode", "Turns a compressed file back into plain glTF that every viewer plays.", decode_command},
    {"inspect", "Shows what is inside a compressed file and where its bytes went.", inspect_command},
    {"verify", "Measures the error of a file against the original.", verify_command},
    {"compare", "Codes the animations by all methods of the papers and others, side by side.", compare_command},
    {"import", "Turns motion capture (BVH) into an animated glTF file.", import_command},
    {"help", "Tells about a command or a topic, such as tolerance or pipeline.", help_command},
}};

/// The list of the topic exit-codes, indented like the rest of the help.
std::string exit_codes_table() {
  std::string table;
  for (const Topic& topic : help_topics()) {
    if (topic.name != std::string_view("exit-codes")) continue;
    std::istringstream lines(topic.text);
    for (std::string line; std::getline(lines, line) && !line.empty();) table += line.substr(2) + "\n";
  }
  table.pop_back();
  return table;
}

std::string footer(bool with_commands) {
  std::string text;
  if (with_commands) {
    text += "Commands (compress where none is named; gltf-nmc COMMAND --help tells more):\n";
    for (const Command& command : commands) text += fmt::format("  {:<10}{}\n", command.name, command.description);
    text +=
        "A file that is named like a command is written with its folder: ./decode\n\nTopics (gltf-nmc help TOPIC):\n";
    for (const Topic& topic : help_topics()) text += fmt::format("  {:<12}{}\n", topic.name, topic.title);
    text += "\n";
  }
  return text + "Exit codes:\n" + exit_codes_table();
}

const Command* find_command(std::string_view name) {
  for (const Command& command : commands) {
    if (name == command.name) return &command;
  }
  return nullptr;
}

/// Whether `argument` is an option of compress whose value is the next argument.
bool takes_next(const CLI::App& compress, const std::string& argument) {
  const CLI::Option* option = compress.get_option_no_throw(argument);
  return option != nullptr && option->get_items_expected_max() > 0;
}

struct Choice {
  const Command* command = &commands[0];
  std::vector<std::string> arguments;  ///< without the command's name
  std::string first_positional;
};

/// The first argument that is no option (nor an option's value) names the command, where there is a command of that
/// name.
Choice choose(std::vector<std::string> arguments) {
  CLI::App compress;
  compress_command(compress);
  Choice choice;
  for (std::size_t i = 0; i < arguments.size() && arguments[i] != "--"; ++i) {
    if (arguments[i].starts_with('-')) {
      if (takes_next(compress, arguments[i])) ++i;
      continue;
    }
    if (const Command* named = find_command(arguments[i])) {
      choice.command = named;
      arguments.erase(arguments.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      choice.first_positional = arguments[i];
    }
    break;
  }
  choice.arguments = std::move(arguments);
  return choice;
}

std::string usage_sentence(const CLI::ParseError& error, const CLI::App& app, const Choice& choice) {
  const std::string help = fmt::format("try gltf-nmc {} --help.", choice.command->name);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    const std::vector<std::string> extras = app.remaining();
    const std::string extra = extras.empty() ? "" : extras.front();
    if (extra.starts_with('-')) return fmt::format("there is no option {}; {}", extra, help);
    if (!choice.first_positional.empty()) {
      return fmt::format("the argument '{}' is one too many, and '{}' is no command; {}", extra,
                         choice.first_positional, help);
    }
    return fmt::format("the argument '{}' is one too many; {}", extra, help);
  }
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr) {
    return fmt::format("a file is missing on the command line ({}); {}", error.what(), help);
  }
  return fmt::format("{}; {}", error.what(), help);
}

int fail(ErrorCode code, const std::string& sentence) {
  print_failure(sentence);
  return static_cast<int>(code);
}

int run(const std::vector<std::string>& arguments) {
  const Choice choice = choose(arguments);
  CLI::App app;
  const Run work = make_app(app, *choice.command);
  try {
    app.parse(std::vector<std::string>(choice.arguments.rbegin(), choice.arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    print(app.help());
    return 0;
  } catch (const CLI::CallForVersion&) {
    print(fmt::format("gltf-nmc {}\n", version));
    return 0;
  } catch (const CLI::ParseError& error) {
    return fail(ErrorCode::usage, usage_sentence(error, app, choice));
  }
  return work();
}

}  // namespace

std::span<const Command> all_commands() { return commands; }

Run make_app(CLI::App& app, const Command& command) {
  const bool is_default = command.name == std::string_view(commands[0].name);
  app.name(is_default ? "gltf-nmc" : fmt::format("gltf-nmc {}", command.name));
  app.description(command.description);
  app.footer(footer(is_default));
  app.get_formatter()->column_width(28);
  const Run work = command.add(app);
  app.set_help_flag("-h,--help", "print this text")->group("Help");
  app.set_version_flag("--version", fmt::format("gltf-nmc {}", version), "print the version")->group("Help");
  return work;
}

}  // namespace nmc::cli

int main(int argc, char** argv) {
  using nmc::cli::fail;
  nmc::cli::end_cleanly_on_signals();
  try {
    return nmc::cli::run(std::vector<std::string>(argv + 1, argv + argc));
  } catch (const nmc::Error& error) {
    return fail(error.code(), error.what());
  } catch (const std::bad_alloc&) {
    return fail(nmc::ErrorCode::internal, "there is not enough memory for this file.");
  } catch (const std::exception& error) {
    return fail(nmc::ErrorCode::internal, fmt::format("a defect in gltf-nmc, please report it: {}.", error.what()));
  }
}
