// Completion scripts for bash, zsh and fish, from the same definitions as the help.
#include <fmt/format.h>

#include <algorithm>

#include "cli/reference.h"

namespace nmc::cli {
namespace {

enum class Values { none, files, folders, choices, free };

Values values_of(const OptionInfo& option) {
  if (option.value.empty()) return Values::none;
  if (option.value.find('|') != std::string::npos) return Values::choices;
  if (option.value == "FOLDER") return Values::folders;
  if (option.value.starts_with("FILE") || option.value == "PATH") return Values::files;
  return Values::free;
}

std::string choices_of(const OptionInfo& option) {
  std::string words = option.value;
  std::replace(words.begin(), words.end(), '|', ' ');
  return words;
}

bool is_help(const CommandInfo& command) { return command.name == "help"; }

std::string command_names(const std::vector<CommandInfo>& commands) {
  std::string names;
  for (const CommandInfo& command : commands) names += fmt::format("{}{}", names.empty() ? "" : " ", command.name);
  return names;
}

std::string topic_names(const std::vector<CommandInfo>& commands) {
  std::string names = command_names(commands);
  for (const Topic& topic : help_topics()) names += fmt::format(" {}", topic.name);
  return names;
}

std::string joined_names(const OptionInfo& option, const char* between) {
  return fmt::format("{}", fmt::join(option.names, between));
}

/// Text within single quotes of a shell, with what `also` names behind a backslash.
std::string quoted(const std::string& text, const std::string& also = "") {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else {
      if (also.find(c) != std::string::npos) out += '\\';
      out += c;
    }
  }
  return out;
}

std::string bash_values(const OptionInfo& option) {
  switch (values_of(option)) {
    case Values::choices:
      return fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$cur\"))", choices_of(option));
    case Values::folders:
      return "_gltf_nmc_files -d";
    case Values::files:
      return "_gltf_nmc_files -f";
    default:
      return "COMPREPLY=()";
  }
}

std::string zsh_action(const OptionInfo& option) {
  switch (values_of(option)) {
    case Values::choices:
      return fmt::format(":{}:({})", "value", choices_of(option));
    case Values::folders:
      return ":folder:_files -/";
    case Values::files:
      return ":file:_files";
    case Values::free:
      return fmt::format(":{}: ", quoted(option.value, ":"));
    case Values::none:
      return "";
  }
  return "";
}

}  // namespace

std::string bash_completion(const std::vector<CommandInfo>& commands) {
  std::string out = fmt::format(R"(# bash completion for gltf-nmc; made by gltf-nmc help --completion bash.

# Paths, one a line, so that blanks in names stay.
_gltf_nmc_files() {{
  local IFS=$'\n'
  compopt -o filenames 2>/dev/null
  COMPREPLY=($(compgen "$1" -- "$cur"))
}}

# .glb, .gltf, .bvh and folders.
_gltf_nmc_models() {{
  local IFS=$'\n'
  compopt -o filenames 2>/dev/null
  COMPREPLY=($(compgen -d -- "$cur"; compgen -f -X '!*.@(glb|gltf|bvh)' -- "$cur"))
}}

_gltf_nmc() {{
  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD - 1]}} command=compress named= word i
  local restore
  restore=$(shopt -p extglob)
  shopt -s extglob
  COMPREPLY=()
  for ((i = 1; i < COMP_CWORD; i++)); do
    word=${{COMP_WORDS[i]}}
    case $word in
      {}) command=$word named=1; break ;;
      -*) ;;
      *) break ;;
    esac
  done
  case $command:$prev in
)",
                                [&] {
                                  std::string names = command_names(commands);
                                  std::replace(names.begin(), names.end(), ' ', '|');
                                  return names;
                                }());
  for (const CommandInfo& command : commands) {
    for (const OptionInfo& option : command.options) {
      if (option.is_argument || option.value.empty()) continue;
      out += fmt::format("    {0}:{1}) {2}; $restore; return ;;\n", command.name,
                         joined_names(option, fmt::format("|{}:", command.name).c_str()), bash_values(option));
    }
  }
  out += "  esac\n  case $command:$cur in\n";
  for (const CommandInfo& command : commands) {
    std::string names;
    for (const OptionInfo& option : command.options)
      if (!option.is_argument) names += fmt::format("{}{}", names.empty() ? "" : " ", joined_names(option, " "));
    out += fmt::format("    {}:-*) COMPREPLY=($(compgen -W '{}' -- \"$cur\")) ;;\n", command.name, names);
  }
  out += fmt::format(R"(    help:*) COMPREPLY=($(compgen -W '{}' -- "$cur")) ;;
    *)
      _gltf_nmc_models
      [ -n "$named" ] || [ "$COMP_CWORD" -ne 1 ] || COMPREPLY+=($(compgen -W '{}' -- "$cur"))
      ;;
  esac
  $restore
}}
complete -F _gltf_nmc gltf-nmc
)",
                     topic_names(commands), command_names(commands));
  return out;
}

