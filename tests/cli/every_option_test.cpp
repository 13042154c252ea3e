// Walks over all options in the help: each has a row below that uses it and one that misuses it; man page and
// completions know it.
#include <algorithm>
#include <regex>
#include <sstream>

#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;

/// One option of one command. IN, PACKED, BVH and SETTINGS are files that exist, OUT and DIR names that are free.
struct Row {
  std::string command;
  std::string option;
  Words use;            ///< a whole command line that must succeed
  std::string says;     ///< what standard output then has
  Words misuse;         ///< a whole command line that must be refused (exit code 1)
  std::string refusal;  ///< what the sentence has besides the option's name
};

const std::vector<Row>& rows() {
  static const std::vector<Row> all{
      {"compress", "--output", {"IN", "--output", "OUT.glb"}, "OUT.glb", {"IN", "-o"}, ""},
      {"compress",
       "--optional",
       {"IN", "OUT.glb", "--optional"},
       "ratio",
       {"IN", "OUT.glb", "--optional", "--fallback"},
       "--fallback"},
      {"compress", "--fallback", {"IN", "OUT.glb", "--fallback"}, "ratio", {"IN", "OUT.glb", "--fallback=perhaps"}, ""},
      {"compress",
       "--allow-external",
       {"IN", "OUT.glb", "--allow-external"},
       "ratio",
       {"IN", "OUT.glb", "--allow-external=perhaps"},
       ""},
      {"compress",
       "--tolerance",
       {"IN", "OUT.glb", "--tolerance", "2%"},
       "= 2% of",
       {"IN", "OUT.glb", "--tolerance", "2"},
       "no unit"},
      {"compress",
       "--settings",
       {"IN", "OUT.glb", "--settings", "SETTINGS"},
       "= 2% of",
       {"IN", "OUT.glb", "--settings"},
       ""},
      {"compress",
       "--keep",
       {"IN", "OUT.glb", "--keep", "tip"},
       "ratio",
       {"IN", "OUT.glb", "--keep", "channel=turn"},
       "'turn'"},
      {"compress",
       "--exact-ends",
       {"IN", "OUT.glb", "--exact-ends"},
       "ratio",
       {"IN", "OUT.glb", "--exact-ends", "--profile", "paper"},
       "paper"},
      {"compress",
       "--keep-resting",
       {"IN", "OUT.glb", "--keep-resting"},
       "ratio",
       {"IN", "OUT.glb", "--keep-resting", "--profile", "paper"},
       "paper"},
      {"compress",
       "--target-size",
       {"IN", "OUT.glb", "--target-size", "2KB"},
       "ratio",
       {"IN", "OUT.glb", "--target-size", "40"},
       "no unit"},
      {"compress",
       "--exclude",
       {"IN", "OUT.glb", "--exclude", "wave"},
       "stays",
       {"IN", "OUT.glb", "--exclude", "wavy"},
       "wavy"},
      {"compress",
       "--draco",
       {"IN", "OUT.glb", "--draco"},
       "packed with Draco",
       {"IN", "OUT.glb", "--draco=perhaps"},
       ""},
      {"compress",
       "--draco-position",
       {"IN", "OUT.glb", "--draco", "--draco-position", "16"},
       "packed with Draco",
       {"IN", "OUT.glb", "--draco", "--draco-position", "25"},
       "2 to 24"},
      {"compress",
       "--draco-normal",
       {"IN", "OUT.glb", "--draco", "--draco-normal", "16"},
       "packed with Draco",
       {"IN", "OUT.glb", "--draco", "--draco-normal", "25"},
       "2 to 24"},
      {"compress",
       "--draco-texcoord",
       {"IN", "OUT.glb", "--draco", "--draco-texcoord", "16"},
       "packed with Draco",
       {"IN", "OUT.glb", "--draco", "--draco-texcoord", "25"},
       "2 to 24"},
      {"compress",
       "--draco-color",
       {"IN", "OUT.glb", "--draco", "--draco-color", "16"},
       "packed with Draco",
       {"IN", "OUT.glb", "--draco", "--draco-color", "25"},
       "2 to 24"},
      {"compress",
       "--draco-weight",
       {"IN", "OUT.glb", "--draco", "--draco-weight", "16"},
       "packed with Draco",
       {"IN", "OUT.glb", "--draco", "--draco-weight", "25"},
       "2 to 24"},
      {"compress",
       "--draco-generic",
       {"IN", "OUT.glb", "--draco", "--draco-generic", "16"},
       "packed with Draco",
       {"IN", "OUT.glb", "--draco-generic", "12"},
       "belongs to --draco"},
      {"compress",
       "--profile",
       {"IN", "OUT.glb", "--profile", "paper", "--max-frequencies", "2"},
       "profile paper",
       {"IN", "OUT.glb", "--profile", "fast"},
       "default, paper"},
      {"compress",
       "--effort",
       {"IN", "OUT.glb", "--effort", "1"},
       "ratio",
       {"IN", "OUT.glb", "--effort", "10"},
       "1 to 9"},
      {"compress",
       "--contact-weight",
       {"IN", "OUT.glb", "--contact-weight", "1.5"},
       "ratio",
       {"IN", "OUT.glb", "--contact-weight", "0.5"},
       "from 1 to 100"},
      {"compress",
       "--max-frequencies",
       {"IN", "OUT.glb", "--profile", "paper", "--max-frequencies", "0"},
       "paper",
       {"IN", "OUT.glb", "--max-frequencies", "3"},
       "--profile paper"},
      {"compress",
       "--time-limit",
       {"IN", "OUT.glb", "--time-limit", "0.5"},
       "ratio",
       {"IN", "OUT.glb", "--time-limit", "0"},
       "greater than 0"},
      {"compress",
       "--threads",
       {"IN", "OUT.glb", "--threads", "1"},
       "ratio",
       {"IN", "OUT.glb", "--threads", "0"},
       "1 to 1024"},
      {"compress",
       "--cache",
       {"IN", "-o", "DIR", "--cache", "DIR/cache"},
       "0 from the cache",
       {"IN", "OUT.glb", "--cache"},
       ""},
      {"compress",
       "--dry-run",
       {"IN", "OUT.glb", "--dry-run"},
       "nothing was written",
       {"IN", "OUT.glb", "--dry-run=perhaps"},
       ""},
      {"compress",
       "--report",
       {"IN", "OUT.glb", "--report", "OUT.html"},
       "ratio",
       {"IN", "OUT.glb", "--report", "OUT.txt"},
       ".html"},
      {"compress", "--explain", {"IN", "OUT.glb", "--explain"}, "ratio", {"IN", "OUT.glb", "--explain=perhaps"}, ""},
      {"compress",
       "--json",
       {"IN", "OUT.glb", "--json"},
       "\"command\": \"compress\"",
       {"IN", "OUT.glb", "--json=perhaps"},
       ""},
      {"compress", "--quiet", {"IN", "OUT.glb", "-q"}, "", {"IN", "OUT.glb", "--quiet", "-v"}, "--verbose"},
      {"compress", "--verbose", {"IN", "OUT.glb", "--verbose"}, "ratio", {"IN", "OUT.glb", "--verbose=perhaps"}, ""},
      {"compress", "--help", {"compress", "-h"}, "Usage: gltf-nmc", {"IN", "OUT.glb", "--hepl"}, ""},
      {"compress", "--version", {"--version"}, "gltf-nmc ", {"--version=perhaps"}, ""},
      {"decode",
       "--allow-external",
       {"decode", "PACKED", "OUT.glb", "--allow-external"},
       "1 of 1",
       {"decode", "PACKED", "OUT.glb", "--allow-external=perhaps"},
       ""},
      {"decode",
       "--quiet",
       {"decode", "PACKED", "OUT.glb", "-q"},
       "",
       {"decode", "PACKED", "OUT.glb", "--quiet=perhaps"},
       ""},
      {"inspect",
       "--allow-external",
       {"inspect", "PACKED", "--allow-external"},
       "wave",
       {"inspect", "PACKED", "--allow-external=perhaps"},
       ""},
      {"inspect",
       "--json",
       {"inspect", "PACKED", "--json"},
       "\"command\": \"inspect\"",
       {"inspect", "PACKED", "--json=perhaps"},
       ""},
      {"verify",
       "--tolerance",
       {"verify", "IN", "PACKED", "--tolerance", "5%"},
       "5% of",
       {"verify", "IN", "IN", "--tolerance", "5"},
       "no unit"},
      {"verify",
       "--settings",
       {"verify", "IN", "PACKED", "--settings", "SETTINGS"},
       "2% of",
       {"verify", "IN", "IN", "--settings"},
       ""},
      {"verify",
       "--joints",
       {"verify", "IN", "PACKED", "--joints"},
       "on joints alone",
       {"verify", "IN", "IN", "--joints=perhaps"},
       ""},
      {"verify",
       "--allow-external",
       {"verify", "IN", "PACKED", "--allow-external"},
       "holds",
       {"verify", "IN", "IN", "--allow-external=perhaps"},
       ""},
      {"verify",
       "--report",
       {"verify", "IN", "PACKED", "--report", "OUT.html"},
       "holds",
       {"verify", "IN", "IN", "--report", "OUT.txt"},
       ".html"},
      {"verify",
       "--json",
       {"verify", "IN", "PACKED", "--json"},
       "\"holds\": true",
       {"verify", "IN", "IN", "--json=perhaps"},
       ""},
      {"compare",
       "--methods",
       {"compare", "IN", "--methods", "svd,meshopt", "--tolerances", "5%"},
       "meshopt",
       {"compare", "IN", "--methods", "zip"},
       "zip"},
      {"compare",
       "--tolerances",
       {"compare", "IN", "--methods", "svd", "--tolerances", "1,5%"},
       "tolerance 5%",
       {"compare", "IN", "--tolerances", "5"},
       "no unit"},
      {"compare",
       "--effort",
       {"compare", "IN", "--methods", "nmc", "--tolerances", "5%", "--effort", "1"},
       "nmc",
       {"compare", "IN", "--effort", "10"},
       "1 to 9"},
      {"compare",
       "--threads",
       {"compare", "IN", "--methods", "svd", "--threads", "1"},
       "svd",
       {"compare", "IN", "--threads", "0"},
       "1 to 1024"},
      {"compare",
       "--allow-external",
       {"compare", "IN", "--methods", "svd", "--allow-external"},
       "svd",
       {"compare", "IN", "--allow-external=perhaps"},
       ""},
      {"compare",
       "--output",
       {"compare", "IN", "--methods", "svd", "--output", "OUT.csv"},
       "svd",
       {"compare", "IN", "-o", "OUT.txt"},
       ".csv"},
      {"compare",
       "--keep-encoded",
       {"compare", "IN", "--methods", "svd", "--keep-encoded", "DIR"},
       "svd",
       {"compare", "IN", "--keep-encoded"},
       ""},
      {"compare",
       "--check-encoded",
       {"compare", "IN", "--methods", "svd", "--check-encoded", "."},
       "svd",
       {"compare", "IN", "--check-encoded"},
       ""},
      {"compare",
       "--json",
       {"compare", "IN", "--methods", "svd", "--json"},
       "\"command\": \"compare\"",
       {"compare", "IN", "--json=perhaps"},
       ""},
      {"compare",
       "--quiet",
       {"compare", "IN", "--methods", "svd", "--quiet"},
       "",
       {"compare", "IN", "--quiet=perhaps"},
       ""},
      {"import",
       "--fps",
       {"import", "BVH", "OUT.glb", "--fps", "10"},
       "2 frames",
       {"import", "BVH", "OUT.glb", "--fps", "0"},
       "greater than 0"},
      {"import",
       "--scale",
       {"import", "BVH", "OUT.glb", "--scale", "0.01"},
       "joints",
       {"import", "BVH", "OUT.glb", "--scale", "-1"},
       "greater than 0"},
      {"import",
       "--name",
       {"import", "BVH", "OUT.glb", "--name", "run"},
       "joints",
       {"import", "BVH", "OUT.glb", "--name"},
       ""},
      {"import",
       "--quiet",
       {"import", "BVH", "OUT.glb", "-q"},
       "",
       {"import", "BVH", "OUT.glb", "--quiet=perhaps"},
       ""},
      {"help", "--man", {"help", "--man"}, ".TH GLTF", {"help", "tolerance", "--man"}, "one of"},
      {"help",
       "--completion",
       {"help", "--completion", "fish"},
       "complete -c gltf-nmc",
       {"help", "--completion", "cmd"},
       "bash, zsh and fish"},
  };
  return all;
}

