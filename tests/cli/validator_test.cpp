// What we write is valid glTF in the eyes of the Khronos validator: no errors and no warnings beyond the input's own.
#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

class Validator : public CommandLine {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(tests() + "/node_modules/gltf-validator")) {
      GTEST_SKIP() << "needs gltf-validator: run npm ci in tests/";
    }
  }

  static std::string tests() { return std::string(NMC_SOURCE_DIR) + "/tests"; }

  /// {file: {numErrors, numWarnings, codes}}.
  static Json validate(const std::vector<std::string>& files) {
    std::vector<std::string> arguments{"node", tests() + "/support/validate.mjs"};
    arguments.insert(arguments.end(), files.begin(), files.end());
    const ProcessResult result = run_process(arguments);
    if (result.exit_code != 0) throw std::runtime_error("validate.mjs: " + result.err);
    return Json::parse(result.out);
  }

  void expect_round_trip_valid(const std::string& in, const std::vector<std::string>& options) {
    SCOPED_TRACE(in + " " + testing::PrintToString(options));
    std::vector<std::string> arguments{in, file("packed.glb"), "--quiet", "--tolerance", "1%"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    run_well(arguments, std::chrono::seconds(300));
    run_well({"decode", file("packed.glb"), file("plain.glb"), "--quiet"});
    run_well({"decode", file("packed.glb"), file("plain.gltf"), "--quiet"});
    const Json reports = validate({in, file("packed.glb"), file("plain.glb"), file("plain.gltf")});
    for (const char* name : {"packed.glb", "plain.glb", "plain.gltf"}) {
      const Json& report = reports[file(name)];
      EXPECT_LE(report["numErrors"].get<int>(), reports[in]["numErrors"].get<int>()) << name << report.dump(1);
      EXPECT_LE(report["numWarnings"].get<int>(), reports[in]["numWarnings"].get<int>()) << name << report.dump(1);
    }
  }
};

TEST_F(Validator, TinyCharacter) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  ASSERT_EQ(validate({in})[in]["numErrors"], 0);
  ASSERT_EQ(validate({in})[in]["numWarnings"], 0);
  expect_round_trip_valid(in, {});
  expect_round_trip_valid(in, {"--profile", "paper"});
  expect_round_trip_valid(in, {"--optional"});
  expect_round_trip_valid(in, {"--fallback"});
}

TEST_F(Validator, ImportedMotion) {
  write_text(file("wave.bvh"),
             "HIERARCHY\nROOT hips\n{\nOFFSET 0 1 0\nCHANNELS 4 Xposition Zrotation Xrotation Yrotation\nJOINT "
             "arm\n{\nOFFSET 0 1 0\n"
             "CHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n}\nMOTION\nFrames: 2\nFrame "
             "Time: 0.1\n"
             "0 0 0 0 0 0 0\n1 10 20 30 40 50 60\n");
  run_well({"import", file("wave.bvh"), file("wave.glb")});
  const Json report = validate({file("wave.glb")})[file("wave.glb")];
  EXPECT_EQ(report["numErrors"], 0) << report.dump(1);
  EXPECT_EQ(report["numWarnings"], 0) << report.dump(1);
}

TEST_F(Validator, RealFiles) {
  const std::string game = std::string(NMC_SHARED_DIR) + "/data/game/";
  if (!std::filesystem::exists(game)) GTEST_SKIP() << "needs " << game;
  if (sanitized) GTEST_SKIP() << "too slow with sanitizers";
  for (const char* name : {"fox.glb", "stag.glb", "med_general.glb"}) {
    expect_round_trip_valid(game + name, {"--time-limit", "20", "--effort", "1"});
  }
}

}  // namespace
}  // namespace nmc::test
