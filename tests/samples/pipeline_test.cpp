// The examples of samples/pipeline on two workers: interrupted in the middle, run again, nothing lost or done twice.
#include <gmock/gmock.h>
#include <sys/stat.h>

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

  /// The cache's entries with the numbers of their files: an entry that is made again is another file.
  std::map<std::string, ino_t> entries() const {
    std::map<std::string, ino_t> inodes;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(file("cache"))) {
      struct stat status {};
      if (entry.path().extension() == ".nmc" && stat(entry.path().c_str(), &status) == 0)
        inodes[entry.path().string()] = status.st_ino;
    }
    return inodes;
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
    entries_before_ = entries();
    ASSERT_GE(entries_before_.size(), 3U);
  }

  /// Every file is there and what it should be; each was compressed once. A job that ended in the moment of the
  /// interruption may have been started again (one for each worker), and then has found its result in the cache.
  void expect_complete(const std::string& out) {
    for (const std::string& name : names_) {
      const std::string base = std::filesystem::path(name).filename().string();
      EXPECT_GE(calls()["end " + base], 1) << name;
      const ProcessResult alone = run_process({tool, file("assets/" + name), file("alone.glb"), "--quiet"});
      ASSERT_EQ(alone.exit_code, 0) << alone.err;
      EXPECT_EQ(read_bytes(file("alone.glb")), read_bytes(out + "/" + name)) << name;
    }
    EXPECT_LE(ended(), 8 + 2);
    const std::map<std::string, ino_t> all = entries();
    EXPECT_EQ(all.size(), 8U);
    for (const auto& [name, inode] : entries_before_) EXPECT_EQ(all.at(name), inode) << name;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(out))
      EXPECT_NE(entry.path().extension(), ".tmp") << entry.path();
  }

  ScratchFolder folder_;
  std::vector<std::string> names_;
  std::map<std::string, ino_t> entries_before_;
  int done_before_ = 0;
};

TEST_F(Pipeline, GnuParallelIsInterruptedAndResumed) {
  if (!has("parallel")) GTEST_SKIP() << "needs GNU parallel";
  const std::vector<std::string> command{"env",
                                         "GLTF_NMC=" + file("tool"),
                                         "JOBS=2",
                                         "CACHE=" + file("cache"),
                                         examples + "/with_parallel.sh",
                                         file("assets"),
                                         file("out")};
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

/// Two hosts, which a program in the place of ssh makes of this one. The server of ssh sets SHELL, and GNU parallel
/// relies on it.
TEST_F(Pipeline, GnuParallelUsesSeveralHosts) {
  if (!has("parallel")) GTEST_SKIP() << "needs GNU parallel";
  write_text(file("ssh"),
             "#!/bin/sh\nwhile case $1 in -*) true ;; *) false ;; esac; do shift; done\nshift\n"
             "[ \"$1\" != -- ] || shift\nexport SHELL=/bin/sh\ncd / && exec sh -c \"$*\"\n");
  std::filesystem::permissions(file("ssh"), std::filesystem::perms::owner_all);
  write_text(file("hosts"), "1/first\n1/second\n");
  const ProcessResult result =
      run_process({"env", "PARALLEL_SSH=" + file("ssh"), "HOSTS=" + file("hosts"), "GLTF_NMC=" + file("tool"),
                   "CACHE=" + file("cache"), examples + "/with_parallel.sh", file("assets"), file("out")});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_THAT(result.out, testing::HasSubstr("8 of 8 files done"));
  expect_complete(file("out"));
  const Bytes log = read_bytes(file("out/jobs.log"));
  const std::string text(log.begin(), log.end());
  EXPECT_THAT(text, testing::HasSubstr("\tfirst\t"));
  EXPECT_THAT(text, testing::HasSubstr("\tsecond\t"));
}

TEST_F(Pipeline, GnuParallelTellsFailures) {
  if (!has("parallel")) GTEST_SKIP() << "needs GNU parallel";
  write_text(file("assets/heroes/broken.glb"), "no GLB");
  const std::vector<std::string> command{
      "env",          "GLTF_NMC=" + tool, "JOBS=2", "CACHE=" + file("cache"), examples + "/with_parallel.sh",
      file("assets"), file("out")};
  const ProcessResult result = run_process(command);
  EXPECT_NE(result.exit_code, 0);
  EXPECT_THAT(result.out, testing::HasSubstr("8 of 9 files done"));
  EXPECT_THAT(result.err, testing::HasSubstr("broken.glb"));
}

TEST_F(Pipeline, NinjaIsInterruptedAndResumed) {
  if (!has("cmake") || !has("ninja")) GTEST_SKIP() << "needs cmake and ninja";
  const ProcessResult configured =
      run_process({"cmake", "-S", examples, "-B", file("out"), "-G", "Ninja", "-DASSETS=" + file("assets"),
                   "-DGLTF_NMC=" + file("tool"), "-DRESULTS=" + file("cache")});
  ASSERT_EQ(configured.exit_code, 0) << configured.out << configured.err;
  const std::vector<std::string> command{"ninja", "-C", file("out"), "-j", "2"};
  interrupt(command);
  const ProcessResult resumed = run_process(command);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.out;
  expect_complete(file("out/characters"));
  EXPECT_THAT(run_process(command).out, testing::HasSubstr("no work to do"));

  write_bytes(file("assets/heroes/0.glb"), TinyGlb(30).bytes());  // one has changed
  const int ends = ended();
  EXPECT_EQ(run_process(command).exit_code, 0);
  EXPECT_EQ(ended(), ends + 1);
}

}  // namespace
}  // namespace nmc::test
