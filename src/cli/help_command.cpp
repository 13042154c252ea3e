// gltf-nmc help: topics, commands, and what installation puts beside the tool.
#include <fmt/format.h>

#include <memory>

#include "base/error.h"
#include "cli/command.h"
#include "cli/reference.h"

namespace nmc::cli {
namespace {

struct Arguments {
  std::string topic;
  bool man = false;
  std::string completion;
};

std::string overview() {
  std::string text = "Commands (gltf-nmc help COMMAND tells its options):\n";
  for (const Command& command : all_commands()) text += fmt::format("  {:<12}{}\n", command.name, command.description);
  text += "\nTopics (gltf-nmc help TOPIC):\n";
  for (const Topic& topic : help_topics()) text += fmt::format("  {:<12}{}\n", topic.name, topic.title);
  return text;
}

std::string topic_text(const std::string& name) {
  for (const Topic& topic : help_topics())
    if (name == topic.name) return fmt::format("{}\n\n{}", topic.title, topic.text);
  for (const Command& command : all_commands()) {
    if (name != command.name) continue;
    CLI::App app;
    make_app(app, command);
    return app.help();
  }
  std::string names;
  for (const Topic& topic : help_topics()) names += fmt::format("{}, ", topic.name);
  throw Error(ErrorCode::usage,
              fmt::format("there is no help about '{}'; there is about {}and the commands.", name, names));
}

std::string completion(const std::string& shell) {
  const std::vector<CommandInfo> commands = describe_commands();
  if (shell == "bash") return bash_completion(commands);
  if (shell == "zsh") return zsh_completion(commands);
  if (shell == "fish") return fish_completion(commands);
  throw Error(ErrorCode::usage, fmt::format("--completion: '{}' is no shell: there are bash, zsh and fish.", shell));
}

int run(const Arguments& a) {
  if (a.man + !a.completion.empty() + !a.topic.empty() > 1)
    throw Error(ErrorCode::usage, "help: give one of TOPIC, --man and --completion.");
  if (a.man)
    print(man_page(describe_commands()));
  else if (!a.completion.empty())
    print(completion(a.completion));
  else
    print(a.topic.empty() ? overview() : topic_text(a.topic));
  return 0;
}

}  // namespace

Run help_command(CLI::App& app) {
  const auto a = std::make_shared<Arguments>();
  app.add_option("TOPIC", a->topic, "a command or one of the topics (default: the list of both)");
  app.add_flag("--man", a->man, "print the page for man(1)")->group("Reference");
  app.add_option("--completion", a->completion, "print the completion script of this shell (default none)")
      ->type_name("bash|zsh|fish")
      ->group("Reference");
  return [=] { return run(*a); };
}

}  // namespace nmc::cli
