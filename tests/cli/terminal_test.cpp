// What a person sees on a terminal, and what a program sees in a pipe. script(1) and tmux give the terminals.
#include <algorithm>
#include <regex>
#include <sstream>
#include <thread>

#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

bool has(const std::string& program) { return run_process({"sh", "-c", "command -v " + program}).exit_code == 0; }

class Terminal : public CommandLine {
 protected:
  void SetUp() override {
    for (int i = 0; i < 3; ++i)
      write_bytes(file("character" + std::to_string(i) + ".glb"), TinyGlb(31 + static_cast<std::size_t>(i)).bytes());
    TinyGlb two(31);
    Json second = two.json["animations"][0];
    second["name"] = "second";
    two.json["animations"].push_back(second);
    write_bytes(file("two.glb"), two.bytes());
    write_text(file("broken.glb"), "no GLB");
  }

  std::string command(const std::string& arguments) const {
    return "cd '" + folder_.path().string() + "' && '" NMC_BUILD_DIR "/gltf-nmc' " + arguments;
  }

  /// All that a command writes to a terminal of its own.
  std::string on_terminal(const std::string& environment, const std::string& arguments) const {
    const ProcessResult result =
        run_process({"env", "-u", "NO_COLOR", "TERM=xterm", "sh", "-c",
                     "export " + environment + "; script -qec \"" + command(arguments) + "\" /dev/null"});
    return result.out;
  }

