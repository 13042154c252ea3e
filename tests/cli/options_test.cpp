// The command line itself: commands, options, contradictions, help.
#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int usage = 1;

class Options : public CommandLine {
 protected:
  void SetUp() override { in_ = input("in.glb", TinyGlb(5).bytes()); }

  std::string in_;
};

TEST_F(Options, NothingAtAll) { expect_failure({}, usage, {"missing"}); }

TEST_F(Options, OutputMissing) { expect_failure({in_}, usage, {"OUT"}); }

TEST_F(Options, UnknownOption) { expect_failure({in_, file("out.glb"), "--frobnicate"}, usage, {"--frobnicate"}); }

TEST_F(Options, UnknownCommand) {
  expect_failure({"frobnicate", in_, file("out.glb")}, usage, {"frobnicate", "no command"});
}

TEST_F(Options, OneFileTooMany) {
  expect_failure({"decode", in_, file("a.glb"), file("b.glb")}, usage, {"b.glb", "one too many"});
}

TEST_F(Options, ToleranceWithoutUnit) {
  expect_failure({in_, file("out.glb"), "--tolerance", "0.5"}, usage, {"'0.5'", "unit", "%", "mm", "cm", "0.01m"});
  expect_failure({"verify", in_, in_, "--tolerance", "2"}, usage, {"'2'", "unit"});
}

TEST_F(Options, NumbersOutOfRange) {
  const std::string out = file("out.glb");
  for (const char* effort : {"0", "10", "-1", "five", "2.5"}) {
    expect_failure({in_, out, "--effort", effort}, usage, {"--effort", effort});
  }
  for (const char* seconds : {"0", "-3", "nan", "inf", "soon"}) {
    expect_failure({in_, out, "--time-limit", seconds}, usage, {"--time-limit", seconds});
  }
  for (const char* weight : {"0", "101", "many"})
    expect_failure({in_, out, "--contact-weight", weight}, usage, {"--contact-weight"});
  expect_failure({in_, out, "--threads", "0"}, usage, {"--threads"});
  expect_failure({in_, out, "--threads", "99999999999999999999"}, usage, {"--threads"});
  expect_failure({in_, out, "--profile", "paper", "--max-frequencies", "-1"}, usage, {"--max-frequencies"});
  expect_failure({in_, out, "--profile", "fast"}, usage, {"--profile", "fast", "default", "paper"});
}

TEST_F(Options, ContradictionsAreRefused) {
  const std::string out = file("out.glb");
  expect_failure({in_, out, "--optional", "--fallback"}, usage, {"--optional", "--fallback"});
  expect_failure({in_, out, "--max-frequencies", "3"}, usage, {"--max-frequencies", "--profile paper"});
  expect_failure({in_, out, "--profile", "paper", "--effort", "3"}, usage, {"--effort", "paper"});
  expect_failure({in_, out, "--profile", "paper", "--contact-weight", "2"}, usage, {"--contact-weight", "paper"});
}

TEST_F(Options, ExcludedNameMustExist) {
  expect_failure({in_, file("out.glb"), "--exclude", "wawe"}, usage, {"in.glb", "wawe"});
}

TEST_F(Options, OutputMustBeGltf) { expect_failure({in_, file("out.txt")}, usage, {"out.txt", ".glb", ".gltf"}); }

TEST_F(Options, CommandMayFollowOptions) {
  EXPECT_THAT(run_well({"--json", "inspect", in_}).out, HasSubstr("\"command\": \"inspect\""));
}

TEST_F(Options, ValueOfAnOptionIsNoCommand) {
  expect_failure({"--exclude", "decode", in_, file("out.glb")}, usage, {"no animation named 'decode'"});
}

TEST_F(Options, HelpTellsEverything) {
  const ProcessResult result = run_well({"--help"});
  for (const char* word : {"--tolerance",
                           "--profile",
                           "--max-frequencies",
                           "--effort",
                           "--contact-weight",
                           "--time-limit",
                           "--threads",
                           "--optional",
                           "--fallback",
                           "--exclude",
                           "--json",
                           "--quiet",
                           "--version",
                           "--allow-external",
                           "default 0.1%",
                           "default 5",
                           "default 40",
                           "default all",
                           "default none",
                           "Exit codes",
                           "compress",
                           "1 (fast) to 9",
                           "decode",
                           "inspect",
                           "verify",
                           "import"}) {
    EXPECT_THAT(result.out, HasSubstr(word));
  }
  for (int code = 0; code <= 6; ++code) EXPECT_THAT(result.out, HasSubstr("\n  " + std::to_string(code) + "  "));
}

TEST_F(Options, EachCommandHasHelp) {
  for (const char* command : {"compress", "decode", "inspect", "verify", "import"}) {
    const ProcessResult result = run_well({command, "--help"});
    EXPECT_THAT(result.out, HasSubstr("Usage: gltf-nmc"));
    EXPECT_THAT(result.out, HasSubstr("Exit codes"));
  }
  EXPECT_THAT(run_well({"import", "--help"}).out, HasSubstr("--fps"));
}

TEST_F(Options, Version) {
  EXPECT_THAT(run_well({"--version"}).out, testing::MatchesRegex("gltf-nmc [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST_F(Options, FailuresPrintNoControlCharacters) {
  const ProcessResult result = run({file("\x1b[31mred.glb"), file("out.glb")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("red.glb"));
  EXPECT_THAT(result.err, Not(HasSubstr("\x1b")));
}

TEST_F(Options, FullStandardOutputIsAnError) {
  const std::string command = std::string(NMC_BUILD_DIR) + "/gltf-nmc inspect '" + in_ + "' > /dev/full";
  const ProcessResult result = run_process({"sh", "-c", command});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, HasSubstr("standard output"));
}

}  // namespace
}  // namespace nmc::test
