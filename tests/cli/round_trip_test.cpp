// Compress, decode, verify, inspect, as a user does it one after the other.
#include <cstdlib>

#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class RoundTrip : public CommandLine {
 protected:
  /// The report of compressing `in` to `out`.
  Json compress(const std::string& in, const std::string& out, std::vector<std::string> options) {
    options.insert(options.begin(), {in, out, "--json"});
    return Json::parse(run_well(options, std::chrono::seconds(sanitized ? 600 : 200)).out);
  }

  /// The JSON of the animations and every byte that they refer to.
  static std::pair<Json, std::vector<Bytes>> animation_data(const std::string& path) {
    const GlbParts parts = split_glb(read_bytes(path));
    std::vector<Bytes> keys;
    for (const Json& animation : parts.json["animations"]) {
      for (const Json& sampler : animation["samplers"]) {
        for (const char* end : {"input", "output"}) {
          const Json& accessor = parts.json["accessors"][sampler[end].get<std::size_t>()];
          const Json& view = parts.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
          const auto first = parts.bin.begin() + view.value("byteOffset", std::ptrdiff_t{0});
          keys.emplace_back(first, first + view["byteLength"].get<std::ptrdiff_t>());
        }
      }
    }
    return {parts.json["animations"], keys};
  }
};

TEST_F(RoundTrip, DefaultProfile) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  const Json report = compress(in, file("packed.glb"), {"--tolerance", "0.5%"});
  EXPECT_EQ(report["profile"], "default");
  ASSERT_EQ(report["animations"].size(), 1U);
  const Json& wave = report["animations"][0];
  EXPECT_EQ(wave["name"], "wave");
  EXPECT_EQ(wave["outcome"], "compressed");
  EXPECT_EQ(wave["frames"], 61);
  EXPECT_EQ(wave["joints"], 2);
  EXPECT_NEAR(wave["duration_seconds"].get<double>(), 2.0, 1e-6);
  EXPECT_EQ(wave["key_bytes_before"], 61 * (1 + 4 + 4 + 3) * 4);
  EXPECT_LT(wave["bytes_after"].get<int>(), wave["bytes_before"].get<int>());
  EXPECT_LE(wave["error"]["max_fraction_of_size"].get<double>(), 0.005);
  EXPECT_EQ(report["file_bytes_before"], std::filesystem::file_size(in));
  EXPECT_EQ(report["file_bytes_after"], std::filesystem::file_size(file("packed.glb")));

  run_well({"decode", file("packed.glb"), file("plain.glb")});
  const Json plain = split_glb(read_bytes(file("plain.glb"))).json;
  EXPECT_FALSE(plain.contains("extensionsUsed"));
  EXPECT_EQ(plain["animations"][0]["channels"].size(), 3U);
  EXPECT_EQ(plain["extras"], TinyGlb().json["extras"]);
  for (const char* name : {"packed.glb", "plain.glb"}) {
    run_well({"verify", in, file(name), "--tolerance", "0.5%"});
    const Json verified = Json::parse(run_well({"verify", in, file(name), "--tolerance", "0.5%", "--json"}).out);
    EXPECT_TRUE(verified["holds"].get<bool>());
    EXPECT_NEAR(verified["animations"][0]["error"]["max_fraction_of_size"].get<double>(),
                wave["error"]["max_fraction_of_size"].get<double>(), 1e-6);
  }
}

TEST_F(RoundTrip, PaperProfile) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  const Json report = compress(in, file("packed.glb"), {"--profile", "paper", "--tolerance", "2%"});
  EXPECT_EQ(report["profile"], "paper");
  const Json& wave = report["animations"][0];
  if (wave["outcome"] == "compressed") {
    EXPECT_LE(wave["error"]["max_joint_fraction_of_size"].get<double>(), 0.02);
  }
  run_well({"decode", file("packed.glb"), file("plain.glb"), "--quiet"});
  run_well({"verify", in, file("plain.glb"), "--tolerance", "2%", "--joints"});
}

TEST_F(RoundTrip, VerifyFailsOverTheTolerance) {
  TinyGlb moved;
  const std::string in = input("in.glb", moved.bytes());
  const float shift = 0.5F;
  std::memcpy(moved.bin.data() + moved.offset_of(moved.root_rotation + 2) + 12, &shift, sizeof shift);
  const std::string other = input("other.glb", moved.bytes());
  const ProcessResult result = run({"verify", in, other});
  EXPECT_EQ(result.exit_code, 5);
  EXPECT_THAT(result.out, HasSubstr("does not hold for 1 of 1"));
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(run({"verify", in, other, "--json"}).exit_code, 5);
  run_well({"verify", in, other, "--tolerance", "60%"});
  run_well({"verify", in, in, "--tolerance", "0.0001mm"});
}

