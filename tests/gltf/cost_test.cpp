// What animations cost: by hand on a small document, and equal to the referee's count on real files.
#include "gltf/cost.h"

#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numeric>

#include "base/error.h"
#include "gltf/edit.h"
#include "support/fake_compression.h"

namespace nmc::gltf {
namespace {

namespace fs = std::filesystem;

Document make_document() {
  Document document;
  document.json = Json::parse(R"({"animations":[
      {"channels":[],"samplers":[{"input":0,"output":1}]},{"channels":[],"samplers":[{"input":0,"output":2}]}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":5,"type":"SCALAR"},
                   {"bufferView":0,"componentType":5122,"count":5,"type":"VEC4"},
                   {"componentType":5126,"count":5,"type":"VEC3","sparse":{"count":2,
                     "indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":2}}},
                   {"bufferView":3,"componentType":5126,"count":99,"type":"VEC3"}],
      "bufferViews":[{"buffer":0,"byteLength":60},{"buffer":0,"byteLength":2},{"buffer":0,"byteLength":24},
                     {"buffer":0,"byteLength":1188}]})");
  return document;
}

TEST(Cost, CountsElementsAndMinifiedJson) {
  const Document document = make_document();
  const auto cost = total_cost(document);
  EXPECT_EQ(cost.key_bytes, 5U * 4 + 5U * 8 + 2U * (1 + 12));
  std::size_t text = document.json["animations"].dump().size();
  for (std::size_t i = 0; i < 3; ++i) text += document.json["accessors"][i].dump().size();
  for (std::size_t i = 0; i < 3; ++i) text += document.json["bufferViews"][i].dump().size();
  EXPECT_EQ(cost.json_bytes, text);
}

TEST(Cost, CountsTheShortestDecimals) {
  const auto cost_of = [](const char* number) {
    Document document;
    document.json = Json::parse(std::string(R"({"animations":[{"extras":)") + number + "}]}");
    return total_cost(document).json_bytes - std::string(R"([{"extras":}])").size();
  };
  // The last is one that nlohmann::json writes with a digit too many.
  for (const std::string number : {"1.5", "-0.25", "100.0", "0.0001", "1e-05", "-1.25e-07", "1e+16", "1.5e+300",
                                   "1234567890123456.0", "0.0", "-12", "-0.0574759915471077"}) {
    EXPECT_EQ(cost_of(number.c_str()), number.size()) << number;
  }
}

TEST(Cost, DividesSharedObjectsEvenly) {
  const auto costs = animation_costs(make_document());
  ASSERT_EQ(costs.size(), 2U);
  EXPECT_EQ(costs[0].key_bytes, 5U * 4 / 2 + 5U * 8);
  EXPECT_EQ(costs[1].key_bytes, 5U * 4 / 2 + 2U * (1 + 12));
  // The list's two brackets and its comma belong to no animation.
  EXPECT_EQ(costs[0].json_bytes + costs[1].json_bytes + 3, total_cost(make_document()).json_bytes);
}

TEST(Cost, NamesBrokenObjects) {
  Document document = make_document();
  document.json["animations"][0]["samplers"][0]["input"] = 17;
  EXPECT_THROW(total_cost(document), Error);
}

/// What the referee's payload() says of each file: "bytes json_bytes" a line. Empty where it cannot run.
std::vector<AnimationCost> ask_referee(const std::vector<fs::path>& files) {
  std::string command = "/usr/bin/python3 -c \"import sys; sys.path.insert(0, '" NMC_SHARED_DIR
                        "/tools'); sys.dont_write_bytecode = True\nimport measure\nfor f in sys.argv[1:]:\n"
                        " p = measure.Asset(f).payload(); print(p['bytes'], p['json_bytes'])\"";
  for (const auto& file : files) command += " '" + file.string() + "'";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen((command + " 2>/dev/null").c_str(), "r"),
                                                             ::pclose);
  std::vector<AnimationCost> costs;
  AnimationCost cost;
  while (pipe && std::fscanf(pipe.get(), "%zu %zu", &cost.key_bytes, &cost.json_bytes) == 2) costs.push_back(cost);
  return costs;
}

TEST(Cost, AgreesWithTheReferee) {
  std::vector<fs::path> files;
  for (const auto* folder : {"game", "odd", "mocap"}) {
    const fs::path root = fs::path(NMC_SHARED_DIR) / "data" / folder;
    if (!fs::exists(root)) GTEST_SKIP() << "no shared data";
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      if (entry.path().extension() == ".glb" || entry.path().extension() == ".gltf") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::string name = (fs::temp_directory_path() / "nmc_cost_XXXXXX").string();
  const fs::path folder = ::mkdtemp(name.data());
  std::vector<Document> documents;
  const std::size_t count = files.size();
  for (std::size_t i = 0; i < count; ++i) {
    documents.push_back(read_document(files[i]));
    if (files[i].extension() != ".glb") continue;
    Document edited = documents.back();
    apply_compression(edited, test::make_fake_edit(edited, Requirement::required, 0.7, 5).edit);
    files.push_back(folder / (std::to_string(i) + ".glb"));
    write_document(edited, files.back());
  }
  for (std::size_t i = count; i < files.size(); ++i) documents.push_back(read_document(files[i]));
  const auto expected = ask_referee(files);
  fs::remove_all(folder);
  if (expected.empty()) GTEST_SKIP() << "the referee does not run here (python3 with numpy)";
  ASSERT_EQ(expected.size(), files.size());
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto cost = total_cost(documents[i]);
    EXPECT_EQ(cost.key_bytes, expected[i].key_bytes) << files[i];
    EXPECT_EQ(cost.json_bytes, expected[i].json_bytes) << files[i];
  }
}

}  // namespace
}  // namespace nmc::gltf
