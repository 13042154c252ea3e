// The whole job on documents in memory: the bound is kept, the times come back, what is not taken stays.
#include "codec/compress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <set>
#include <string>

#include "base/error.h"
#include "closed_form.h"
#include "codec/decoded_set.h"
#include "codec/import_bvh.h"
#include "codec/paper_profile.h"
#include "codec/reference_codec.h"
#include "codec/source.h"
#include "codec/standard_profile.h"
#include "compressed_document.h"
#include "made_set.h"
#include "motion/bvh.h"
#include "motion/error.h"
#include "network/fourier_features.h"
#include "network/pose_network.h"
#include "samples/characters.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using codec::CompressOptions;
using codec::CompressResult;
using codec::Outcome;

Document tiny() { return gltf::parse_document(TinyGlb().bytes(), "tiny.glb", {}); }
Document humanoid() {
  return gltf::parse_document(samples::make_character("humanoid_30hz.glb"), "humanoid_30hz.glb", {});
}

CompressOptions quick(double fraction) {
  CompressOptions options;
  options.effort = 1;
  options.tolerance.value = fraction;
  options.threads = 1;
  return options;
}

/// The errors of all animations of an expanded document, by the meter alone; in world units.
std::vector<motion::ErrorReport> errors_of(const Document& original, const Document& expanded) {
  const gltf::Asset asset = gltf::read_asset(original);
  const motion::Skeleton skeleton = codec::make_skeleton(asset);
  const Points points = gltf::skin_points(original, asset, true);
  const std::vector<Animation> wanted = core_animations(original), got = core_animations(expanded);
  std::vector<motion::ErrorReport> reports;
  for (std::size_t i = 0; i < wanted.size(); ++i)
    reports.push_back(motion::measure_error(skeleton, points, wanted[i], got.at(i)));
  return reports;
}

void expect_times_bit_for_bit(const Document& original, const Document& expanded) {
  const std::vector<Animation> wanted = core_animations(original), got = core_animations(expanded);
  ASSERT_EQ(wanted.size(), got.size());
  for (std::size_t i = 0; i < wanted.size(); ++i)
    for (const Curve& curve : wanted[i].curves) {
      const Curve* made = find_curve(got[i], curve.node, curve.path);
      ASSERT_NE(made, nullptr) << wanted[i].name << ", node " << curve.node;
      if (made->times.size() <= 2) continue;  // a value that never changes
      EXPECT_EQ(made->times, curve.times) << wanted[i].name << ", node " << curve.node;
    }
}

/// Compresses the first animations only.
void expect_kept_promises(const Document& original, double fraction, std::size_t animations) {
  CompressOptions options = quick(fraction);
  const std::vector<Animation> all = core_animations(original);
  for (std::size_t i = animations; i < all.size(); ++i) options.exclude.push_back(all[i].name);
  const CompressResult result = codec::compress(original, options);
  EXPECT_EQ(untouched_difference(original, result), "");
  const Document expanded = codec::expand(result.document);
  EXPECT_EQ(expanded.json.dump().find("NMC_animation_compression"), std::string::npos);
  const std::vector<motion::ErrorReport> errors = errors_of(original, expanded);
  ASSERT_EQ(errors.size(), result.clips.size());
  for (std::size_t i = animations; i < errors.size(); ++i) EXPECT_EQ(errors[i].max, 0) << "an excluded animation";
  for (std::size_t i = 0; i < animations; ++i) {
    EXPECT_EQ(result.clips[i].outcome, Outcome::compressed) << result.clips[i].name << ": " << result.clips[i].reason;
    EXPECT_LE(errors[i].max, fraction * result.size * (1 + 1e-6)) << result.clips[i].name;
    EXPECT_NEAR(errors[i].max, result.clips[i].error.max, 1e-6 * result.size) << result.clips[i].name;
  }
  expect_times_bit_for_bit(original, expanded);
  EXPECT_LT(gltf::to_glb(result.document).size(), gltf::to_glb(original).size());
}

TEST(Compress, TinyCharacterKeepsItsPromises) {
  for (const double fraction : {0.02, 0.001}) expect_kept_promises(tiny(), fraction, 1);
}