class EveryOption : public CommandLine {
 protected:
  void SetUp() override {
    input("in.glb", TinyGlb(9).bytes());
    run_well({file("in.glb"), file("packed.glb"), "-q"});
    inputs_["packed.glb"] = read_bytes(file("packed.glb"));
    const std::string settings = "{\"tolerance\": \"2%\"}";
    input("settings.json", Bytes(settings.begin(), settings.end()));
    const std::string bvh =
        "HIERARCHY\nROOT hips\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 1 "
        "0\n}\n}\nMOTION\nFrames: 2\nFrame Time: 0.1\n0 0 0\n1 2 3\n";
    input("in.bvh", Bytes(bvh.begin(), bvh.end()));
  }

  Words arguments(Words words) const {
    for (std::string& word : words) {
      if (word == "IN") word = file("in.glb");
      if (word == "PACKED") word = file("packed.glb");
      if (word == "BVH") word = file("in.bvh");
      if (word == "SETTINGS") word = file("settings.json");
      if (word.starts_with("OUT.") || word.starts_with("DIR")) word = file(word);
    }
    return words;
  }

  /// The commands in the help.
  Words commands() const {
    Words names;
    std::istringstream lines(run_well({"help"}).out);
    std::string line;
    std::getline(lines, line);
    while (std::getline(lines, line) && !line.empty()) names.push_back(line.substr(2, line.find(' ', 2) - 2));
    return names;
  }

