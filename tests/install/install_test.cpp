// What `cmake --install` puts into a prefix is what a program elsewhere needs.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/process.h"
#include "support/sanitized.h"
#include "support/scratch.h"

namespace nmc::test {
namespace {

const std::string source = NMC_SOURCE_DIR;

ProcessResult shell(const std::string& command) {
  return run_process({"sh", "-c", command}, std::chrono::seconds(300));
}

bool has(const std::string& program) { return shell("command -v " + program).exit_code == 0; }

class Install : public testing::Test {
 protected:
  void install(const std::string& component) {
    const ProcessResult result =
        run_process({"cmake", "--install", NMC_BUILD_DIR, "--component", component, "--prefix", prefix_});
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }

  void build_with_cmake(const std::string& options) {
    const ProcessResult result = shell("cmake -S '" + source + "/tests/install/consumer' -B '" + folder_.file("build") +
                                       "' -DCMAKE_PREFIX_PATH='" + prefix_ + "' " + options + " && cmake --build '" +
                                       folder_.file("build") + "'");
    ASSERT_EQ(result.exit_code, 0) << result.out << result.err;
  }

  /// Runs a consumer, which prints the first pose of a golden stream.
  static void expect_first_pose(const std::string& program) {
    const std::string stream = source + "/tests/golden/good/cosine";
    const ProcessResult result = run_process({program, stream + ".nmc"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto expected = nlohmann::json::parse(read_bytes(stream + ".json"));
    std::istringstream lines(result.out);
    for (const double value : expected["clips"][0]["poses"][0]["values"]) {
      double printed = 0;
      ASSERT_TRUE(lines >> printed);
      EXPECT_NEAR(printed, value, 1e-5 * std::max(1.0, std::abs(value)));  // gltf_ext/README.md, conformance
    }
    std::string rest;
    EXPECT_FALSE(lines >> rest);
  }

  ScratchFolder folder_;
  std::string prefix_ = folder_.file("prefix");
};

TEST_F(Install, TheDecoderIsFoundByFindPackage) {
  install("decoder");
  build_with_cmake("");
  expect_first_pose(folder_.file("build/consumer"));
}

TEST_F(Install, TheDecoderIsFoundByPkgConfig) {
  if (!has("pkg-config")) GTEST_SKIP() << "needs pkg-config";
  install("decoder");
  const ProcessResult built =
      shell("cd '" + folder_.path().string() +
            "' && export PKG_CONFIG_PATH=$(dirname $(find prefix -name nmc_decode.pc)) && cc -std=c99 "
            "$(pkg-config --cflags nmc_decode) '" +
            source + "/tests/install/consumer/consumer.c' $(pkg-config --libs nmc_decode) -o consumer");
  ASSERT_EQ(built.exit_code, 0) << built.out << built.err;
  expect_first_pose(folder_.file("consumer"));
}

TEST_F(Install, TheLibraryIsFoundByFindPackage) {
  install("decoder");
  install("nmc");
  // A library that was built with sanitizers needs their run-time parts, of the same compiler, in whatever links it.
  build_with_cmake(sanitized ? "-DWITH_LIBRARY=ON -DCMAKE_EXE_LINKER_FLAGS=-fsanitize=address,undefined "
                               "-DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++"
                             : "-DWITH_LIBRARY=ON");
  expect_first_pose(folder_.file("build/consumer"));
  EXPECT_EQ(run_process({folder_.file("build/library_consumer")}).exit_code, 0);
  EXPECT_EQ(run_process({folder_.file("prefix/bin/gltf-nmc"), "--version"}).exit_code, 0);
}

TEST_F(Install, APackageForDebianHoldsToolHeaderAndLibrary) {
  if (!has("cpack") || !has("dpkg-deb") || !has("dpkg-shlibdeps")) GTEST_SKIP() << "needs cpack and dpkg-dev";
  const std::string here = folder_.path().string();
  const ProcessResult packed = run_process(
      {"cpack", "-G", "DEB", "--config", std::string(NMC_BUILD_DIR) + "/CPackConfig.cmake", "-B", here, "-D",
       "CPACK_INSTALL_CMAKE_PROJECTS=" NMC_BUILD_DIR ";gltf-nmc;decoder;/;" NMC_BUILD_DIR ";gltf-nmc;nmc;/"});
  ASSERT_EQ(packed.exit_code, 0) << packed.out << packed.err;
  const ProcessResult list = shell("dpkg-deb --contents '" + here + "'/gltf-nmc_*.deb");
  for (const char* file : {"/bin/gltf-nmc", "/nmc_decode.h", "/libnmc.a", "/gltf-nmc-config.cmake", "/nmc_decode.pc",
                           "/man1/gltf-nmc.1", "/completions/gltf-nmc", "/_gltf-nmc", "/gltf-nmc.fish"})
    EXPECT_NE(list.out.find(file), std::string::npos) << file << "\n" << list.out;
}

}  // namespace
}  // namespace nmc::test