TEST(Compress, HumanoidKeepsItsPromises) { expect_kept_promises(humanoid(), 0.005, 1); }

/// The tiny character with a STEP channel of two keys on the tip's translation, `jump` apart.
Document with_step(float jump) {
  TinyGlb glb;
  const std::size_t input = glb.add(std::vector<float>{0.0F, 2.0F}, 5126, "SCALAR", 1);
  const std::size_t output = glb.add(std::vector<float>{0, 1, 0, jump, 1, 0}, 5126, "VEC3", 3);
  glb.json["accessors"][input]["min"] = {0.0};
  glb.json["accessors"][input]["max"] = {2.0};
  auto& animation = glb.json["animations"][0];
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", "STEP"}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", 1}, {"path", "translation"}}}});
  return gltf::parse_document(glb.bytes(), "step.glb", {});
}

std::size_t step_channels(const Document& document) {
  std::size_t count = 0;
  for (const auto& channel : document.json["animations"][0]["channels"]) {
    const auto& sampler = document.json["animations"][0]["samplers"][channel["sampler"].get<std::size_t>()];
    if (sampler.value("interpolation", "LINEAR") == "STEP") ++count;
  }
  return count;
}

TEST(Compress, MoreEffortIsNeverLarger) {
  std::size_t last = std::numeric_limits<std::size_t>::max();
  for (const int effort : {5, 6, 7, 8}) {
    CompressOptions options = quick(0.01);
    options.effort = effort;
    const CompressResult result = codec::compress(tiny(), options);
    ASSERT_EQ(result.clips[0].outcome, Outcome::compressed);
    EXPECT_LE(result.clips[0].keys_after, last) << "effort " << effort;
    last = result.clips[0].keys_after;
  }
}

TEST(ChooseClips, TakesTheChoicesThatMakeTheSetSmallest) {
  codec::ClipSet set = SetMaker().make({.windows = {31}, .clips = 3});
  const std::vector<codec::LevelClip> small = set.clips;
  std::vector<codec::LevelClip> large = small;
  for (codec::LevelClip& clip : large)
    for (codec::LevelWeight& weight : clip.windows[0].weights) weight.level *= 97;
  choose_clips({{large[0], small[0]}, {small[1], large[1]}, {large[2]}}, set);
  ASSERT_EQ(set.clips.size(), 3u);
  const auto first_level = [](const codec::LevelClip& clip) { return clip.windows[0].weights.at(0).level; };
  EXPECT_EQ(first_level(set.clips[0]), first_level(small[0]));
  EXPECT_EQ(first_level(set.clips[1]), first_level(small[1]));
  EXPECT_EQ(first_level(set.clips[2]), first_level(large[2]));
}

/// Where poses are most of the bytes, they are as coarse as the bound lets them be.
TEST(Compress, AClipOfTwoKeysIsSmallerThanAtTheUsualPrecision) {
  const Document two = gltf::parse_document(TinyGlb(2).bytes(), "two.glb", {});
  const CompressOptions options = quick(0.02);
  const CompressResult result = codec::compress(two, options);
  ASSERT_EQ(result.clips[0].outcome, Outcome::compressed);
  EXPECT_LE(result.clips[0].error.max, 0.02 * result.size);
  const codec::Source source = codec::read_source(two, options);
  const auto usual = codec::StandardEncoder(source, options, {0}, codec::StandardEncoder::usual_precision).encode({0});
  const gltf::CompressedContent content = gltf::read_compression(result.document);
  EXPECT_LT(content.clip_sets.at(0).stream.size(), usual.stream.size());
}