  /// The lines of a command's help that begin an option.
  std::vector<std::string> option_lines(const std::string& command) const {
    std::vector<std::string> lines;
    std::istringstream help(run_well({command, "--help"}).out);
    for (std::string line; std::getline(help, line);)
      if (line.starts_with("  -")) lines.push_back(line);
    return lines;
  }

  static std::string long_name(const std::string& line) {
    std::smatch match;
    return std::regex_search(line, match, std::regex("--[a-z-]+")) ? match[0].str() : line;
  }

  static std::string reference(const std::string& name) {
    const Bytes bytes = read_bytes(std::string(NMC_BUILD_DIR) + "/reference/" + name);
    return {bytes.begin(), bytes.end()};
  }

  static bool has(const std::string& program) {
    return run_process({"sh", "-c", "command -v " + program}).exit_code == 0;
  }
};

bool is_common(const std::string& option) { return option == "--help" || option == "--version"; }

TEST_F(EveryOption, HasARowHere) {
  const Words names = commands();
  ASSERT_GE(names.size(), 6U);
  std::size_t found = 0;
  for (const std::string& command : names) {
    for (const std::string& line : option_lines(command)) {
      const std::string option = long_name(line);
      if (command != "compress" && is_common(option)) continue;
      ++found;
      EXPECT_TRUE(std::any_of(rows().begin(), rows().end(),
                              [&](const Row& row) { return row.command == command && row.option == option; }))
          << "no row for " << command << " " << option << ": add its use and misuse to " << __FILE__;
    }
  }
  EXPECT_GE(found, rows().size());
}

