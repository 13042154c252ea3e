// Faults from outside: killed, interrupted, disk full, no memory, no permission, two runs at once. The output is the
// old file or the new one, whole.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <random>
#include <thread>

#include "cli/command_line.h"
#include "gltf/document.h"
#include "support/running.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::microseconds;

const std::string tool = std::string(NMC_BUILD_DIR) + "/gltf-nmc";

class Faults : public CommandLine {
 protected:
  /// The tiny character with so many bytes of something else that writing takes a good part of the time.
  std::string large_input(std::size_t megabytes) {
    TinyGlb tiny(11);
    std::vector<std::uint32_t> noise(megabytes << 18);
    std::mt19937 random(1);
    std::generate(noise.begin(), noise.end(), [&] { return static_cast<std::uint32_t>(random()); });
    tiny.add(noise, 5125, "SCALAR", 1);
    return input("in.glb", tiny.bytes());
  }

  std::vector<std::string> command(const std::string& in, const std::string& out,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{tool, in, out, "--quiet", "--effort", "1", "--threads", "1"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  /// The same command under limits of the shell's ulimit, such as "-f 64" (KiB).
  static std::vector<std::string> limited(const std::string& limits, const std::vector<std::string>& command) {
    std::vector<std::string> arguments{"bash", "-c", "ulimit -c 0 " + limits + " || exit 99; exec \"$@\"", "bash"};
    arguments.insert(arguments.end(), command.begin(), command.end());
    return arguments;
  }

  /// What a reader of an output finds: its JSON and the bytes of its buffers.
  static std::string content(const std::string& path) {
    const gltf::Document document = gltf::read_document(path);
    gltf::Json json = document.json;
    for (auto& buffer : json["buffers"]) buffer.erase("uri");
    std::string text = json.dump();
    for (const gltf::Bytes& bytes : document.buffers) text.append(bytes.begin(), bytes.end());
    return text;
  }

  void expect_no_temporary_files() const {
    for (const std::string& name : folder_.names()) EXPECT_FALSE(name.ends_with(".tmp")) << name;
  }

  void remove_temporary_files() const {
    for (const std::string& name : folder_.names()) {
      if (name.ends_with(".tmp")) fs::remove(file(name));
    }
  }

  /// Kills runs that would replace `out`, at random moments from start to end.
  void expect_old_or_new(const std::string& out, int rounds) {
    const std::string in = large_input(4);
    const std::vector<std::string> old_run = command(in, out, {"--exclude", "wave"});
    const std::vector<std::string> new_run = command(in, out);
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(RunningProcess(new_run).wait(), 0);
    const auto whole = std::chrono::duration_cast<microseconds>(std::chrono::steady_clock::now() - start);
    const std::string new_content = content(out);
    ASSERT_EQ(RunningProcess(old_run).wait(), 0);
    const std::string old_content = content(out);
    ASSERT_NE(old_content, new_content);
    std::mt19937 random(7);
    std::uniform_int_distribution<long> moment(0, static_cast<long>(1.1 * static_cast<double>(whole.count())));
    for (int round = 0; round < rounds; ++round) {
      const bool replaced_by_old = round % 2 == 1;  // so that every round has something to replace
      RunningProcess run(replaced_by_old ? old_run : new_run);
      std::this_thread::sleep_for(microseconds(moment(random)));
      run.signal(SIGKILL);
      run.wait();
      const std::string now = content(out);
      ASSERT_TRUE(now == old_content || now == new_content) << "round " << round;
      remove_temporary_files();
    }
  }
};

TEST_F(Faults, KilledAtAnyMomentLeavesTheOldGlbOrTheNew) { expect_old_or_new(file("out.glb"), 50); }

TEST_F(Faults, KilledAtAnyMomentLeavesTheOldGltfOrTheNewWithItsBuffers) { expect_old_or_new(file("out.gltf"), 50); }

TEST_F(Faults, InterruptedWhileWritingLeavesNothingBehind) {
  const std::string in = large_input(16);
  for (const std::string name : {"out.glb", "out.gltf"}) {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      SCOPED_TRACE(name + " and signal " + std::to_string(signal));
      RunningProcess run(command(in, file(name)));
      // A file with a temporary name: it is writing now.
      while (run.is_running() && folder_.names().size() == 1) std::this_thread::sleep_for(microseconds(200));
      run.signal(signal);
      const int code = run.wait();
      // A run that was over first has its whole output.
      if (code == 0) {
        EXPECT_FALSE(content(file(name)).empty());
        for (const std::string& made : folder_.names()) {
          if (made != "in.glb") fs::remove(file(made));
        }
      } else {
        EXPECT_EQ(code, 128 + signal);
      }
      expect_only_inputs();
    }
  }
}

TEST_F(Faults, FullDiskIsASentence) {
  const std::string in = large_input(1);
  for (const std::string name : {"out.glb", "out.gltf"}) {
    SCOPED_TRACE(name);
    const ProcessResult result = run_process(limited("-f 512", command(in, file(name))));
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, testing::StartsWith("gltf-nmc: "));
    EXPECT_THAT(result.err, testing::HasSubstr("cannot be written: "));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1);
    expect_only_inputs();
  }
}