/// The tiny character whose tip sways, and goes elsewhere in the middle, by `height` in so many frames.
Document with_rise(float height, std::size_t frames_long) {
  constexpr std::size_t frames = 121;
  TinyGlb glb(frames);
  std::vector<float> times, places;
  for (std::size_t n = 0; n < frames; ++n) {
    times.push_back(static_cast<float>(n) / 30);
    const float since = n > frames / 2 ? static_cast<float>(n - frames / 2) : 0;
    const float risen = std::min(1.0F, since / static_cast<float>(frames_long));
    places.insert(places.end(), {0.1F * std::sin(3 * times.back()) + height * risen, 1, 0});
  }
  const std::size_t input = glb.add(times, 5126, "SCALAR", 1), output = glb.add(places, 5126, "VEC3", 3);
  glb.json["accessors"][input]["min"] = {times.front()};
  glb.json["accessors"][input]["max"] = {times.back()};
  auto& animation = glb.json["animations"][0];
  animation["samplers"].push_back({{"input", input}, {"output", output}});
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", 1}, {"path", "translation"}}}});
  return gltf::parse_document(glb.bytes(), "jump.glb", {});
}

TEST(Compress, AJumpCostsFewBytes) {
  const auto bytes_of = [](float height, std::size_t frames_long) {
    const Document original = with_rise(height, frames_long);
    const CompressResult result = codec::compress(original, quick(0.005));
    EXPECT_EQ(result.clips[0].outcome, Outcome::compressed);
    EXPECT_LE(errors_of(original, codec::expand(result.document))[0].max, 0.005 * result.size);
    return gltf::read_compression(result.document).clip_sets.at(0).stream.size();
  };
  const std::size_t none = bytes_of(0, 1);
  // The same height reached in eight frames is no jump, and has to be drawn.
  EXPECT_LE(8 * (bytes_of(5, 1) - none), bytes_of(5, 8) - none);
}

/// A tree of joints, each of which turns anywhere from key to key.
Document wild_rotations(int joints, std::size_t frames) {
  gltf::Json json = {{"asset", {{"version", "2.0"}}}, {"scenes", {{{"nodes", {0}}}}}};
  gltf::Bytes bin;
  std::vector<float> times;
  for (std::size_t n = 0; n < frames; ++n) times.push_back(static_cast<float>(n) / 30);
  const std::size_t input = add_accessor(json, bin, times, 5126, "SCALAR", 1);
  gltf::Json channels = gltf::Json::array(), samplers = gltf::Json::array();
  std::mt19937 random(1);
  std::uniform_real_distribution<float> number(-1, 1);
  for (int joint = 0; joint < joints; ++joint) {
    json["nodes"].push_back({{"translation", {0, 0.1, 0}}});
    if (joint > 0) json["nodes"][static_cast<std::size_t>((joint - 1) / 2)]["children"].push_back(joint);
    std::vector<float> rotations;
    for (std::size_t n = 0; n < frames; ++n) {
      const glm::vec4 q = glm::normalize(glm::vec4(number(random), number(random), number(random), number(random)));
      rotations.insert(rotations.end(), {q.x, q.y, q.z, q.w});
    }
    channels.push_back({{"sampler", joint}, {"target", {{"node", joint}, {"path", "rotation"}}}});
    samplers.push_back({{"input", input}, {"output", add_accessor(json, bin, rotations, 5126, "VEC4", 4)}});
  }
  json["animations"] = {{{"channels", channels}, {"samplers", samplers}}};
  json["buffers"] = {{{"byteLength", bin.size()}}};
  Document document;
  document.name = "wild.glb";
  document.is_glb = true;
  document.json = json;
  document.buffers = {bin};
  document.has_data = {true};
  return gltf::parse_document(gltf::to_glb(document), "wild.glb", {});
}

TEST(Compress, RotationsThatTurnAnywhereKeepTheToleranceAndShrink) {
  const Document original = wild_rotations(40, 60);
  const CompressResult result = codec::compress(original, quick(0.005));
  ASSERT_EQ(result.clips[0].outcome, Outcome::compressed);
  EXPECT_LE(errors_of(original, codec::expand(result.document))[0].max, result.tolerance);
  EXPECT_LT(gltf::read_compression(result.document).clip_sets.at(0).stream.size(), 40u * 60 * 4 * 4 / 3);
}

constexpr std::size_t loop_frames = 61;

