// The examples of samples/pipeline on two workers: interrupted in the middle, run again, nothing lost or done twice.
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <thread>

#include "support/process.h"
#include "support/running.h"
#include "support/scratch.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

const std::string examples = std::string(NMC_SOURCE_DIR) + "/samples/pipeline";
const std::string tool = std::string(NMC_BUILD_DIR) + "/gltf-nmc";

bool has(const std::string& program) { return run_process({"sh", "-c", "command -v " + program}).exit_code == 0; }

class Pipeline : public testing::Test {
 protected:
  /// Eight characters in two folders, of different content, and a tool that writes down when it begins and ends.
  void SetUp() override {
    for (int i = 0; i < 8; ++i) {
      const std::string name = (i % 2 == 0 ? "heroes/" : "with blank/") + std::to_string(i) + ".glb";
      std::filesystem::create_directories(std::filesystem::path(file("assets/" + name)).parent_path());
      write_bytes(file("assets/" + name), TinyGlb(9 + static_cast<std::size_t>(i)).bytes());
      names_.push_back(name);
    }
    write_text(file("tool"),
               "#!/bin/sh\nfor word; do case $word in *.glb) name=${word##*/};; esac; done\n"
               "echo \"begin $name\" >> '" +
                   file("calls") + "'\nsleep 0.2\n'" + tool + "' \"$@\" || exit $?\necho \"end $name\" >> '" +
                   file("calls") + "'\n");
    std::filesystem::permissions(file("tool"), std::filesystem::perms::owner_all);
  }

  std::string file(const std::string& name) const { return folder_.file(name); }

  /// How often each line was written by the tool.
  std::map<std::string, int> calls() const {
    std::map<std::string, int> counts;
    std::ifstream lines(file("calls"));
    for (std::string line; std::getline(lines, line);) ++counts[line];
    return counts;
  }

  int ended() const {
    int ends = 0;
    for (const auto& [line, count] : calls()) ends += line.starts_with("end ") ? count : 0;
    return ends;
  }

  /// Starts `command` as a session of its own and ends all of it when some files are done and some are not.
  void interrupt(std::vector<std::string> command) {
    command.insert(command.begin(), "setsid");
    RunningProcess running(command);
    while (ended() < 3 && running.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    running.signal_group(SIGTERM);
    running.wait();
    done_before_ = ended();
    ASSERT_GE(done_before_, 3);
    ASSERT_LT(done_before_, 8);
    before_ = calls();
  }

  /// Every file is there and what it should be; none that was done was begun again.
  void expect_complete(const std::string& out) {
    for (const std::string& name : names_) {
      const std::string base = std::filesystem::path(name).filename().string();
      EXPECT_EQ(calls()["end " + base], 1) << name;
      if (before_["end " + base] == 1) EXPECT_EQ(calls()["begin " + base], before_["begin " + base]) << name;
      const ProcessResult alone = run_process({tool, file("assets/" + name), file("alone.glb"), "--quiet"});
      ASSERT_EQ(alone.exit_code, 0) << alone.err;
      EXPECT_EQ(read_bytes(file("alone.glb")), read_bytes(out + "/" + name)) << name;
    }
    for (const auto& entry : std::filesystem::recursive_directory_iterator(out))
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
  }

  ScratchFolder folder_;
  std::vector<std::string> names_;
  std::map<std::string, int> before_;
  int done_before_ = 0;
};

TEST_F(Pipeline, GnuParallelIsInterruptedAndResumed) {
  if (!has("parallel")) GTEST_SKIP() << "needs GNU parallel";
  const std::vector<std::string> command{
      "env", "GLTF_NMC=" + file("tool"), "JOBS=2", examples + "/with_parallel.sh", file("assets"), file("out")};
  interrupt(command);
  const ProcessResult resumed = run_process(command);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.out, testing::HasSubstr("8 of 8 files done"));
  expect_complete(file("out"));

  // Once more: nothing to do.
  const std::map<std::string, int> all = calls();
  EXPECT_EQ(run_process(command).exit_code, 0);
  EXPECT_EQ(calls(), all);

  // Another file: the list is another one, and the cache has the rest.
  write_bytes(file("assets/heroes/new.glb"), TinyGlb(20).bytes());
  const ProcessResult more = run_process(command);
  EXPECT_EQ(more.exit_code, 0) << more.err;
  EXPECT_THAT(more.out, testing::HasSubstr("9 of 9 files done"));
  EXPECT_TRUE(std::filesystem::exists(file("out/heroes/new.glb")));
}

TEST_F(Pipeline, GnuParallelTellsFailures) {
  if (!has("parallel")) GTEST_SKIP() << "needs GNU parallel";
  write_text(file("assets/heroes/broken.glb"), "no GLB");
  const std::vector<std::string> command{"env",          "GLTF_NMC=" + tool, "JOBS=2", examples + "/with_parallel.sh",
                                         file("assets"), file("out")};
  const ProcessResult result = run_process(command);
  EXPECT_NE(result.exit_code, 0);
  EXPECT_THAT(result.out, testing::HasSubstr("8 of 9 files done"));
  EXPECT_THAT(result.err, testing::HasSubstr("broken.glb"));
}

TEST_F(Pipeline, NinjaIsInterruptedAndResumed) {
  if (!has("cmake") || !has("ninja")) GTEST_SKIP() << "needs cmake and ninja";
  const ProcessResult configured = run_process({"cmake", "-S", examples, "-B", file("out"), "-G", "Ninja",
                                                "-DASSETS=" + file("assets"), "-DGLTF_NMC=" + file("tool")});
  ASSERT_EQ(configured.exit_code, 0) << configured.out << configured.err;
  const std::vector<std::string> command{"ninja", "-C", file("out"), "-j", "2"};
  interrupt(command);
  const ProcessResult resumed = run_process(command);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.out;
  expect_complete(file("out/characters"));
  EXPECT_THAT(run_process(command).out, testing::HasSubstr("no work to do"));

  write_bytes(file("assets/heroes/0.glb"), TinyGlb(30).bytes());  // one has changed
  EXPECT_EQ(run_process(command).exit_code, 0);
  EXPECT_EQ(calls()["end 0.glb"], 2);
  EXPECT_EQ(ended(), 9);
}

}  // namespace
}  // namespace nmc::test
