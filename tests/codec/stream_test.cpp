// Streams mean what their definitions say: written clip sets decoded and compared with closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "base/error.h"
#include "closed_form.h"
#include "codec/decoded_set.h"
#include "codec/reference_codec.h"
#include "made_set.h"

namespace nmc::test {
namespace {

using codec::DecodedSet;

struct Named {
  std::string name;
  SetShape shape;
};

std::vector<Named> shapes() {
  return {{"cosine", {Basis::cosine, {31}, 1}},
          {"cosine_of_one_sample", {Basis::cosine, {1}, 2}},
          {"cosine_clips", {Basis::cosine, {40}, 4}},
          {"periodic", {Basis::periodic, {24}, 3}},
          {"periodic_odd", {Basis::periodic, {25}, 1}},
          {"sine", {Basis::sine, {30}, 1}},
          {"sine_even_windows", {Basis::sine, {10, 10, 11}, 3}},
          {"sine_uneven_windows", {Basis::sine, {4, 17, 1, 9}, 5}},
          {"exact_references", {Basis::sine, {12, 13}, 3, false, false, true}},
          {"network_float", {Basis::cosine, {33}, 1, true, false, true, 0}},
          {"network_float_with_skip", {Basis::sine, {10, 20}, 3, true, false, false}},
          {"network_quantized", {Basis::cosine, {33}, 2, true, true, false, 0}},
          {"network_quantized_with_skip", {Basis::periodic, {32}, 3, true, true, false}}};
}

class Streams : public testing::TestWithParam<Named> {
 protected:
  Streams() : set_(SetMaker().make(GetParam().shape)), bytes_(write_clip_set(set_)), decoded_(bytes_, "test") {
    scratch_.resize(decoded_.raw().info.scratch_bytes / 8 + 1);
    pose_.resize(decoded_.raw().info.slots);
  }

  void expect_pose(const Values& wanted, const std::string& where) {
    ASSERT_EQ(wanted.size(), pose_.size());
    for (std::size_t i = 0; i < wanted.size(); ++i)
      ASSERT_NEAR(pose_[i], wanted[i], 1e-5 * std::max(1.0, std::abs(wanted[i]))) << where << ", slot " << i;
  }

  nmc_result evaluate(std::size_t clip, double seconds, int mode) {
    return nmc_evaluate(&decoded_.raw(), static_cast<std::uint32_t>(clip), seconds, mode, pose_.data(),
                        scratch_.data());
  }

