// The error that our report claims against the referee: a program by other hands that reads the two files and measures.
#include <gtest/gtest.h>

#include <cmath>

#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

struct RefereeCase {
  const char* file;
  const char* max_frequencies;  ///< small where training is slow: agreement, not compression, is tested here
  bool in_sanitized_builds;
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
  const Json ours = Json::parse(run_well({in, file("packed.glb"), "--profile", "paper", "--tolerance", "2%",
                                          "--max-frequencies", c.max_frequencies, "--time-limit", "60", "--json"},
                                         timeout)
                                    .out);
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
    EXPECT_LE(max_joint, 0.0201 * size);
  }
}

INSTANTIATE_TEST_SUITE_P(
    RealFiles, Referee,
    testing::Values(RefereeCase{"game/fox.glb", "8", true}, RefereeCase{"game/cesium_man.glb", "8", true},
                    RefereeCase{"game/brain_stem.glb", "2", false}, RefereeCase{"game/knight_76clips.glb", "2", false},
                    RefereeCase{"game/stag.glb", "4", false}, RefereeCase{"mocap/cmuamc_02_01.glb", "6", false},
                    RefereeCase{"mocap/cmuamc_02_03.glb", "6", false},
                    RefereeCase{"mocap/cmuamc_35_01.glb", "6", false},
                    RefereeCase{"mocap/cmuamc_49_18_30hz.glb", "4", false},
                    RefereeCase{"mocap/keijiro30_85_12.glb", "4", false},
                    RefereeCase{"mocap/cmufbx_49_08.glb", "4", false}),
    [](const auto& info) {
      std::string name = std::filesystem::path(info.param.file).stem().string();
      return name;
    });

}  // namespace
}  // namespace nmc::test