TEST_F(EveryOption, IsUsed) {
  for (const Row& row : rows()) {
    SCOPED_TRACE(row.command + " " + row.option);
    const ProcessResult result = run(arguments(row.use));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.empty(), row.option != "--verbose") << result.err;
    EXPECT_EQ(result.out.empty(), row.says.empty()) << result.out;
    EXPECT_THAT(result.out, HasSubstr(row.says));
    std::filesystem::remove_all(file("DIR"));
  }
}

TEST_F(EveryOption, IsRefusedWhereMisused) {
  for (const Row& row : rows()) {
    const std::string name = row.option == "--output" ? "-o" : row.option;
    expect_failure(arguments(row.misuse), 1, {name, row.refusal});
  }
}

/// A value has a default in its text, or there is no sense in one.
TEST_F(EveryOption, TellsItsDefault) {
  for (const std::string& command : commands()) {
    const std::string help = run_well({command, "--help"}).out;
    for (const std::string& line : option_lines(command)) {
      const std::string head = line.substr(0, line.find("  ", 4));
      if (head.find(' ', 2) == std::string::npos) continue;  // a flag
      const std::size_t at = help.find(line);
      std::string text = help.substr(at, help.find("\n  -", at + 1) - at);
      std::replace(text.begin(), text.end(), '\n', ' ');
      EXPECT_THAT(std::regex_replace(text, std::regex(" +"), " "), HasSubstr("(default")) << command;
    }
  }
}