  ClipSet set_;
  std::vector<std::uint8_t> bytes_;
  DecodedSet decoded_;
  std::vector<std::uint64_t> scratch_;
  std::vector<float> pose_;
};

TEST_P(Streams, SamplesAreTheClosedForm) {
  ASSERT_EQ(decoded_.clip_count(), set_.clips.size());
  for (std::size_t c = 0; c < set_.clips.size(); ++c) {
    const ClosedForm truth(set_, c);
    for (std::uint32_t n = 0; n < set_.clips[c].times.size(); ++n) {
      ASSERT_EQ(nmc_sample(&decoded_.raw(), static_cast<std::uint32_t>(c), n, pose_.data(), scratch_.data()), NMC_OK);
      expect_pose(truth.pose(n), "clip " + std::to_string(c) + ", sample " + std::to_string(n));
    }
  }
}

TEST_P(Streams, BetweenSamplesIsLinearAndSlerp) {
  for (std::size_t c = 0; c < set_.clips.size(); ++c) {
    const ClosedForm truth(set_, c);
    const auto& times = set_.clips[c].times;
    for (std::uint32_t n = 0; n + 1 < times.size(); ++n)
      for (const double u : {0.25, 0.8}) {
        const double seconds = times[n] + u * (static_cast<double>(times[n + 1]) - times[n]);
        ASSERT_EQ(evaluate(c, seconds, NMC_CLAMP), NMC_OK);
        expect_pose(truth.between(n, u), "clip " + std::to_string(c) + ", after sample " + std::to_string(n));
      }
  }
}

TEST_P(Streams, OutsideClampsOrLoops) {
  for (std::size_t c = 0; c < set_.clips.size(); ++c) {
    const ClosedForm truth(set_, c);
    const auto& times = set_.clips[c].times;
    const auto last = static_cast<std::uint32_t>(times.size() - 1);
    const double length = static_cast<double>(times.back()) - times.front();
    for (const double before : {0.0, 0.1, 1e9}) {
      ASSERT_EQ(evaluate(c, times.front() - before, NMC_CLAMP), NMC_OK);
      expect_pose(truth.pose(0), "before the first key");
      ASSERT_EQ(evaluate(c, times.back() + before, NMC_CLAMP), NMC_OK);
      expect_pose(truth.pose(last), "after the last key");
    }
    if (last == 0) continue;
    const std::uint32_t n = last / 2;
    const double inside = times[n] + 0.5 * (static_cast<double>(times[n + 1]) - times[n]);
    for (const int turns : {-3, -1, 0, 1, 7}) {
      ASSERT_EQ(evaluate(c, inside + turns * length, NMC_LOOP), NMC_OK);
      expect_pose(truth.between(n, 0.5), std::to_string(turns) + " turns");
    }
  }
}

TEST_P(Streams, KeepTimesStatesAndTargets) {
  ASSERT_EQ(decoded_.target_count(), set_.targets.size());
  for (std::size_t t = 0; t < set_.targets.size(); ++t) {
    EXPECT_EQ(decoded_.path(t), set_.targets[t].path);
    EXPECT_EQ(decoded_.width(t), set_.targets[t].width);
  }
  for (std::uint32_t c = 0; c < set_.clips.size(); ++c) {
    const float* times = nmc_times(&decoded_.raw(), c);
    EXPECT_EQ(std::vector<float>(times, times + set_.clips[c].times.size()), set_.clips[c].times);
    for (std::uint32_t t = 0; t < set_.targets.size(); ++t)
      EXPECT_EQ(nmc_state(&decoded_.raw(), c, t), static_cast<int>(set_.clips[c].states[t]));
  }
}

TEST_P(Streams, ClipsHaveTheTracksThatAreNotAbsent) {
  std::vector<int> nodes;
  for (std::size_t t = 0; t < set_.targets.size(); ++t) nodes.push_back(100 + static_cast<int>(t));
  for (std::size_t c = 0; c < set_.clips.size(); ++c) {
    const motion::Clip clip = decoded_.clip(c, nodes);
    EXPECT_EQ(clip.times, set_.clips[c].times);
    std::size_t track = 0;
    for (std::size_t t = 0; t < set_.targets.size(); ++t) {
      const State state = set_.clips[c].states[t];
      if (state == State::absent) continue;
      ASSERT_LT(track, clip.tracks.size());
      const motion::Track& made = clip.tracks[track++];
      EXPECT_EQ(made.node, nodes[t]);
      EXPECT_EQ(made.path, set_.targets[t].path);
      if (state == State::fixed)
        EXPECT_TRUE(made.constant());
      else
        EXPECT_EQ(made.values.size(), clip.times.size() * static_cast<std::size_t>(made.width));
      if (made.path != Path::rotation) continue;
      for (std::size_t n = 4; n < made.values.size(); n += 4) {
        double dot = 0;
        for (std::size_t a = 0; a < 4; ++a) dot += static_cast<double>(made.values[n + a]) * made.values[n + a - 4];
        EXPECT_GE(dot, 0) << "rotations keep their sign";
      }
    }
    EXPECT_EQ(track, clip.tracks.size());
  }
}

TEST_P(Streams, SameBytesOnEveryWrite) {
  EXPECT_EQ(write_clip_set(set_), bytes_);
  EXPECT_EQ(write_clip_set(SetMaker().make(GetParam().shape)), bytes_);
}

TEST_P(Streams, CountedBitsAreTheBytes) {
  const codec::PartBits counted = count_bits(set_), read = decoded_.bits();
  EXPECT_NEAR(counted.total(), read.total(), 1e-6 * counted.total());
  EXPECT_NEAR(counted.weights, read.weights, 1e-6 * counted.total());
  EXPECT_NEAR(counted.anchors, read.anchors, 1e-6 * counted.total());
  const double payload = 8.0 * static_cast<double>(bytes_.size() - decoded_.raw().info.header_bytes);
  EXPECT_NEAR(payload, counted.total(), 33 + 0.002 * counted.total());
}

INSTANTIATE_TEST_SUITE_P(All, Streams, testing::ValuesIn(shapes()), [](const auto& test) { return test.param.name; });

TEST(Stream, AnEarlierClipPredictsTheFirstAnchorPose) {
  SetShape shape{Basis::cosine, {31}, 2};
  shape.features = 0;
  ClipSet set = SetMaker(5).make(shape);
  set.clips[1].states = set.clips[0].states;
  set.clips[1].anchors = set.clips[0].anchors;
  set.clips[1].atoms.clear();
  set.clips[1].reference = 0;
  ClipSet alone = set;
  alone.clips[1].reference = -1;
  EXPECT_LT(count_bits(set).anchors, 0.8 * count_bits(alone).anchors);
  const DecodedSet decoded(write_clip_set(set), "test");
  EXPECT_EQ(decoded.raw().clips[1].reference, 0);
}

TEST(Stream, ManyRotationsBetweenTwoSamplesAreSlerpedHoweverFarTheyTurn) {
  constexpr std::size_t joints = 48;
  ClipSet set;
  set.base_step = 0.002f;
  LevelClip clip;
  clip.basis = Basis::sine;
  clip.times = {0.0f, 0.5f};
  clip.windows = {{0, 1, {}}};
  for (std::size_t t = 0; t < joints; ++t) {
    const auto sign = t % 2 ? -1 : 1;
    set.targets.push_back({Path::rotation, 4, {0, 0, 0, 0}, {300, 20 * sign, -200, 0}, {}});
    clip.states.push_back(State::moving);
  }
  // Angles from next to nothing to nearly a whole turn, and ways between the samples up to half a turn.
  for (int row = 0; row < 2; ++row)
    for (std::size_t t = 0; t < joints; ++t) {
      const auto k = static_cast<int>(t / 3);
      const int angle = t % 3 == 0 ? 80 * k : t % 3 == 1 ? -50 * k : 1500 + 110 * k;
      const int way = t % 3 == 1 ? 100 * k : 40;
      clip.anchors.insert(clip.anchors.end(), {angle + row * way, k, 7 * row});
    }
  set.clips = {clip};
  const DecodedSet decoded(write_clip_set(set), "test");
  std::vector<std::uint64_t> scratch(decoded.raw().info.scratch_bytes / 8 + 1);
  std::vector<float> pose(decoded.raw().info.slots);
  const ClosedForm truth(set, 0);
  for (const double u : {0.01, 0.3, 0.5, 0.9}) {
    ASSERT_EQ(nmc_evaluate(&decoded.raw(), 0, 0.5 * u, NMC_CLAMP, pose.data(), scratch.data()), NMC_OK);
    const Values wanted = truth.between(0, u);
    ASSERT_EQ(wanted.size(), pose.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(pose[i], wanted[i], 1e-5) << u << ", slot " << i;
  }
}

TEST(Stream, ATimeThatIsNoNumberOrAClipThatIsNoneIsRefused) {
  const DecodedSet decoded(write_clip_set(SetMaker().make({})), "test");
  std::vector<std::uint64_t> scratch(decoded.raw().info.scratch_bytes / 8 + 1);
  std::vector<float> pose(decoded.raw().info.slots);
  const auto at = [&](std::uint32_t clip, double t) {
    return nmc_evaluate(&decoded.raw(), clip, t, NMC_LOOP, pose.data(), scratch.data());
  };
  EXPECT_EQ(at(0, std::nan("")), NMC_ERROR_ARGUMENT);
  EXPECT_EQ(at(0, INFINITY), NMC_ERROR_ARGUMENT);
  EXPECT_EQ(at(1, 0), NMC_ERROR_ARGUMENT);
  EXPECT_EQ(at(0, 1e300), NMC_OK);
  EXPECT_EQ(nmc_sample(&decoded.raw(), 0, 31, pose.data(), scratch.data()), NMC_ERROR_ARGUMENT);
  EXPECT_EQ(nmc_times(&decoded.raw(), 1), nullptr);
}

TEST(Stream, ABrokenStreamIsNamed) {
  std::vector<std::uint8_t> bytes = write_clip_set(SetMaker().make({}));
  bytes.back() ^= 1;
  try {
    const DecodedSet decoded(bytes, "fox.glb: clipSets[3]");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::invalid_input);
    EXPECT_NE(std::string(error.what()).find("fox.glb: clipSets[3]"), std::string::npos);
  }
}

}  // namespace
}  // namespace nmc::test