  static bool has_control(const std::string& text) {
    return std::any_of(text.begin(), text.end(),
                       [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\n'; });
  }
};

TEST_F(Terminal, ShowsProgressAndColours) {
  if (!has("script")) GTEST_SKIP() << "needs script (bsdutils)";
  const std::string text = on_terminal("A=1", "two.glb character1.glb broken.glb -o out");
  EXPECT_THAT(text, ContainsRegex("\r\033\\[K *[0-9]+% \\[#*\\.*\\] [0-9]+:[0-9][0-9] (left|spent)"));
  EXPECT_THAT(text, HasSubstr("1/3 two.glb: wave"));
  EXPECT_THAT(text, HasSubstr("1/3 two.glb: second"));
  EXPECT_THAT(text, HasSubstr("2/3 character1.glb: wave"));
  EXPECT_THAT(text, HasSubstr("\033[31mgltf-nmc:\033[0m broken.glb"));
  EXPECT_THAT(text, ContainsRegex("\033\\[31mbroken.glb +FAILED\033\\[0m"));
  // Nothing of the line stays: the last thing before the table is its removal.
  const std::string before = text.substr(0, text.find("\033[1mfile"));
  EXPECT_THAT(before, testing::AnyOf(testing::EndsWith("\r\033[K"), testing::EndsWith("\r\n")));
}

TEST_F(Terminal, NoColourWhereItIsNotWanted) {
  if (!has("script")) GTEST_SKIP() << "needs script (bsdutils)";
  const std::string text = on_terminal("NO_COLOR=1", "character0.glb broken.glb -o out");
  EXPECT_THAT(text, HasSubstr("% ["));
  EXPECT_THAT(text, Not(ContainsRegex("\033\\[[0-9;]*m")));
  EXPECT_THAT(on_terminal("NO_COLOR=", "character0.glb broken.glb -o out"), ContainsRegex("\033\\[[0-9;]*m"));
  const std::string dumb = on_terminal("TERM=dumb", "character0.glb broken.glb -o out");
  EXPECT_THAT(dumb, Not(HasSubstr("\033")));
  EXPECT_THAT(dumb, Not(HasSubstr("% [")));
  EXPECT_THAT(dumb, HasSubstr("FAILED"));
}

TEST_F(Terminal, QuietShowsNothing) {
  if (!has("script")) GTEST_SKIP() << "needs script (bsdutils)";
  EXPECT_EQ(on_terminal("A=1", "two.glb character1.glb -o out -q"), "");
}

TEST_F(Terminal, VerboseWritesPlainLinesInAPipe) {
  const ProcessResult result = run({file("two.glb"), file("character1.glb"), "-o", file("out"), "-v"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_FALSE(has_control(result.err)) << result.err;
  EXPECT_FALSE(has_control(result.out)) << result.out;
  std::istringstream lines(result.err);
  std::vector<std::string> told;
  for (std::string line; std::getline(lines, line);) told.push_back(line);
  ASSERT_EQ(told.size(), 3U) << result.err;  // one for each animation
  EXPECT_THAT(told[0] + told[1], HasSubstr("two.glb: wave"));
  EXPECT_THAT(told[0] + told[1], HasSubstr("two.glb: second"));
  EXPECT_THAT(told[2], ContainsRegex("100% 2/2 .*character1.glb: wave"));
  EXPECT_EQ(run({file("two.glb"), "-o", file("out")}).err, "");
}

TEST_F(Terminal, VerboseOnATerminalHasBoth) {
  if (!has("script")) GTEST_SKIP() << "needs script (bsdutils)";
  const std::string text = on_terminal("A=1", "two.glb -o out -v");
  EXPECT_THAT(text, HasSubstr(" 50% 1/1 two.glb: "));
  EXPECT_THAT(text, HasSubstr("% ["));
}

/// The screen of tmux while it works, and when it is done.
TEST_F(Terminal, ScreenOfTmux) {
  if (!has("tmux")) GTEST_SKIP() << "needs tmux";
  for (int i = 0; i < 8; ++i)
    write_bytes(file("more" + std::to_string(i) + ".glb"), TinyGlb(60 + static_cast<std::size_t>(i)).bytes());
  const std::string socket = file("tmux");
  const auto tmux = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"env", "-u", "TMUX", "tmux", "-f", "/dev/null", "-S", socket});
    return run_process(arguments);
  };
  const ProcessResult started = tmux({"new-session", "-d", "-x", "100", "-y", "30",
                                      command("more*.glb -o out --effort 3; echo READY; exec sleep 60")});
  ASSERT_EQ(started.exit_code, 0) << started.err;
  std::set<std::string> bars;
  std::string screen;
  for (int i = 0; i < 4000 && screen.find("READY") == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    screen = tmux({"capture-pane", "-p"}).out;
    if (screen.find("READY") != std::string::npos || screen.find("% [") == std::string::npos) continue;
    // One line that is drawn again, never two.
    EXPECT_EQ(screen.find("% ["), screen.rfind("% [")) << screen;
    EXPECT_THAT(screen, ContainsRegex("[0-9]+% \\[[#.]+\\] [0-9]+:[0-9][0-9] (left|spent)  [0-9]+/8 more[0-9]+.glb"));
    bars.insert(screen.substr(0, screen.find('\n')));
  }
  tmux({"kill-server"});
  EXPECT_GE(bars.size(), 2U) << "the line did not move";
  EXPECT_THAT(screen, HasSubstr("8 files: 8 compressed, 0 failed"));
  EXPECT_THAT(screen, Not(HasSubstr("% [")));
  std::istringstream lines(screen);
  int rows = 0;
  for (std::string line; std::getline(lines, line);) rows += line.starts_with("more") ? 1 : 0;
  EXPECT_EQ(rows, 8) << screen;  // one row per file: no line was wrapped
}

TEST_F(Terminal, TablesFit100Columns) {
  TinyGlb tiny(31);
  tiny.json["animations"][0]["name"] = "A_rather_long_name_of_an_animation_from_a_big_library";
  tiny.json["nodes"][1]["name"] = "mixamorig:RightHandMiddleFingerThirdJoint";
  tiny.json["nodes"][0]["name"] = "mixamorig:HipsAndAllThatIsBelowThemInTheTree";
  const std::string in = file("a_file_with_a_rather_long_name_that_is_longer_than_a_column.glb");
  write_bytes(in, tiny.bytes());
  std::string text = run_well({in, file("packed.glb"), "--explain"}).out;
  text.erase(0, text.find('\n') + 1);  // the files' names are told whole
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {"verify", in, file("packed.glb")}, {"inspect", file("packed.glb")}, {in, "-o", file("out")}}) {
    const std::string more = run_well(arguments).out;
    text += more.substr(arguments[0] == in ? 0 : more.find('\n') + 1);
  }
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 104U) << line;  // bytes: an ellipsis has 3
  EXPECT_THAT(text, HasSubstr("ratio"));
  EXPECT_THAT(text, HasSubstr("max error"));
}

}  // namespace
}  // namespace nmc::test
