// The built gltf-nmc in a folder of its own, and what every failure must look like.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "support/process.h"
#include "support/sanitized.h"
#include "support/scratch.h"

namespace nmc::test {

class CommandLine : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return folder_.file(name); }

  /// Puts an input into the folder; failures must leave it as it is.
  std::string input(const std::string& name, const Bytes& bytes) {
    write_bytes(file(name), bytes);
    inputs_[name] = bytes;
    return file(name);
  }

  ProcessResult run(std::vector<std::string> arguments,
                    std::chrono::seconds timeout = std::chrono::seconds(120)) const {
    arguments.insert(arguments.begin(), std::string(NMC_BUILD_DIR) + "/gltf-nmc");
    ProcessResult result = run_process(arguments, timeout);
    EXPECT_FALSE(result.timed_out) << "after " << timeout.count() << " s: " << testing::PrintToString(arguments);
    return result;
  }

  /// Runs what must succeed without a word on standard error.
  ProcessResult run_well(const std::vector<std::string>& arguments,
                         std::chrono::seconds timeout = std::chrono::seconds(120)) const {
    const ProcessResult result = run(arguments, timeout);
    EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(arguments) << "\n" << result.err;
    EXPECT_EQ(result.err, "");
    return result;
  }

  /// Runs what must fail: with this exit code, one sentence on standard error that has all `parts`, no output, nothing
  /// left in the folder but the inputs, and those untouched.
  void expect_failure(const std::vector<std::string>& arguments, int exit_code, const std::vector<std::string>& parts) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, testing::StartsWith("gltf-nmc: "));
    EXPECT_THAT(result.err, testing::EndsWith(".\n"));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    for (const std::string& part : parts) EXPECT_THAT(result.err, testing::HasSubstr(part));
    expect_only_inputs();
  }

  void expect_only_inputs() {
    std::set<std::string> names;
    for (const auto& [name, bytes] : inputs_) {
      names.insert(name);
      EXPECT_EQ(read_bytes(file(name)), bytes) << name << " has changed";
    }
    EXPECT_EQ(folder_.names(), names);
  }

  ScratchFolder folder_;
  std::map<std::string, Bytes> inputs_;
};

}  // namespace nmc::test
