// Motion capture in BVH: what the reader makes of it, what it refuses, and the glTF file that comes out.
#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "base/error.h"
#include "cli/command_line.h"
#include "motion/bvh.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using motion::BvhClip;
using motion::BvhOptions;
using motion::parse_bvh;
using testing::HasSubstr;

const std::string hierarchy = R"(HIERARCHY
ROOT Hips and more
{
  OFFSET 1 2 3
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest
  {
    OFFSET 0 10 0
    CHANNELS 3 Yrotation Xrotation Zrotation
    End Site
    {
      OFFSET 0 5 0
    }
  }
  JOINT Slider
  {
    OFFSET 1 0 0
    CHANNELS 3 Zposition Xposition Yposition
  }
  JOINT Shifted
  {
    OFFSET 2 0 0
    CHANNELS 3 Xposition Yposition Zposition
  }
}
)";

std::string two_frames(const std::string& first, const std::string& second) {
  return hierarchy + "MOTION\nFrames: 2\nFrame Time: 0.025\n" + first + "\n" + second + "\n";
}

const std::string good = two_frames("1 2 3 90 0 0  90 90 0  7 5 6  8 8 8", "2 2 3 0 0 0  0 0 30  7 5 7  8 8 8");

glm::dquat turn(const glm::dvec3& axis, double degrees) {
  return glm::angleAxis(degrees * std::numbers::pi / 180, axis);
}

void expect_rotation(const std::vector<float>& values, std::size_t row, const glm::dquat& wanted) {
  const glm::dquat got(values[4 * row + 3], values[4 * row], values[4 * row + 1], values[4 * row + 2]);
  EXPECT_NEAR(std::abs(glm::dot(got, wanted)), 1.0, 1e-6) << "row " << row;
}

TEST(ParseBvh, HierarchyAndRest) {
  const BvhClip bvh = parse_bvh(good, "good.bvh", {.scale = 0.5});
  EXPECT_EQ(bvh.skeleton.names, (std::vector<std::string>{"Hips and more", "Chest", "Chest_end", "Slider", "Shifted"}));
  EXPECT_EQ(bvh.skeleton.parent, (std::vector<int>{-1, 0, 1, 0, 0}));
  EXPECT_EQ(bvh.skeleton.joints, (std::vector<int>{0, 1, 3, 4}));
  EXPECT_EQ(bvh.skeleton.rest[0].translation, glm::dvec3(0.5, 1, 1.5));
  EXPECT_EQ(bvh.skeleton.rest[2].translation, glm::dvec3(0, 2.5, 0));
  EXPECT_EQ(bvh.skeleton.rest[4].translation, glm::dvec3(4, 4, 4));  // its position channels never change
}

TEST(ParseBvh, ChannelsInAnyOrder) {
  const motion::Clip clip = parse_bvh(good, "good.bvh").clip;
  ASSERT_EQ(clip.tracks.size(), 4U);  // Hips: both, Chest: rotation, Slider: translation
  EXPECT_EQ(clip.times, (std::vector<float>{0, 0.025F}));
  EXPECT_EQ(clip.tracks[0].values, (std::vector<float>{1, 2, 3, 2, 2, 3}));
  expect_rotation(clip.tracks[1].values, 0, turn({0, 0, 1}, 90));
  expect_rotation(clip.tracks[2].values, 0, turn({0, 1, 0}, 90) * turn({1, 0, 0}, 90));
  expect_rotation(clip.tracks[2].values, 1, turn({0, 0, 1}, 30));
  EXPECT_EQ(clip.tracks[3].node, 3);
  EXPECT_EQ(clip.tracks[3].values, (std::vector<float>{5, 6, 7, 5, 7, 7}));
}