/// The tiny character under nothing but one curve of its root, of so many numbers a key.
Document root_curve(const std::vector<float>& values, const char* path, const char* type, std::size_t width) {
  TinyGlb glb(loop_frames);
  std::vector<float> times;
  for (std::size_t n = 0; n < loop_frames; ++n) times.push_back(static_cast<float>(n) / 30);
  const std::size_t input = glb.add(times, 5126, "SCALAR", 1), output = glb.add(values, 5126, type, width);
  glb.json["accessors"][input]["min"] = {times.front()};
  glb.json["accessors"][input]["max"] = {times.back()};
  auto& animation = glb.json["animations"][0];
  animation["samplers"] = {{{"input", input}, {"output", output}}};
  animation["channels"] = {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}};
  return gltf::parse_document(glb.bytes(), "loop.glb", {});
}

/// A swaying, trembling root, which ends `gap` from where it started.
Document loop_with(float gap) {
  std::vector<float> places;
  for (std::size_t n = 0; n < loop_frames; ++n) {
    const float u = static_cast<float>(n) / static_cast<float>(loop_frames - 1), turn = 6.2831853F * u;
    const auto m = static_cast<float>(n % (loop_frames - 1));
    places.insert(places.end(),
                  {0.3F * std::sin(turn) + 0.02F * std::cos(0.7F * m * m) + gap * u,
                   0.2F * std::cos(2 * turn) + 0.02F * std::cos(1.1F * m * m), 0.05F * std::cos(3 * turn)});
  }
  return root_curve(places, "translation", "VEC3", 3);
}

/// A trembling root that turns once around: its last quaternion is minus the first.
Document spinning_loop() {
  std::vector<float> rotations;
  for (std::size_t n = 0; n < loop_frames; ++n) {
    const auto m = static_cast<float>(n % (loop_frames - 1));
    const float half = 3.14159265F * static_cast<float>(n) / static_cast<float>(loop_frames - 1);
    const float tilt = 0.05F + 0.03F * std::cos(0.7F * m * m);
    rotations.insert(rotations.end(), {std::sin(tilt) * std::cos(half), std::cos(tilt) * std::sin(half),
                                       std::sin(tilt) * std::sin(half), std::cos(tilt) * std::cos(half)});
  }
  return root_curve(rotations, "rotation", "VEC4", 4);
}

TEST(Compress, ALoopThatNearlyClosesDoesSoAfterwards) {
  const Document original = loop_with(0.005F);
  for (const double fraction : {0.02, 0.005}) {
    const CompressResult result = codec::compress(original, quick(fraction));
    ASSERT_EQ(result.clips[0].outcome, Outcome::compressed);
    const motion::ErrorReport error = errors_of(original, codec::expand(result.document))[0];
    EXPECT_LE(error.max, fraction * result.size);
    // The difference of its two anchors is rounded to their steps, half of one of which is about 0.3 of the tolerance;
    // the bound alone would allow twice the tolerance.
    EXPECT_LE(error.loop_seam.value(), 0.3 * fraction * result.size) << fraction;
  }
}

TEST(Compress, ALoopThatSpinsHasNoSeamAfterwards) {
  const Document original = spinning_loop();
  for (const double fraction : {0.02, 0.005}) {
    const CompressResult result = codec::compress(original, quick(fraction));
    ASSERT_EQ(result.clips[0].outcome, Outcome::compressed);
    const motion::ErrorReport error = errors_of(original, codec::expand(result.document))[0];
    EXPECT_LE(error.max, fraction * result.size);
    EXPECT_LE(error.loop_seam.value(), 1e-4 * result.size) << fraction;
  }
}

TEST(Compress, ALoopHasNoSeamAfterwards) {
  const Document original =
      gltf::parse_document(samples::make_character("quadruped_30hz.glb"), "quadruped_30hz.glb", {});
  const CompressResult result = codec::compress(original, quick(0.005));
  int loops = 0;
  for (const motion::ErrorReport& error : errors_of(original, codec::expand(result.document))) {
    if (!error.loop_seam) continue;
    ++loops;
    EXPECT_NEAR(*error.loop_seam, 0, 1e-5 * result.size);  // the keys are float32
  }
  EXPECT_GE(loops, 3);  // walk, gallop, idle
}