TEST_F(EveryOption, HelpFitsATerminal) {
  for (const std::string& command : commands()) {
    std::istringstream help(run_well({command, "--help"}).out);
    for (std::string line; std::getline(help, line);) EXPECT_LE(line.size(), 100U) << line;
    EXPECT_EQ(run_well({"help", command}).out, run_well({command, "--help"}).out);
  }
}

TEST_F(EveryOption, TopicsAreTold) {
  const std::string list = run_well({"help"}).out;
  for (const char* topic : {"tolerance", "pipeline", "exit-codes", "formats", "terminal"}) {
    EXPECT_THAT(list, HasSubstr(std::string("\n  ") + topic));
    const std::string text = run_well({"help", topic}).out;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80U) << line;
    EXPECT_GT(text.size(), 200U);
  }
  expect_failure({"help", "tolerences"}, 1, {"tolerences", "tolerance"});
}

TEST_F(EveryOption, IsInTheManPage) {
  const std::string page = reference("gltf-nmc.1");
  EXPECT_EQ(page, run_well({"help", "--man"}).out);
  for (const Row& row : rows()) {
    std::string name = std::regex_replace(row.option, std::regex("-"), "\\-");
    EXPECT_THAT(page, HasSubstr("\\fB" + name + "\\fR")) << row.option;
  }
}

TEST_F(EveryOption, TheManPageIsFormattedWithoutAWarning) {
  const std::string page = std::string(NMC_BUILD_DIR) + "/reference/gltf-nmc.1";
  if (!has("groff") && !has("man")) GTEST_SKIP() << "needs groff or man";
  if (has("groff")) {
    const ProcessResult groff = run_process({"groff", "-man", "-Tutf8", "-ww", page});
    EXPECT_EQ(groff.exit_code, 0);
    EXPECT_EQ(groff.err, "");
  }
  if (has("man")) {
    const ProcessResult man = run_process({"sh", "-c", "MANWIDTH=80 MANPAGER=cat man --warnings -l '" + page + "'"});
    EXPECT_EQ(man.exit_code, 0) << man.err;
    EXPECT_EQ(man.err, "");
    for (const char* part : {"NAME", "SYNOPSIS", "--tolerance", "EXIT STATUS", "NO_COLOR"})
      EXPECT_THAT(man.out, HasSubstr(part));
  }
}

TEST_F(EveryOption, IsInEachCompletion) {
  for (const Row& row : rows()) {
    const std::string bare = row.option.substr(2);
    EXPECT_THAT(reference("gltf-nmc.bash"), testing::ContainsRegex(row.command + ":-.*" + row.option)) << row.option;
    EXPECT_THAT(reference("_gltf-nmc"), HasSubstr("'*" + row.option + "[")) << row.option;
    EXPECT_THAT(reference("gltf-nmc.fish"), HasSubstr(" -l " + bare + " ")) << row.option;
  }
}

