// The man page, in the macros of man(7), from the same definitions as the help.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "cli/command.h"
#include "cli/reference.h"

namespace nmc::cli {
namespace {

/// Text that roff prints as it is.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\'')
      out += "\\(aq";
    else if (c == '^')
      out += "\\(ha";
    else if (c == '~')
      out += "\\(ti";
    else if (c == '`')
      out += "\\(ga";
    else
      out += c;
  }
  if (out.starts_with('.')) out.insert(0, "\\&");
  return out;
}

std::string topic_roff(const Topic& topic) {
  std::string out = fmt::format(".SS {}\n", escaped(topic.title));
  std::istringstream lines(topic.text);
  bool example = false, paragraph_ended = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) {
      paragraph_ended = true;
      continue;
    }
    const bool indented = line.starts_with("    ");
    if (example && !indented) out += ".EE\n.RE\n";
    if (!indented && paragraph_ended) out += ".PP\n";
    if (!example && indented) out += ".PP\n.RS 4\n.EX\n";
    if (indented && example && paragraph_ended) out += "\n";
    example = indented;
    paragraph_ended = false;
    out += escaped(indented ? line.substr(4) : line) + "\n";
  }
  if (example) out += ".EE\n.RE\n";
  return out;
}

std::string option_roff(const OptionInfo& option) {
  std::string out = ".TP\n";
  if (option.is_argument) return out + fmt::format("\\fI{}\\fR\n{}\n", escaped(option.names[0]), escaped(option.text));
  for (std::size_t i = 0; i < option.names.size(); ++i)
    out += fmt::format("{}\\fB{}\\fR", i == 0 ? "" : ", ", escaped(option.names[i]));
  if (!option.value.empty()) out += fmt::format(" \\fI{}\\fR", escaped(option.value));
  return out + "\n" + escaped(option.text) + "\n";
}

std::string synopsis(const CommandInfo& command) {
  if (command.name == "compress")
    return ".B gltf\\-nmc\n.RB [ compress ]\n.I IN OUT\n.RI [ options ]\n.br\n.B gltf\\-nmc\n.RB [ compress ]\n"
           ".IR IN ...\n.B \\-o\n.I FOLDER\n.RI [ options ]\n";
  std::string arguments;
  for (const OptionInfo& option : command.options)
    if (option.is_argument) arguments += fmt::format("{}{}", arguments.empty() ? "" : " ", option.names[0]);
  return fmt::format(".br\n.B gltf\\-nmc {}\n.I {}\n.RI [ options ]\n", escaped(command.name), escaped(arguments));
}

}  // namespace

std::string man_page(const std::vector<CommandInfo>& commands) {
  std::string out = fmt::format(
      ".\\\" Made by gltf-nmc help --man.\n.TH GLTF\\-NMC 1 \"\" \"gltf\\-nmc {}\" \"User Commands\"\n.SH NAME\n"
      "gltf\\-nmc \\- makes the animations of glTF files several times smaller\n.SH SYNOPSIS\n",
      version);
  for (const CommandInfo& command : commands) out += synopsis(command);
  out +=
      ".SH DESCRIPTION\n"
      "The animations of a .glb or .gltf file are replaced by sums of a few trained waves that stay within an error\n"
      "bound; everything that is not animation stays byte for byte. The first argument that is no option names the\n"
      "command; where there is no command of that name, the command is compress.\n";
  for (const CommandInfo& command : commands) {
    std::string title = command.name;
    std::transform(title.begin(), title.end(), title.begin(),
                   [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    out += fmt::format(".SH {}\n{}\n", escaped(title), escaped(command.text));
    std::string group;
    for (const OptionInfo& option : command.options) {
      if (option.names.back() == "--help" || option.names.back() == "--version") continue;
      if (!option.is_argument && option.group != group) {
        group = option.group;
        out += fmt::format(".SS {}\n", escaped(group));
      }
      out += option_roff(option);
    }
  }
  out += ".SH COMMON OPTIONS\n";
  for (const OptionInfo& option : commands.front().options)
    if (option.names.back() == "--help" || option.names.back() == "--version") out += option_roff(option);
  out += ".SH TOPICS\n";
  for (const Topic& topic : help_topics())
    if (std::string(topic.name) != "exit-codes") out += topic_roff(topic);
  out += ".SH EXIT STATUS\n";
  for (const Topic& topic : help_topics())
    if (std::string(topic.name) == "exit-codes") out += topic_roff(topic);
  out +=
      ".SH ENVIRONMENT\n.TP\n.B NO_COLOR\nno colours, where it is set and not empty\n.TP\n.B TERM\n"
      "where it is dumb or missing, no colours and no progress line\n"
      ".SH SEE ALSO\n.BR parallel (1)\n";
  return out;
}

}  // namespace nmc::cli