TEST_F(Faults, ReadOnlyFolderIsASentence) {
  const std::string in = input("in.glb", TinyGlb(3).bytes());
  std::vector<std::string> arguments = command(in, file("out.glb"));
  if (geteuid() == 0) {
    arguments.insert(arguments.begin(), {"setpriv", "--reuid=65534", "--clear-groups"});
    if (run_process({"setpriv", "--reuid=65534", "--clear-groups", tool, "--version"}).exit_code != 0)
      GTEST_SKIP() << "the user nobody cannot run " << tool;
  }
  fs::permissions(folder_.path(), fs::perms(0555));
  const ProcessResult result = run_process(arguments);
  fs::permissions(folder_.path(), fs::perms(0755));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.err, testing::HasSubstr("out.glb cannot be written: Permission denied"));
  expect_only_inputs();
}

TEST_F(Faults, TwoRunsOnOneOutputLeaveTheFileOfOne) {
  const std::string in = large_input(2);
  for (const std::string name : {"out.glb", "out.gltf"}) {
    SCOPED_TRACE(name);
    const std::string out = file(name);
    const std::vector<std::string> left = command(in, out, {"--exclude", "wave"}), right = command(in, out);
    ASSERT_EQ(RunningProcess(left).wait(), 0);
    const std::string left_content = content(out);
    ASSERT_EQ(RunningProcess(right).wait(), 0);
    const std::string right_content = content(out);
    for (int round = 0; round < 5; ++round) {
      RunningProcess first(left), second(right);
      EXPECT_EQ(first.wait(), 0);
      EXPECT_EQ(second.wait(), 0);
      const std::string now = content(out);
      EXPECT_TRUE(now == left_content || now == right_content);
      expect_no_temporary_files();
    }
    const std::size_t files = name == "out.glb" ? 2 : 3;  // the input, the output, and a .gltf's buffer
    EXPECT_EQ(folder_.names().size(), files) << testing::PrintToString(folder_.names());
    for (const std::string& made : folder_.names()) {
      if (made != "in.glb") fs::remove(file(made));
    }
  }
}

TEST_F(Faults, ReplacingItsOwnInputIsSafe) {
  const std::string in = input("in.glb", TinyGlb(11).bytes());
  run_well({in, file("model.gltf"), "--quiet", "--exclude", "wave"});
  const std::string before = content(file("model.gltf"));
  run_well({file("model.gltf"), file("model.gltf"), "--quiet", "--effort", "1"});
  EXPECT_NE(content(file("model.gltf")), before);
  run_well({"decode", file("model.gltf"), file("model.gltf"), "--quiet"});
  EXPECT_EQ(folder_.names().size(), 3u) << testing::PrintToString(folder_.names());
  run_well({"verify", in, file("model.gltf")});
}

TEST_F(Faults, TooLittleMemoryIsASentence) {
  if (sanitized) GTEST_SKIP() << "AddressSanitizer needs the whole address space";
  const std::string in = large_input(32);
  bool has_run = false, has_failed = false;
  for (const int megabytes : {100, 120, 140, 160, 180, 200, 250, 300, 400, 600}) {
    SCOPED_TRACE(megabytes);
    const ProcessResult result =
        run_process(limited("-v " + std::to_string(megabytes * 1024), command(in, file("out.glb"))));
    // Before main the loader speaks for itself.
    if (result.exit_code == 127) continue;
    if (result.exit_code == 0) {
      has_run = true;
      fs::remove(file("out.glb"));
      continue;
    }
    has_failed = true;
    EXPECT_EQ(result.exit_code, 6);
    EXPECT_EQ(result.err, "gltf-nmc: there is not enough memory for this file.\n");
    expect_only_inputs();
  }
  EXPECT_TRUE(has_failed);
  EXPECT_TRUE(has_run);
}

}  // namespace
}  // namespace nmc::test
