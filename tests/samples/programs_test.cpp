// The small programs of samples/ that play and unpack compressed files, run on a file of the tool.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "codec/compress.h"
#include "samples/characters.h"
#include "support/process.h"
#include "support/scratch.h"

namespace nmc::test {
namespace {

const std::string build = NMC_BUILD_DIR;

class Programs : public testing::Test {
 protected:
  void SetUp() override {
    codec::CompressOptions options;
    options.tolerance.value = 0.01;
    options.effort = 1;
    const gltf::Document original =
        gltf::parse_document(samples::make_character("props.glb"), "props.glb", folder_.path());
    compressed_ = codec::compress(original, options).document;
    write_bytes(folder_.file("compressed.glb"), gltf::to_glb(compressed_));
  }

  ScratchFolder folder_;
  gltf::Document compressed_;
};

TEST_F(Programs, ExpandGivesWhatTheLibraryGives) {
  const ProcessResult result =
      run_process({build + "/nmc_expand", folder_.file("compressed.glb"), folder_.file("plain.glb")});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const gltf::Document plain = gltf::read_document(folder_.file("plain.glb"));
  EXPECT_EQ(plain.json.dump().find("NMC_animation_compression"), std::string::npos);
  EXPECT_EQ(codec::verify(compressed_, plain).clips.size(), compressed_.json["animations"].size());
  for (const codec::VerifiedClip& clip : codec::verify(compressed_, plain).clips)
    EXPECT_LT(clip.error.max, 1e-5) << clip.name;
}

TEST_F(Programs, PlayPrintsALineForEachPose) {
  const gltf::CompressedContent content = gltf::read_compression(compressed_);
  ASSERT_FALSE(content.animations.empty());
  const int animation = content.animations.front().animation;
  const ProcessResult result =
      run_process({build + "/play", folder_.file("compressed.glb"), std::to_string(animation), "7"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::istringstream lines(result.out);
  std::string name, head, line;
  std::getline(lines, name);
  EXPECT_EQ(name, compressed_.json["animations"][static_cast<std::size_t>(animation)]["name"]);
  std::getline(lines, head);
  int poses = 0;
  while (std::getline(lines, line)) {
    ++poses;
    EXPECT_EQ(std::count(line.begin(), line.end(), '\t'), std::count(head.begin(), head.end(), '\t')) << line;
  }
  EXPECT_EQ(poses, 7);
}

TEST_F(Programs, BrokenFilesAreNamed) {
  write_text(folder_.file("broken.glb"), "no GLB");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{build + "/play", folder_.file("broken.glb")},
        {build + "/nmc_expand", folder_.file("broken.glb"), folder_.file("plain.glb")},
        {build + "/play", folder_.file("compressed.glb"), "1000"}}) {
    const ProcessResult result = run_process(command);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_FALSE(result.err.empty());
  }
}

}  // namespace
}  // namespace nmc::test
