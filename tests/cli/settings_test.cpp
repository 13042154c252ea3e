// What is asked of a compression: exceptions, kept channels, settings files, sizes.
#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using testing::HasSubstr;

constexpr int usage = 1, io = 2, not_kept = 5;

class Settings : public CommandLine {
 protected:
  void SetUp() override { in_ = input("in.glb", TinyGlb(61).bytes()); }

  std::string settings(const std::string& text) { return input("settings.json", Bytes(text.begin(), text.end())); }

  /// Compresses and returns the report.
  Json compress(std::vector<std::string> options, const std::string& out = "out.glb") {
    options.insert(options.begin(), {in_, file(out), "--json"});
    return Json::parse(run_well(options).out);
  }

  std::string in_;
};

TEST_F(Settings, AnExceptionIsKeptAndVerified) {
  compress({"--tolerance", "2%", "--tolerance", "0.1%,joint=tip"});
  compress({"--tolerance", "2%"}, "loose.glb");
  const std::vector<std::string> bound{"--tolerance", "2%", "--tolerance", "0.1%,joint=tip"};
  const auto verify = [&](const std::string& name) {
    std::vector<std::string> arguments{"verify", in_, file(name)};
    arguments.insert(arguments.end(), bound.begin(), bound.end());
    return run(arguments);
  };
  EXPECT_EQ(verify("out.glb").exit_code, 0);
  EXPECT_EQ(verify("loose.glb").exit_code, not_kept);
  EXPECT_EQ(run({"verify", in_, file("loose.glb"), "--tolerance", "2%"}).exit_code, 0);
}

TEST_F(Settings, MalformedExceptionsAreRefused) {
  const std::string out = file("out.glb");
  const auto refused = [&](const std::string& value, const std::vector<std::string>& parts) {
    expect_failure({in_, out, "--tolerance", value}, usage, parts);
  };
  refused("1%,jiont=tip", {"--tolerance", "'jiont'", "did you mean 'joint'"});
  refused("1%,joint=", {"--tolerance", "empty"});
  refused("1%,joint=a,joint=b", {"--tolerance", "twice"});
  refused("1%,channel=rotatoin", {"--tolerance", "'rotatoin'", "did you mean 'rotation'"});
  refused("1%,channel=scale,channel=scale", {"--tolerance", "twice"});
  refused("1%,", {"--tolerance", "empty"});
  expect_failure({in_, out, "--tolerance", "1%", "--tolerance", "2%"}, usage, {"--tolerance", "second"});
  expect_failure({in_, out, "--profile", "paper", "--tolerance", "1%,joint=tip"}, usage, {"--profile paper"});
}

TEST_F(Settings, KeptChannelsStay) {
  const Json report = compress({"--keep", "root"});
  EXPECT_EQ(report["animations"][0]["outcome"], "compressed");
  const Json document = split_glb(read_bytes(file("out.glb"))).json;
  std::set<int> nodes;
  for (const Json& channel : document["animations"][0]["channels"]) nodes.insert(channel["target"]["node"].get<int>());
  EXPECT_TRUE(nodes.contains(0));
  EXPECT_EQ(compress({"--keep", "*"})["animations"][0]["outcome"], "kept_nothing_to_take");
}

TEST_F(Settings, KeptChannelsMustExistInGltf) {
  expect_failure({in_, file("out.glb"), "--keep", "channel=turn"}, usage, {"--keep", "'turn'"});
}

TEST_F(Settings, ExactEnds) { EXPECT_EQ(compress({"--exact-ends"})["animations"][0]["outcome"], "compressed"); }

TEST_F(Settings, ExactEndsAreNotThePapers) {
  expect_failure({in_, file("out.glb"), "--exact-ends", "--profile", "paper"}, usage, {"--exact-ends", "paper"});
}

TEST_F(Settings, TargetSize) {
  const Json totals = compress({"--target-size", "1.2KB"})["totals"];
  EXPECT_LE(totals["key_bytes_after"].get<int>() + totals["json_bytes_after"].get<int>(), 1200);
}