TEST_F(RoundTrip, InspectTellsWhatIsInside) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  compress(in, file("packed.glb"), {"--tolerance", "0.5%"});
  const Json inside = Json::parse(run_well({"inspect", file("packed.glb"), "--json"}).out);
  EXPECT_EQ(inside["compressed_animations"], 1);
  ASSERT_EQ(inside["clip_sets"].size(), 1U);
  const Json& clip = inside["clip_sets"][0]["clips"][0];
  EXPECT_EQ(clip["name"], "wave");
  EXPECT_THAT(clip["basis"].get<std::string>(), testing::AnyOf("cosine", "periodic", "sine"));
  EXPECT_LT(clip["corrections"].get<int>(), clip["frames"].get<int>());
  EXPECT_THAT(run_well({"inspect", file("packed.glb")}).out, HasSubstr("wave"));
  EXPECT_THAT(run_well({"inspect", in}).out, HasSubstr("1 animations, 0 compressed"));
}

TEST_F(RoundTrip, InspectTellsWhyWhereTheFileSaysIt) {
  TinyGlb tiny;
  tiny.json["animations"].push_back(tiny.json["animations"][0]);
  tiny.json["animations"][1]["name"] = "stay";
  const std::string in = input("in.glb", tiny.bytes());
  compress(in, file("plain.glb"), {"--tolerance", "0.5%", "--exclude", "stay"});
  const std::string plain = run_well({"inspect", file("plain.glb")}).out;
  EXPECT_THAT(plain, HasSubstr("one compressed with --explain does"));
  EXPECT_EQ(Json::parse(run_well({"inspect", file("plain.glb"), "--json"}).out)["clip_sets"][0]["clips"][0]["search"],
            Json());

  compress(in, file("packed.glb"), {"--tolerance", "0.5%", "--exclude", "stay", "--explain"});
  const std::string text = run_well({"inspect", file("packed.glb")}).out;
  EXPECT_THAT(text, Not(HasSubstr("--explain")));
  EXPECT_THAT(text, testing::ContainsRegex("wave: [a-z, ]+ [0-9,]+ B was the smallest;"));
  EXPECT_THAT(text, testing::ContainsRegex("keys [0-9,]+ B and [0-9,]+ B of JSON"));
  EXPECT_THAT(text, HasSubstr("stay: excluded"));
  const Json inside = Json::parse(run_well({"inspect", file("packed.glb"), "--json"}).out);
  const Json& clip = inside["clip_sets"][0]["clips"][0];
  EXPECT_EQ(clip["search"]["tried"][0]["basis"], clip["basis"]);
  EXPECT_EQ(clip["search"]["tried"][0]["within_bound"], true);
  ASSERT_EQ(inside["kept"].size(), 1U);
  EXPECT_EQ(inside["kept"][0]["animation"], 1);
  run_well({"verify", in, file("packed.glb"), "--tolerance", "0.5%"});
}

TEST_F(RoundTrip, SameBytesForAnyNumberOfThreads) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  for (const char* profile : {"default", "paper"}) {
    compress(in, file("one.glb"), {"--threads", "1", "--profile", profile, "--tolerance", "1%"});
    compress(in, file("two.glb"), {"--threads", "2", "--profile", profile, "--tolerance", "1%"});
    EXPECT_EQ(read_bytes(file("one.glb")), read_bytes(file("two.glb"))) << profile;
  }
}

TEST_F(RoundTrip, FallbackKeepsTheKeys) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  compress(in, file("packed.glb"), {"--fallback", "--tolerance", "0.5%"});
  const Json json = split_glb(read_bytes(file("packed.glb"))).json;
  EXPECT_EQ(json["extensionsUsed"], Json::array({"NMC_animation_compression"}));
  EXPECT_FALSE(json.contains("extensionsRequired"));
  auto [packed_json, packed_keys] = animation_data(file("packed.glb"));
  const auto [plain_json, plain_keys] = animation_data(in);
  EXPECT_EQ(packed_keys, plain_keys);
  packed_json[0].erase("extensions");
  EXPECT_EQ(packed_json, plain_json);
  run_well({"decode", file("packed.glb"), file("plain.glb")});
  EXPECT_EQ(animation_data(file("plain.glb")), animation_data(in));
}

TEST_F(RoundTrip, OptionalIsNotRequired) {
  compress(input("in.glb", TinyGlb().bytes()), file("packed.glb"), {"--optional", "--tolerance", "0.5%"});
  const Json json = split_glb(read_bytes(file("packed.glb"))).json;
  EXPECT_EQ(json["extensionsUsed"], Json::array({"NMC_animation_compression"}));
  EXPECT_FALSE(json.contains("extensionsRequired"));
}