TEST(Compress, AStepThatNobodySeesIsAConstant) {
  const Document original = with_step(1e-6F);
  const CompressResult result = codec::compress(original, quick(0.005));
  ASSERT_EQ(result.clips[0].outcome, Outcome::compressed);
  EXPECT_EQ(step_channels(result.document), 0u);
  EXPECT_LE(errors_of(original, codec::expand(result.document))[0].max, 0.005 * result.size);
}

TEST(Compress, AStepThatIsSeenStays) {
  const CompressResult result = codec::compress(with_step(0.5F), quick(0.005));
  ASSERT_EQ(result.clips[0].outcome, Outcome::compressed);
  EXPECT_EQ(step_channels(result.document), 1u);
}

TEST(Compress, FallbackKeepsTheAnimationsBitForBit) {
  const Document original = tiny();
  CompressOptions options = quick(0.01);
  options.requirement = gltf::Requirement::fallback;
  const CompressResult result = codec::compress(original, options);
  ASSERT_EQ(result.clips[0].outcome, Outcome::compressed);
  EXPECT_EQ(untouched_difference(original, result, gltf::Requirement::fallback), "");
  EXPECT_EQ(core_animations(result.document)[0].curves, core_animations(original)[0].curves);
  EXPECT_EQ(core_animations(codec::expand(result.document))[0].curves, core_animations(original)[0].curves);
}

TEST(Compress, WhatIsNotTakenStaysBitForBit) {
  const Document original = tiny();
  const auto expect_same = [&](const CompressOptions& options, Outcome outcome) {
    const CompressResult result = codec::compress(original, options);
    EXPECT_EQ(result.clips[0].outcome, outcome);
    EXPECT_EQ(gltf::to_glb(result.document), gltf::to_glb(original));
  };
  CompressOptions options = quick(0.01);
  options.exclude = {"wave"};
  expect_same(options, Outcome::kept_nothing_to_take);
}

TEST(Compress, ATooFineToleranceIsSaidToBe) {
  try {
    codec::compress(tiny(), quick(1e-9));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unsupported);
    EXPECT_NE(std::string(error.what()).find("tolerance"), std::string::npos);
  }
}

TEST(Compress, SameBytesForAnyNumberOfThreads) {
  for (const codec::Profile profile : {codec::Profile::standard, codec::Profile::paper}) {
    CompressOptions options = quick(0.01);
    options.profile = profile;
    options.max_frequencies = 3;
    const gltf::Bytes one = gltf::to_glb(codec::compress(tiny(), options).document);
    options.threads = 2;
    EXPECT_EQ(gltf::to_glb(codec::compress(tiny(), options).document), one);
  }
}

/// With more threads than one, trials of a lone clip are made before it is known whether they follow.
TEST(Compress, TheSearchOfOneClipDoesNotDependOnThreads) {
  const Document document = humanoid();
  CompressOptions options = quick(0.002);
  options.effort = 5;
  options.explain = true;
  for (const Animation& animation : core_animations(document))
    if (animation.name != "jump") options.exclude.push_back(animation.name);
  const gltf::Bytes one = gltf::to_glb(codec::compress(document, options).document);
  for (const int threads : {2, 5}) {
    options.threads = threads;
    EXPECT_EQ(gltf::to_glb(codec::compress(document, options).document), one) << threads;
  }
}