TEST_F(Settings, TargetSizesThatMakeNoSense) {
  const std::string out = file("out.glb");
  for (const char* size : {"40", "KB", "-1KB", "0B", "1e20GB", "40 stones"})
    expect_failure({in_, out, "--target-size", size}, usage, {"--target-size", size});
  expect_failure({in_, out, "--target-size", "10B"}, usage, {"--target-size", "in.glb", "50%"});
  expect_failure({in_, out, "--target-size", "1KB", "--tolerance", "1%"}, usage, {"--target-size", "--tolerance"});
  expect_failure({in_, out, "--target-size", "1KB", "--profile", "paper"}, usage, {"--target-size", "paper"});
}

TEST_F(Settings, AFileSaysTheSameAsTheCommandLine) {
  const std::string path = settings(R"({"$schema": "settings.schema.json", "tolerance": "2%", "effort": 2,
    "rules": [{"joint": "tip", "tolerance": "0.1%"}, {"joint": "root", "channel": "translation", "keep": true}],
    "exact_ends": true, "contact_weight": 2, "optional": true, "exclude": []})");
  compress({"--settings", path});
  compress({"--tolerance", "2%", "--tolerance", "0.1%,joint=tip", "--keep", "joint=root,channel=translation",
            "--effort", "2", "--exact-ends", "--contact-weight", "2", "--optional"},
           "same.glb");
  EXPECT_EQ(read_bytes(file("out.glb")), read_bytes(file("same.glb")));
  EXPECT_EQ(run({"verify", in_, file("out.glb"), "--settings", path}).exit_code, 0);
}

TEST_F(Settings, TheCommandLineCountsMoreThanTheFile) {
  const std::string path = settings(R"({"tolerance": "1%", "effort": 9})");
  EXPECT_DOUBLE_EQ(compress({"--settings", path, "--tolerance", "3%"})["tolerance_fraction_of_size"].get<double>(),
                   0.03);
}

TEST_F(Settings, FilesThatMakeNoSenseAreRefused) {
  const std::string out = file("out.glb");
  const auto refused = [&](const std::string& text, const std::vector<std::string>& parts) {
    expect_failure({in_, out, "--settings", settings(text)}, usage, parts);
  };
  refused(R"({"tolerence": "1%"})", {"settings.json", "'tolerence'", "did you mean 'tolerance'"});
  refused(R"({"tolerance": 1})", {"settings.json: tolerance", "text"});
  refused(R"({"tolerance": "1"})", {"settings.json: tolerance", "unit"});
  refused(R"({"effort": 10})", {"settings.json: effort", "1 to 9"});
  refused(R"({"effort": 2.5})", {"settings.json: effort"});
  refused(R"({"contact_weight": 0})", {"settings.json: contact_weight", "1 to 100"});
  refused(R"({"time_limit_seconds": 0})", {"settings.json: time_limit_seconds", "above 0"});
  refused(R"({"max_frequencies": 5})", {"--max-frequencies", "paper"});
  refused(R"({"optional": 1})", {"settings.json: optional", "true or false"});
  refused(R"({"exclude": "wave"})", {"settings.json: exclude", "list"});
  refused(R"({"exclude": [3]})", {"settings.json: exclude[0]", "text"});
  refused(R"({"rules": [{"joint": "tip"}]})", {"settings.json: rules[0]", "tolerance", "keep"});
  refused(R"({"rules": [{"joint": "tip", "tolerance": "1%", "keep": true}]})", {"settings.json: rules[0]"});
  refused(R"({"rules": [{"bone": "tip", "keep": true}]})", {"settings.json: rules[0]", "'bone'"});
  refused(R"({"rules": [{"joint": "", "keep": true}]})", {"rules[0]: joint", "empty"});
  refused(R"({"profile": "fast"})", {"settings.json: profile", "fast"});
  refused(R"([1])", {"settings.json", "object"});
  refused(R"({"effort": )", {"settings.json", "JSON", "byte"});
  expect_failure({in_, out, "--settings", file("nowhere.json")}, io, {"nowhere.json"});
}

}  // namespace
}  // namespace nmc::test
