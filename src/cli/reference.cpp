#include "cli/reference.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/command.h"

namespace nmc::cli {
namespace {

std::string one_paragraph(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

OptionInfo describe(const CLI::Option& option) {
  OptionInfo info;
  info.is_argument = option.get_positional();
  info.text = one_paragraph(option.get_description());
  info.group = option.get_group();
  if (info.is_argument) {
    info.names = {option.get_single_name()};
    return info;
  }
  for (const std::string& name : option.get_snames()) info.names.push_back(fmt::format("-{}", name));
  for (const std::string& name : option.get_lnames()) info.names.push_back(fmt::format("--{}", name));
  if (option.get_items_expected_max() > 0) info.value = option.get_type_name();
  return info;
}

}  // namespace

std::vector<CommandInfo> describe_commands() {
  std::vector<CommandInfo> commands;
  for (const Command& command : all_commands()) {
    CLI::App app;
    make_app(app, command);
    CommandInfo info{command.name, command.description, {}};
    for (const CLI::Option* option : app.get_options())
      if (option->get_positional()) info.options.push_back(describe(*option));
    for (const std::string& group : app.get_groups())
      for (const CLI::Option* option : app.get_options())
        if (!option->get_positional() && option->get_group() == group && !group.empty())
          info.options.push_back(describe(*option));
    commands.push_back(std::move(info));
  }
  return commands;
}

std::string short_text(const OptionInfo& option) {
  constexpr std::size_t shortest = 12;  // "1 (fast) to 9" says something, "1" does not
  const std::string& text = option.text;
  std::size_t end = text.size();
  for (std::size_t i = 0; i < end; ++i) {
    const bool stops = text[i] == '(' || text[i] == ';' ||
                       ((text[i] == ':' || text[i] == '.') && (i + 1 == text.size() || text[i + 1] == ' '));
    if (stops && i >= shortest) end = i;
  }
  std::string shortened = text.substr(0, end);
  shortened.erase(shortened.find_last_not_of(' ') + 1);
  return shortened;
}

}  // namespace nmc::cli