/// Eight seconds at 120 Hz of an arm that waves, faster and slower, with a hand that flips at once now and then.
Document long_recording() {
  constexpr int frames = 960;
  std::string text =
      "HIERARCHY ROOT Hips { OFFSET 0 1 0 CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation "
      "Yrotation JOINT Arm { OFFSET 0 0.5 0 CHANNELS 3 Zrotation Xrotation Yrotation JOINT Hand { OFFSET "
      "0.5 0 0 CHANNELS 3 Zrotation Xrotation Yrotation End Site { OFFSET 0.2 0 0 } } } } MOTION\n";
  text += "Frames: " + std::to_string(frames) + "\nFrame Time: 0.00833333\n";
  for (int n = 0; n < frames; ++n) {
    const double t = n / 120.0, fast = std::sin(t) * std::sin(7 * t + 0.3 * std::sin(19 * t));
    const double numbers[] = {std::sin(t),
                              1 + 0.1 * fast,
                              0.2 * t,
                              20 * fast,
                              0,
                              10 * t,
                              60 * fast,
                              30 * std::sin(3 * t),
                              0,
                              40 * fast,
                              n / 300 % 2 ? 175.0 : -175.0,
                              20 * std::sin(11 * t)};
    for (const double number : numbers) text += std::to_string(number) + ' ';
    text += '\n';
  }
  return codec::import_bvh(motion::parse_bvh(text, "arm.bvh"));
}

TEST(Compress, TheSearchOfALongClipKeepsTheBoundAndDoesNotDependOnThreads) {
  const Document original = long_recording();
  CompressOptions options = quick(0.001);
  options.effort = 5;
  options.explain = true;
  const CompressResult result = codec::compress(original, options);
  ASSERT_EQ(result.clips.at(0).outcome, Outcome::compressed);
  for (const motion::ErrorReport& report : errors_of(original, codec::expand(result.document)))
    EXPECT_LE(report.max, result.tolerance);
  for (const int threads : {2, 3}) {
    options.threads = threads;
    EXPECT_EQ(gltf::to_glb(codec::compress(original, options).document), gltf::to_glb(result.document)) << threads;
  }
}

TEST(Compress, TheRecordOfALongClipHasWhatWasTriedOnItsExcerptInProportion) {
  CompressOptions options = quick(0.001);
  options.effort = 3;
  options.record_candidates = true;
  const CompressResult result = codec::compress(long_recording(), options);
  const std::vector<codec::Candidate>& tried = result.clips.at(0).candidates;
  const auto chosen = std::find_if(tried.begin(), tried.end(), [](const codec::Candidate& one) { return one.chosen; });
  ASSERT_NE(chosen, tried.end());
  EXPECT_TRUE(chosen->kept);
  EXPECT_LE(chosen->error, result.tolerance);
  EXPECT_TRUE(
      std::any_of(tried.begin(), tried.end(), [&](const codec::Candidate& one) { return one.jumps != chosen->jumps; }));
  for (const codec::Candidate& one : tried) {
    EXPECT_GT(one.bytes, chosen->bytes / 2) << one.basis;
    EXPECT_LT(one.bytes, chosen->bytes * 2) << one.basis;
  }
}

TEST(Compress, TheRecordOfTheQuickEffortHasTheCutsThatWereNotTrained) {
  CompressOptions options = quick(0.001);
  options.record_candidates = true;
  const CompressResult result = codec::compress(tiny(), options);
  const std::vector<codec::Candidate>& tried = result.clips.at(0).candidates;
  std::set<std::string> bases;
  for (const codec::Candidate& one : tried) bases.insert(one.basis);
  EXPECT_GE(bases.size(), 2U);
  EXPECT_EQ(std::count_if(tried.begin(), tried.end(), [](const codec::Candidate& one) { return one.chosen; }), 1);
}

TEST(Compress, CompressingTwiceIsRefused) {
  const CompressResult result = codec::compress(tiny(), quick(0.01));
  EXPECT_THROW(codec::compress(result.document, quick(0.01)), Error);
}

TEST(Compress, PaperProfileKeepsTheToleranceOnJoints) {
  const Document original = tiny();
  CompressOptions options = quick(0.05);
  options.profile = codec::Profile::paper;
  const codec::PaperClip clip = codec::encode_paper(codec::read_source(original, options), 0, options);
  ASSERT_TRUE(clip.reached);
  const double tolerance = codec::read_source(original, options).tolerance;
  EXPECT_LE(clip.joint_error, tolerance);
  ASSERT_FALSE(clip.steps.empty());
  EXPECT_EQ(clip.steps.back().joint_error, clip.joint_error);
  for (std::size_t k = 0; k < clip.steps.size(); ++k) EXPECT_EQ(clip.steps[k].frequencies, static_cast<int>(k));
  const CompressResult result = codec::compress(original, options);
  EXPECT_EQ(untouched_difference(original, result), "");
  if (result.clips[0].outcome == Outcome::compressed) {
    const double error = errors_of(original, codec::expand(result.document))[0].max_joint;
    EXPECT_LE(error, tolerance);
    EXPECT_NEAR(error, clip.joint_error, 1e-3 * tolerance);
  }
}