TEST(ParseBvh, FramesPerSecondKeepsEveryNth) {
  std::string text =
      "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n}\nMOTION\nFrames: 10\nFrame Time: 0.01\n";
  for (int i = 0; i < 10; ++i) text += fmt::format("{}\n", i);
  EXPECT_EQ(parse_bvh(text, "a.bvh", {.frames_per_second = 33}).clip.times.size(), 4U);  // frames 0, 3, 6, 9
  EXPECT_EQ(parse_bvh(text, "a.bvh", {.frames_per_second = 1e-9}).clip.times.size(), 1U);
  EXPECT_EQ(parse_bvh(text, "a.bvh", {.frames_per_second = 1e9}).clip.times.size(), 10U);
}

TEST(ParseBvh, LineEndsCasesAndMarks) {
  std::string windows = "\xef\xbb\xbf";
  for (const char c : good) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(parse_bvh(windows, "w.bvh").clip.tracks[0].values, parse_bvh(good, "g.bvh").clip.tracks[0].values);
}

TEST(ParseBvh, NamesBecomeUtf8) {
  std::string text = good;
  text.replace(text.find("Chest"), 5, "Ch\xff\u6b69\x01t");
  EXPECT_EQ(parse_bvh(text, "a.bvh").skeleton.names[1], "Ch?\u6b69?t");
}

void expect_refused(const std::string& text, const std::string& part) {
  try {
    parse_bvh(text, "bad.bvh");
    ADD_FAILURE() << "accepted: " << part;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_input);
    EXPECT_THAT(error.what(), testing::StartsWith("bad.bvh"));
    EXPECT_THAT(error.what(), HasSubstr(part));
  }
}

std::string replaced(const std::string& from, const std::string& to) {
  std::string text = good;
  text.replace(text.find(from), from.size(), to);
  return text;
}

TEST(ParseBvh, RefusesBrokenText) {
  expect_refused("", "line 1: there should be HIERARCHY");
  expect_refused("HIERARCHY\nMOTION\n", "line 2: there should be a ROOT");
  expect_refused(replaced("OFFSET 0 10 0", "OFFSET 0 ten 0"),
                 "line 8: there should be a number of the OFFSET instead of 'ten'");
  expect_refused(replaced("OFFSET 0 10 0", "OFFSET 0 nan 0"), "line 8");
  expect_refused(replaced("OFFSET 0 10 0", ""), "no OFFSET");
  expect_refused(replaced("CHANNELS 3 Yrotation", "CHANNELS 3 Wrotation"), "line 9: channel 1 of joint 'Chest'");
  expect_refused(replaced("CHANNELS 3 Yrotation", "CHANNELS 99999999999 Yrotation"), "line 9");
  expect_refused(replaced("Frames: 2", "Frames: 3"), "line 29: 3 frames of 15 channels are announced, but the file");
  expect_refused(replaced("Frames: 2", "Frames: 3") + std::string(100, ' '), "ends in frame 3 of 3");
  expect_refused(replaced("Frames: 2", "Frames: 1"), "more text after the last of 1 frames");
  expect_refused(replaced("Frames: 2", "Frames: 18446744073709551615"), "too short");
  expect_refused(replaced("Frames: 2", "Frames: 0"), "no frames");
  expect_refused(replaced("Frames: 2", "Frames: -2"), "number of frames");
  expect_refused(replaced("0.025", "0"), "greater than 0");
  expect_refused(replaced("0.025", "1e-60"), "frame time");
  expect_refused(replaced("7 5 7", "7 1e60 7"), "position of joint 'Slider' is too large");
  expect_refused(good.substr(0, good.find("MOTION")), "there should be MOTION");
}

TEST(ParseBvh, EveryTruncationIsRefused) {
  const std::size_t last_number = good.find_last_not_of(" \n");
  for (std::size_t length = 0; length < last_number; ++length) expect_refused(good.substr(0, length), "");
}

