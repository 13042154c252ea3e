// The streams of tests/golden, which the JavaScript decoder reads in tests/js/golden.test.mjs: the good ones say what
// closed forms say, the bad ones are refused with the code that their names begin with.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "codec/decoded_set.h"
#include "codec/reference_codec.h"
#include "support/process.h"
#include "support/scratch.h"

namespace nmc::test {
namespace {

using Json = nlohmann::json;

const std::filesystem::path golden = std::filesystem::path(NMC_SOURCE_DIR) / "tests/golden";

std::vector<std::string> names(const std::string& kind) {
  std::vector<std::string> found;
  for (const auto& entry : std::filesystem::directory_iterator(golden / kind))
    if (entry.path().extension() == ".nmc") found.push_back(entry.path().stem());
  std::sort(found.begin(), found.end());
  return found;
}

struct Refusal {
  std::string code, sentence;
};

/// The cells of a row of a table in Markdown; none where the line is no such row.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  if (!line.starts_with("| ")) return cells;
  for (std::size_t at = 2, end = 0; (end = line.find(" |", at)) != std::string::npos; at = end + 3) {
    cells.push_back(line.substr(at, end - at));
    if (end + 3 > line.size()) break;
  }
  return cells;
}

/// The table "Refusals" of the specification, by number; place 0 is empty.
std::vector<Refusal> refusals() {
  std::ifstream file(std::filesystem::path(NMC_SOURCE_DIR) / "gltf_ext/README.md");
  std::vector<Refusal> table(1);
  for (std::string line; std::getline(file, line);) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() < 3 || cells[0].size() < 3 || !cells[0].starts_with("`") || cells[1].size() != 1 ||
        cells[1][0] < '0' || cells[1][0] > '9')
      continue;
    EXPECT_EQ(static_cast<std::size_t>(cells[1][0] - '0'), table.size());
    table.push_back({cells[0].substr(1, cells[0].size() - 2), cells[2]});
  }
  return table;
}

nmc_result open(const Bytes& bytes) {
  nmc_info info;
  if (const nmc_result result = nmc_read_info(bytes.data(), bytes.size(), &info); result != NMC_OK) return result;
  std::vector<std::uint64_t> workspace(info.workspace_bytes / 8 + 1);
  nmc_set set;
  return nmc_open(&set, bytes.data(), bytes.size(), workspace.data(), workspace.size() * 8);
}

class GoodStreams : public testing::TestWithParam<std::string> {};

TEST_P(GoodStreams, SayWhatClosedFormsSay) {
  const Json expected = Json::parse(read_bytes(golden / "good" / (GetParam() + ".json")));
  const codec::DecodedSet decoded(read_bytes(golden / "good" / (GetParam() + ".nmc")), GetParam());
  const nmc_set& set = decoded.raw();
  ASSERT_EQ(set.info.targets, expected["targets"].size());
  const std::vector<std::string> paths{"translation", "rotation", "scale", "weights"};
  for (std::size_t t = 0; t < set.info.targets; ++t) {
    EXPECT_EQ(paths[set.targets[t].path], expected["targets"][t]["path"]);
    EXPECT_EQ(set.targets[t].width, expected["targets"][t]["width"]);
  }
  std::vector<std::uint64_t> scratch(set.info.scratch_bytes / 8 + 1);
  std::vector<float> pose(set.info.slots);
  ASSERT_EQ(set.info.clips, expected["clips"].size());
  for (std::uint32_t c = 0; c < set.info.clips; ++c) {
    const Json& clip = expected["clips"][c];
    const float* times = nmc_times(&set, c);
    EXPECT_EQ(std::vector<float>(times, times + set.clips[c].samples), clip["times"].get<std::vector<float>>());
    for (std::uint32_t t = 0; t < set.info.targets; ++t) EXPECT_EQ(nmc_state(&set, c, t), clip["states"][t]);
    for (const Json& at : clip["poses"]) {
      ASSERT_EQ(nmc_evaluate(&set, c, at["seconds"], NMC_CLAMP, pose.data(), scratch.data()), NMC_OK);
      ASSERT_EQ(at["values"].size(), pose.size());
      for (std::size_t i = 0; i < pose.size(); ++i) {
        const double value = at["values"][i];
        // The conformance section of gltf_ext/README.md.
        EXPECT_NEAR(pose[i], value, 1e-5 * std::max(1.0, std::abs(value)))
            << "clip " << c << " at " << at["seconds"] << ", slot " << i;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, GoodStreams, testing::ValuesIn(names("good")),
                         [](const auto& test) { return test.param; });

class BadStreams : public testing::TestWithParam<std::string> {};

TEST_P(BadStreams, AreRefusedWithTheirCode) {
  const std::string code = GetParam().substr(0, GetParam().find('_'));
  const std::vector<Refusal> table = refusals();
  const nmc_result result = open(read_bytes(golden / "bad" / (GetParam() + ".nmc")));
  ASSERT_LT(static_cast<std::size_t>(result), table.size());
  EXPECT_EQ(table[static_cast<std::size_t>(result)].code, code);
}

INSTANTIATE_TEST_SUITE_P(All, BadStreams, testing::ValuesIn(names("bad")), [](const auto& test) { return test.param; });

TEST(Golden, ResultsHaveTheSentencesOfTheSpecification) {
  const std::vector<Refusal> table = refusals();
  ASSERT_EQ(table.size(), static_cast<std::size_t>(NMC_ERROR_ARGUMENT) + 1);
  for (std::size_t i = 1; i < table.size(); ++i) EXPECT_EQ(table[i].sentence, nmc_message(static_cast<nmc_result>(i)));
}

TEST(Golden, TheGeneratorStillWritesTheGoodStreams) {
  const ScratchFolder folder;
  const ProcessResult made = run_process({std::string(NMC_BUILD_DIR) + "/make_golden", folder.file("")});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  for (const std::string& name : names("good"))
    EXPECT_EQ(read_bytes(folder.file(name + ".nmc")), read_bytes(golden / "good" / (name + ".nmc"))) << name;
}

}  // namespace
}  // namespace nmc::test