TEST_F(RoundTrip, ExcludedAnimationStays) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  const Json report = compress(in, file("out.glb"), {"--exclude", "wave"});
  EXPECT_EQ(report["animations"][0]["outcome"], "kept_nothing_to_take");
  EXPECT_NE(report["animations"][0]["reason"], "");
  EXPECT_EQ(animation_data(file("out.glb")), animation_data(in));
}

TEST_F(RoundTrip, NoAnimationsPassThroughWithANote) {
  TinyGlb tiny;
  tiny.json.erase("animations");
  const std::string in = input("in.glb", tiny.bytes());
  const ProcessResult result = run_well({in, file("out.glb")});
  EXPECT_THAT(result.out, HasSubstr("note:"));
  EXPECT_EQ(read_bytes(file("out.glb")), read_bytes(in));
}

TEST_F(RoundTrip, OutputMayBeTheInput) {
  const Bytes original = TinyGlb().bytes();
  write_bytes(file("same.glb"), original);
  input("original.glb", original);
  compress(file("same.glb"), file("same.glb"), {"--tolerance", "0.5%"});
  EXPECT_LT(read_bytes(file("same.glb")).size(), original.size());
  run_well({"decode", file("same.glb"), file("same.glb")});
  run_well({"verify", file("original.glb"), file("same.glb"), "--tolerance", "0.5%"});
  EXPECT_EQ(folder_.names(), (std::set<std::string>{"original.glb", "same.glb"}));
}

TEST_F(RoundTrip, GltfWithItsBuffersBeside) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  compress(in, file("packed.gltf"), {"--tolerance", "0.5%"});
  run_well({"decode", file("packed.gltf"), file("plain.gltf")});
  run_well({"verify", in, file("plain.gltf"), "--tolerance", "0.5%"});
}

TEST_F(RoundTrip, PipesSeeNoProgress) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  const ProcessResult loud = run_well({in, file("a.glb"), "--tolerance", "1%"});  // standard error is empty
  EXPECT_THAT(loud.out, HasSubstr("wave"));
  EXPECT_THAT(loud.out, Not(HasSubstr("\r")));
  EXPECT_EQ(run_well({in, file("b.glb"), "--tolerance", "1%", "--quiet"}).out, "");
  EXPECT_EQ(read_bytes(file("a.glb")), read_bytes(file("b.glb")));
}

/// What each further clip of a character adds to the JSON of the file that is written.
TEST_F(RoundTrip, AClipIsLittleJson) {
  constexpr std::size_t clips = 20;
  const auto json_bytes = [&](std::size_t count) {
    TinyGlb glb;
    const Json wave = glb.json["animations"][0];
    for (std::size_t i = 0; i < count; ++i) {
      glb.json["animations"][i] = wave;
      glb.json["animations"][i]["name"] = "A name of twenty let" + std::to_string(10 + i);
    }
    const Json report = compress(input("clips.glb", glb.bytes()), file("packed.glb"), {"--effort", "1"});
    for (const Json& animation : report["animations"]) EXPECT_EQ(animation["outcome"], "compressed");
    return split_glb(read_bytes(file("packed.glb"))).json.dump().size();
  };
  const std::size_t one = json_bytes(1);
  EXPECT_LE(json_bytes(clips) - one, (clips - 1) * 250);
}

/// The characters that samples/ makes, in both profiles.
TEST_F(RoundTrip, SampleCharacters) {
  const std::string maker = std::string(NMC_BUILD_DIR) + "/make_characters";
  if (!std::filesystem::exists(maker)) GTEST_SKIP() << "needs " << maker;
  ASSERT_EQ(run_process({maker, file("characters")}).exit_code, 0);
  for (const auto& entry : std::filesystem::directory_iterator(file("characters"))) {
    const std::string in = entry.path().string();
    SCOPED_TRACE(in);
    if (sanitized && entry.file_size() > 800'000) continue;  // an instrumented build takes minutes for each
    const std::vector<std::string> effort =
        sanitized ? std::vector<std::string>{"--time-limit", "20"} : std::vector<std::string>{"--time-limit", "60"};
    std::vector<std::string> options{"--tolerance", "0.5%", "--effort", "1"};
    options.insert(options.end(), effort.begin(), effort.end());
    compress(in, file("packed.glb"), options);
    run_well({"decode", file("packed.glb"), file("plain.glb")});
    run_well({"verify", in, file("plain.glb"), "--tolerance", "0.5%"});

    std::vector<std::string> paper{"--profile", "paper", "--tolerance", "2%", "--max-frequencies", "4"};
    paper.insert(paper.end(), effort.begin(), effort.end());
    compress(in, file("packed.glb"), paper);
    run_well({"decode", file("packed.glb"), file("plain.glb")});
    run_well({"verify", in, file("plain.glb"), "--tolerance", "2%", "--joints"});
  }
}

}  // namespace
}  // namespace nmc::test