std::string zsh_completion(const std::vector<CommandInfo>& commands) {
  std::string out =
      "#compdef gltf-nmc\n# zsh completion for gltf-nmc; made by gltf-nmc help --completion zsh.\n\n"
      "_gltf_nmc() {\n  local command=compress word\n  local -a commands\n  commands=(\n";
  for (const CommandInfo& command : commands)
    out += fmt::format("    '{}:{}'\n", command.name, quoted(command.text, ":"));
  out +=
      "  )\n  for word in ${words[2,CURRENT-1]}; do\n    if (( ${commands[(I)$word:*]} )); then\n"
      "      command=$word\n      words=(${words:#$word}) CURRENT=$((CURRENT - 1))\n      break\n    fi\n"
      "    [[ $word == -* ]] || break\n  done\n"
      "  if [[ $CURRENT -eq 2 && $command == compress && ${words[2]} != -* ]]; then\n"
      "    _describe command commands\n  fi\n  case $command in\n";
  for (const CommandInfo& command : commands) {
    out += fmt::format("    {})\n      _arguments -s", command.name);
    for (const OptionInfo& option : command.options) {
      if (option.is_argument) continue;
      const std::string rest = fmt::format("[{}]{}", quoted(short_text(option), "[]:"), zsh_action(option));
      for (const std::string& name : option.names) {
        // _arguments repeats an option that a '*' stands before.
        out += fmt::format(" \\\n        '*{}{}'", name, rest);
      }
    }
    out += is_help(command) ? fmt::format(" \\\n        '*:topic:({})'\n      ;;\n", topic_names(commands))
                            : " \\\n        '*:file:_files -g \"*.(glb|gltf|bvh)\"'\n      ;;\n";
  }
  return out + "  esac\n}\n\n_gltf_nmc \"$@\"\n";
}

std::string fish_completion(const std::vector<CommandInfo>& commands) {
  std::string out = "# fish completion for gltf-nmc; made by gltf-nmc help --completion fish.\n";
  const std::string all = command_names(commands);
  for (const CommandInfo& command : commands) {
    out += fmt::format("complete -c gltf-nmc -n '__fish_is_first_token' -a {} -d '{}'\n", command.name,
                       quoted(command.text, "\\"));
  }
  for (const CommandInfo& command : commands) {
    std::string others;
    for (const CommandInfo& other : commands)
      if (other.name != "compress") others += fmt::format(" {}", other.name);
    const std::string condition = command.name == "compress"
                                      ? fmt::format("not __fish_seen_subcommand_from{}", others)
                                      : fmt::format("__fish_seen_subcommand_from {}", command.name);
    for (const OptionInfo& option : command.options) {
      if (option.is_argument) continue;
      out += fmt::format("complete -c gltf-nmc -n '{}'", condition);
      for (const std::string& name : option.names)
        out += fmt::format(" {} {}", name.starts_with("--") ? "-l" : "-s", name.substr(name.find_first_not_of('-')));
      switch (values_of(option)) {
        case Values::none:
          break;
        case Values::choices:
          out += fmt::format(" -x -a '{}'", choices_of(option));
          break;
        case Values::folders:
          out += " -x -a '(__fish_complete_directories)'";
          break;
        case Values::files:
          out += " -r";
          break;
        case Values::free:
          out += " -x";
          break;
      }
      out += fmt::format(" -d '{}'\n", quoted(short_text(option), "\\"));
    }
    if (is_help(command))
      out += fmt::format("complete -c gltf-nmc -f -n '{}' -a '{}'\n", condition, topic_names(commands));
  }
  return out;
}

}  // namespace nmc::cli