class Completion : public EveryOption {
 protected:
  /// What bash offers for the last of `words`.
  std::set<std::string> bash(const Words& words) const {
    std::string line = "source '" + std::string(NMC_BUILD_DIR) + "/reference/gltf-nmc.bash'; cd '" +
                       folder_.path().string() + "'; COMP_WORDS=(";
    for (const std::string& word : words) line += "'" + word + "' ";
    line += "); COMP_CWORD=" + std::to_string(words.size() - 1) +
            "; _gltf_nmc; printf '%s\\n' \"${COMPREPLY[@]}\"; complete -p gltf-nmc >&2";
    const ProcessResult result = run_process({"bash", "--norc", "-c", line});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "complete -F _gltf_nmc gltf-nmc\n");
    std::set<std::string> offered;
    std::istringstream lines(result.out);
    for (std::string one; std::getline(lines, one);)
      if (!one.empty()) offered.insert(one);
    return offered;
  }
};

TEST_F(Completion, Bash) {
  using testing::Contains;
  using testing::ElementsAre;
  EXPECT_THAT(bash({"gltf-nmc", "--tol"}), ElementsAre("--tolerance"));
  EXPECT_THAT(bash({"gltf-nmc", "in.glb", "out.glb", "--profile", ""}), ElementsAre("default", "paper"));
  EXPECT_THAT(bash({"gltf-nmc", "verify", "--j"}), ElementsAre("--joints", "--json"));
  EXPECT_THAT(bash({"gltf-nmc", "--json", "verify", "--jo"}), ElementsAre("--joints"));
  EXPECT_THAT(bash({"gltf-nmc", "dec"}), ElementsAre("decode"));
  EXPECT_THAT(bash({"gltf-nmc", "help", "tol"}), ElementsAre("tolerance"));
  EXPECT_THAT(bash({"gltf-nmc", "help", "--completion", "b"}), ElementsAre("bash"));
  std::filesystem::create_directory(file("a folder"));
  write_text(file("notes.txt"), "");
  const std::set<std::string> files = bash({"gltf-nmc", ""});
  for (const char* name : {"in.glb", "packed.glb", "in.bvh", "a folder", "decode"}) EXPECT_THAT(files, Contains(name));
  EXPECT_THAT(files, Not(Contains("notes.txt")));
  EXPECT_THAT(bash({"gltf-nmc", "in.glb", "--cache", ""}), ElementsAre("a folder"));
}

TEST_F(Completion, Zsh) {
  if (!has("zsh")) GTEST_SKIP() << "needs zsh";
  const ProcessResult result = run_process({"zsh", "-n", std::string(NMC_BUILD_DIR) + "/reference/_gltf-nmc"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
}

TEST_F(Completion, Fish) {
  if (!has("fish")) GTEST_SKIP() << "needs fish";
  const auto offers = [&](const std::string& line) {
    const ProcessResult result = run_process(
        {"fish", "--no-config", "-c",
         "source '" + std::string(NMC_BUILD_DIR) + "/reference/gltf-nmc.fish'; complete -C '" + line + "'"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return result.out;
  };
  EXPECT_THAT(offers("gltf-nmc --tol"), testing::StartsWith("--tolerance\t"));
  EXPECT_THAT(offers("gltf-nmc --profile "), HasSubstr("paper"));
  EXPECT_THAT(offers("gltf-nmc --eff"), HasSubstr("--effort\t1 (fast) to 9\n"));
  EXPECT_THAT(offers("gltf-nmc verify --jo"), HasSubstr("--joints"));
  EXPECT_THAT(offers("gltf-nmc decode --tol"), Not(HasSubstr("--tolerance")));
  EXPECT_THAT(offers("gltf-nmc help tol"), HasSubstr("tolerance"));
}

}  // namespace
}  // namespace nmc::test
