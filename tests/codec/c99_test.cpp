// The reference decoder outside of the library: as C99 and C++, by other compilers, in a program of its own.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "codec/decoded_set.h"
#include "codec/reference_codec.h"
#include "made_set.h"
#include "support/process.h"
#include "support/scratch.h"

namespace nmc::test {
namespace {

bool exists(const std::string& program) {
  try {
    return run_process({program, "--version"}).exit_code == 0;
  } catch (const std::runtime_error&) {
    return false;
  }
}

const std::string header = std::string(NMC_SOURCE_DIR) + "/gltf_ext/c/nmc_decode.h";

/// Compiler, language and standard.
using Build = std::vector<std::string>;

class Compilers : public testing::TestWithParam<Build> {};

TEST_P(Compilers, TakeTheHeaderWithoutAWarning) {
  const Build& build = GetParam();
  if (!exists(build[0])) GTEST_SKIP() << "needs " << build[0];
  for (const char* half : {"-DNMC_DECODE_IMPLEMENTATION", "-DNMC_ENCODER", "-DNMC_NOTHING"}) {
    const ProcessResult result =
        run_process({build[0], "-x", build[1], build[2], "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Wshadow",
                     "-Werror", "-fsyntax-only", half, "-DNMC_DECODE_IMPLEMENTATION", "-include", header, "/dev/null"});
    EXPECT_EQ(result.exit_code, 0) << half << "\n" << result.err;
  }
}

INSTANTIATE_TEST_SUITE_P(All, Compilers,
                         testing::Values(Build{"gcc", "c", "-std=c99"}, Build{"gcc", "c", "-std=c17"},
                                         Build{"clang", "c", "-std=c99"}, Build{"g++", "c++", "-std=c++11"},
                                         Build{"g++", "c++", "-std=c++20"}, Build{"clang++", "c++", "-std=c++20"}));

TEST(C99, AProgramOfItsOwnPlaysTheSame) {
  const ScratchFolder folder;
  const std::vector<std::string> seconds{"0", "0.2", "0.517", "-3.3", "100"};
  for (const SetShape& shape : {SetShape{codec::Basis::sine, {4, 17, 1, 9}, 3},
                                SetShape{codec::Basis::cosine, {33}, 2, true, true, false, 4}}) {
    const std::vector<std::uint8_t> stream = write_clip_set(SetMaker().make(shape));
    write_bytes(folder.file("stream.nmc"), stream);
    std::vector<std::string> command{std::string(NMC_BUILD_DIR) + "/decode_user", folder.file("stream.nmc")};
    command.insert(command.end(), seconds.begin(), seconds.end());
    const ProcessResult played = run_process(command);
    ASSERT_EQ(played.exit_code, 0) << played.err;
    std::istringstream lines(played.out);

    const codec::DecodedSet decoded(stream, "test");
    std::vector<std::uint64_t> scratch(decoded.raw().info.scratch_bytes / 8 + 1);
    std::vector<float> pose(decoded.raw().info.slots);
    for (const std::string& t : seconds)
      for (std::uint32_t clip = 0; clip < decoded.clip_count(); ++clip) {
        ASSERT_EQ(nmc_evaluate(&decoded.raw(), clip, std::atof(t.c_str()), NMC_LOOP, pose.data(), scratch.data()),
                  NMC_OK);
        for (const float value : pose) {
          double other = 0;
          ASSERT_TRUE(lines >> other);
          // A compiler may fuse a multiplication and an addition: the last bit may differ.
          EXPECT_NEAR(other, value, 3e-7 * std::max(1.0, std::abs(other)));
        }
      }
    std::string rest;
    EXPECT_FALSE(lines >> rest);
  }
}

TEST(C99, ABrokenStreamEndsWithItsError) {
  const ScratchFolder folder;
  std::vector<std::uint8_t> stream = write_clip_set(SetMaker().make({}));
  stream.back() ^= 4;
  write_bytes(folder.file("stream.nmc"), stream);
  const ProcessResult result =
      run_process({std::string(NMC_BUILD_DIR) + "/decode_user", folder.file("stream.nmc"), "0"});
  EXPECT_EQ(result.exit_code, NMC_ERROR_CHECKSUM);
  EXPECT_NE(result.err.find("checksum"), std::string::npos);
}

}  // namespace
}  // namespace nmc::test