/// The stream's tensors put into the network of network/, evaluated there.
TEST(Compress, PaperStreamIsTheNetwork) {
  CompressOptions options = quick(0.0);
  options.profile = codec::Profile::paper;
  options.max_frequencies = 2;
  const codec::PaperClip paper = codec::encode_paper(codec::read_source(tiny(), options), 0, options);
  const codec::DecodedSet decoded(paper.set.stream, "paper");
  const nmc_set& raw = decoded.raw();
  const nmc_clip& clip = raw.clips[0];
  ASSERT_TRUE(raw.has_network && !raw.quantized_network);
  const auto k = static_cast<Eigen::Index>(clip.frequencies);
  const Eigen::Index h = network::paper_hidden_size(k), d = 2 * k + 1, m = raw.outputs;
  ASSERT_EQ(raw.info.hidden0, h);
  ASSERT_EQ(raw.info.hidden1, h);
  network::PoseNetwork net = network::make_network({}, h, m, false, 1);
  for (Eigen::Index i = 0; i < k; ++i) net.half_cycles.push_back(static_cast<int>(raw.dense[clip.first_dense + i]));
  const float* at = raw.dense + clip.first_dense + k;
  const auto take = [&at](Eigen::Index rows, Eigen::Index columns) {
    const Eigen::MatrixXf tensor = Eigen::Map<const Eigen::MatrixXf>(at, rows, columns);
    at += rows * columns;
    return tensor;
  };
  net.W0 = take(h, d);
  net.b0 = take(h, 1);
  at = raw.dense + raw.first_shared;
  net.W1 = take(h, h);
  net.b1 = take(h, 1);
  net.W2 = take(m, h);
  net.b2 = take(m, 1);
  EXPECT_EQ(network::parameter_count(net), paper.steps.at(static_cast<std::size_t>(k)).parameters);

  const Eigen::MatrixXf poses = network::evaluate(net, network::frame_times(clip.samples));
  std::vector<std::uint64_t> scratch(raw.info.scratch_bytes / 8 + 1);
  std::vector<float> pose(raw.info.slots);
  for (std::uint32_t n = 0; n < clip.samples; ++n) {
    ASSERT_EQ(nmc_sample(&raw, 0, n, pose.data(), scratch.data()), NMC_OK);
    Eigen::Index p = 0;
    for (std::uint32_t t = 0; t < raw.info.targets; ++t) {
      const float* got = pose.data() + raw.targets[t].offset;
      const float* r = raw.pose + raw.targets[t].offset;
      const int state = nmc_state(&raw, 0, t);
      if (state < NMC_MOVING) continue;
      std::vector<double> wanted;
      if (state == NMC_QUATERNION) {
        const Eigen::RowVector4d q = poses.block<1, 4>(n, p).cast<double>().normalized();
        wanted.assign(q.data(), q.data() + 4);
        p += 4;
      } else if (raw.targets[t].path == NMC_ROTATION) {
        const Quaternion q =
            hamilton({r[0], r[1], r[2], r[3]}, quaternion_of(poses(n, p), poses(n, p + 1), poses(n, p + 2)));
        wanted.assign(q.begin(), q.end());
        p += 3;
      } else {
        for (int a = 0; a < raw.targets[t].width; ++a) wanted.push_back(static_cast<double>(r[a]) + poses(n, p++));
      }
      for (std::size_t a = 0; a < wanted.size(); ++a) ASSERT_NEAR(got[a], wanted[a], 1e-5) << n << ", target " << t;
    }
    ASSERT_EQ(p, m);
  }
}

}  // namespace
}  // namespace nmc::test
