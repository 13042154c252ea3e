// The error that our report claims against the referee: a program by other hands that reads the two files and measures.
#include <gtest/gtest.h>

#include <cmath>

#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

struct RefereeCase {
  const char* file;
  const char* tolerance;  ///< larger where 2% takes minutes of training: what is tested is agreement
  bool in_sanitized_builds = false;
};

std::string shared() { return NMC_SHARED_DIR; }

class Referee : public CommandLine, public testing::WithParamInterface<RefereeCase> {};

TEST_P(Referee, AgreesWithTheReport) {
  const RefereeCase& c = GetParam();
  if (!std::filesystem::exists(shared() + "/tools/measure.py")) GTEST_SKIP() << "needs " << shared();
  if (run_process({"/usr/bin/python3", "-c", "import numpy"}).exit_code != 0)
    GTEST_SKIP() << "needs python3 with numpy";
  if (sanitized && !c.in_sanitized_builds) GTEST_SKIP() << "too slow with sanitizers";
  const std::string in = shared() + "/data/" + c.file;
  const std::chrono::seconds timeout(500);
  const Json ours = Json::parse(
      run_well({in, file("packed.glb"), "--profile", "paper", "--tolerance", c.tolerance, "--json"}, timeout).out);
  ASSERT_GT(ours["totals"]["compressed"], 0);
  run_well({"decode", file("packed.glb"), file("plain.glb"), "--quiet"}, timeout);
  const ProcessResult measured =
      run_process({"/usr/bin/python3", shared() + "/tools/measure.py", in, file("plain.glb"), "--json"}, timeout);
  ASSERT_EQ(measured.exit_code, 0) << measured.out << measured.err;
  const Json theirs = Json::parse(measured.out);

  const double size = theirs["size"].get<double>();
  EXPECT_NEAR(ours["size_world_units"].get<double>(), size, 1e-5 * size);
  ASSERT_EQ(ours["animations"].size(), theirs["animations"].size());
  for (std::size_t i = 0; i < ours["animations"].size(); ++i) {
    const Json& mine = ours["animations"][i];
    SCOPED_TRACE(mine["name"]);
    const double max_joint = theirs["animations"][i]["errors"]["joint"]["max"].get<double>();
    EXPECT_NEAR(mine["error"]["max_joint_fraction_of_size"].get<double>(), max_joint / size, 1e-4);
    EXPECT_LE(max_joint, (ours["tolerance_fraction_of_size"].get<double>() + 1e-4) * size);
  }
}

INSTANTIATE_TEST_SUITE_P(
    RealFiles, Referee,
    testing::Values(RefereeCase{"game/fox.glb", "2%", true}, RefereeCase{"game/cesium_man.glb", "2%", true},
                    RefereeCase{"game/brain_stem.glb", "15%"}, RefereeCase{"game/knight_76clips.glb", "2%"},
                    RefereeCase{"game/stag.glb", "2%"}, RefereeCase{"mocap/cmuamc_02_01.glb", "2%"},
                    RefereeCase{"mocap/cmuamc_02_03.glb", "2%"}, RefereeCase{"mocap/cmuamc_35_01.glb", "2%"},
                    RefereeCase{"mocap/cmuamc_49_18_30hz.glb", "2%"}, RefereeCase{"mocap/keijiro30_85_12.glb", "10%"},
                    RefereeCase{"mocap/cmufbx_49_08.glb", "2%"}),
    [](const auto& test) { return std::filesystem::path(test.param.file).stem().string(); });

}  // namespace
}  // namespace nmc::test
