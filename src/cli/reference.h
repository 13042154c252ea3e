// The commands and their options as data, read from the CLI11 definitions: what help, man page and completions are made
// of.
#pragma once

#include <string>
#include <vector>

namespace nmc::cli {

struct OptionInfo {
  std::vector<std::string> names;  ///< "-o", "--output"; of an argument its name alone
  std::string value;               ///< "FOLDER"; "default|paper" where these are all; "" of a flag
  std::string text;                ///< one paragraph, with default and range
  std::string group;
  bool is_argument = false;  ///< positional
};

struct CommandInfo {
  std::string name;
  std::string text;
  std::vector<OptionInfo> options;  ///< in the order of the help
};

struct Topic {
  const char* name;
  const char* title;
  const char* text;  ///< paragraphs; lines that start with four blanks are examples
};

/// All commands.
std::vector<CommandInfo> describe_commands();

/// What `gltf-nmc help TOPIC` tells besides the commands.
const std::vector<Topic>& help_topics();

/// The part of an option's text that says what it does: up to the first of . ; : and parentheses, unless that is a
/// word or two.
std::string short_text(const OptionInfo& option);

/// The page for man(1), in man(7) macros.
std::string man_page(const std::vector<CommandInfo>& commands);

/// Scripts for the shells' completion.
std::string bash_completion(const std::vector<CommandInfo>& commands);
std::string zsh_completion(const std::vector<CommandInfo>& commands);
std::string fish_completion(const std::vector<CommandInfo>& commands);

}  // namespace nmc::cli