TEST(ParseBvh, DepthIsLimited) {
  std::string text = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n";
  for (int i = 0; i < 200'000; ++i) text += "JOINT b\n{\nOFFSET 0 0 0\n";
  expect_refused(text, "deeper than 1000");
}

class Import : public CommandLine {
 protected:
  std::string input_text(const std::string& name, const std::string& text) {
    return input(name, Bytes(text.begin(), text.end()));
  }
};

TEST_F(Import, WritesASkinnedAnimatedFile) {
  const std::string bvh = input_text("wave.bvh", good);
  run_well({"import", bvh, file("out.glb")});
  const GlbParts parts = split_glb(read_bytes(file("out.glb")));
  EXPECT_EQ(parts.json["animations"][0]["name"], "wave");
  EXPECT_EQ(parts.json["animations"][0]["channels"].size(), 4U);
  EXPECT_EQ(parts.json["skins"][0]["joints"], Json::array({0, 1, 3, 4}));
  run_well({"import", bvh, file("named.glb"), "--name", "\u6b69\u304f", "--quiet"});
  EXPECT_EQ(split_glb(read_bytes(file("named.glb"))).json["animations"][0]["name"], "\u6b69\u304f");
}

TEST_F(Import, ResultCompresses) {
  run_well({"import", input_text("wave.bvh", good), file("out.glb"), "--scale", "0.1"});
  run_well({file("out.glb"), file("packed.glb"), "--tolerance", "1%"});
  run_well({"verify", file("out.glb"), file("packed.glb"), "--tolerance", "1%"});
}

TEST_F(Import, Failures) {
  const std::string bad = input_text("bad.bvh", replaced("Frames: 2", "Frames: 3"));
  expect_failure({"import", bad, file("out.glb")}, 3, {"bad.bvh", "line"});
  expect_failure({"import", file("absent.bvh"), file("out.glb")}, 2, {"absent.bvh"});
  expect_failure({"import", folder_.path(), file("out.glb")}, 2, {"folder"});
  expect_failure({"import", bad, file("out.bvh")}, 1, {"out.bvh", ".glb"});
  expect_failure({"import", bad, file("out.glb"), "--fps", "0"}, 1, {"--fps"});
  expect_failure({"import", bad, file("out.glb"), "--scale", "-1"}, 1, {"--scale"});
}

/// Agrees with an importer that shares no code with this one.
TEST_F(Import, AgreesWithTheRefereesImporter) {
  const std::string tools = std::string(NMC_SHARED_DIR) + "/tools";
  if (!std::filesystem::exists(tools)) GTEST_SKIP() << "needs " << tools;
  if (run_process({"/usr/bin/python3", "-c", "import numpy"}).exit_code != 0)
    GTEST_SKIP() << "needs python3 with numpy";
  std::string text = hierarchy + "MOTION\nFrames: 60\nFrame Time: 0.008333\n";
  for (int f = 0; f < 60; ++f) {
    for (int c = 0; c < 12; ++c) text += fmt::format("{:.5f} ", 170 * std::sin(0.1 * f * (c + 1)) + 5 * c);
    text += "4 5 6\n";
  }
  const std::string bvh = input_text("made.bvh", text);
  run_well({"import", bvh, file("ours.glb"), "--scale", "0.01", "--fps", "60", "--name", "Take"});
  const ProcessResult other = run_process({"/usr/bin/python3", tools + "/bvh2glb.py", bvh, file("theirs.glb"),
                                           "--scale", "0.01", "--fps", "60", "--name", "Take"});
  ASSERT_EQ(other.exit_code, 0) << other.err;
  const ProcessResult measured =
      run_process({"/usr/bin/python3", tools + "/measure.py", file("theirs.glb"), file("ours.glb"), "--json"});
  ASSERT_EQ(measured.exit_code, 0) << measured.out << measured.err;
  const Json report = Json::parse(measured.out);
  const double size = report["size"].get<double>();
  for (const char* what : {"joint", "vertex", "node"}) {
    EXPECT_LT(report["overall"][what]["max"].get<double>(), 1e-5 * size) << what;
  }
}

}  // namespace
}  // namespace nmc::test
