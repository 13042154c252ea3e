// Key times come back bit for bit, and those that a formula makes cost nothing.
#include "codec/key_times.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include "codec/clip_set.h"
#include "codec/decoded_set.h"
#include "codec/reference_codec.h"

namespace nmc::codec {
namespace {

using Times = std::vector<float>;

template <typename Formula>
Times make(int count, Formula formula) {
  Times times;
  for (int i = 0; i < count; ++i) times.push_back(formula(i));
  return times;
}

/// A clip of one constant target: all that costs anything is the times.
ClipSet set_of(const Times& times) {
  ClipSet set;
  set.targets.push_back({Path::translation, 3, {0, 0, 0}, {0, 0, 0}, {}});
  LevelClip clip;
  clip.times = times;
  clip.states = {State::fixed};
  clip.anchors = {1, 2, 3};
  clip.windows = {{0, static_cast<std::uint32_t>(times.size()), {}}};
  set.clips.push_back(clip);
  return set;
}

void expect_bit_for_bit(const Times& times, bool exact, const std::string& name) {
  SCOPED_TRACE(name);
  EXPECT_EQ(fit_times(times).exact, exact);
  const DecodedSet decoded(write_clip_set(set_of(times)), name);
  ASSERT_EQ(decoded.raw().clips[0].samples, times.size());
  EXPECT_EQ(std::memcmp(nmc_times(&decoded.raw(), 0), times.data(), times.size() * sizeof(float)), 0);
  EXPECT_EQ(decoded.raw().clips[0].time_exact, exact ? 1 : 0);
}

/// The ways in which exporters count time.
std::vector<std::pair<std::string, Times>> regular() {
  std::vector<std::pair<std::string, Times>> all;
  for (const int count : {2, 3, 31, 400, 3000}) {
    const std::string n = " x " + std::to_string(count);
    for (const int rate : {24, 25, 30, 60, 120}) {
      const std::string name = std::to_string(rate) + " Hz" + n;
      const float dt = 1.0f / static_cast<float>(rate);
      all.emplace_back("float i / rate, " + name,
                       make(count, [&](int i) { return static_cast<float>(i) / static_cast<float>(rate); }));
      all.emplace_back("float i * dt, " + name, make(count, [&](int i) { return static_cast<float>(i) * dt; }));
      all.emplace_back("from frame 1, " + name,
                       make(count, [&](int i) { return static_cast<float>(i + 1) / static_cast<float>(rate); }));
      all.emplace_back("from frame 137, " + name,
                       make(count, [&](int i) { return static_cast<float>((i + 137.0) / rate); }));
      all.emplace_back("from frame -20, " + name,
                       make(count, [&](int i) { return static_cast<float>((i - 20.0) / rate); }));
      float sum = 0;
      all.emplace_back("accumulated, " + name, make(count, [&](int) {
                         const float now = sum;
                         sum += dt;
                         return now;
                       }));
    }
    all.emplace_back("double t0 + i * dt" + n,
                     make(count, [](int i) { return static_cast<float>(0.25 + i * (1.0 / 64)); }));
    all.emplace_back("BVH frame time" + n, make(count, [](int i) { return static_cast<float>(i * 0.0083333); }));
  }
  return all;
}

TEST(KeyTimes, RegularTimesCostNothing) {
  for (const auto& [name, times] : regular()) expect_bit_for_bit(times, true, name);
}

TEST(KeyTimes, ALongClipIsNoLargerThanAShortOne) {
  const auto bytes = [](int count) {
    return write_clip_set(set_of(make(count, [](int i) { return static_cast<float>(i) / 30.0f; }))).size();
  };
  EXPECT_LE(bytes(100000), bytes(31) + 6) << "a few bits more in the counts, nothing for the times";
}

TEST(KeyTimes, OneTimeAlone) {
  for (const float t : {0.0f, -0.0f, 1.5f, -3.0f, 1e-40f, 1e30f}) {
    const Times times{t};
    const DecodedSet decoded(write_clip_set(set_of(times)), "one");
    EXPECT_EQ(nmc_times(&decoded.raw(), 0)[0], t);
  }
}

TEST(KeyTimes, IrregularTimesToo) {
  std::mt19937 random(3);
  double t = -2;
  const Times scattered =
      make(500, [&](int) { return static_cast<float>(t += 1e-3 * static_cast<double>(1 + random() % 1000)); });
  expect_bit_for_bit(scattered, false, "scattered");
  Times gap = make(300, [](int i) { return static_cast<float>(i) / 30.0f; });
  gap.erase(gap.begin() + 100, gap.begin() + 107);
  expect_bit_for_bit(gap, false, "a gap");
  Times bits = make(300, [](int i) { return static_cast<float>(i) / 30.0f; });
  for (std::size_t i = 5; i < bits.size(); i += 11) bits[i] = std::nextafter(bits[i], 1e30f);
  expect_bit_for_bit(bits, false, "last bits");
  expect_bit_for_bit({0.0f, 1e-40f, 1e-20f, 0.3f, 2.0f, 3e38f}, false, "all magnitudes");
}

TEST(KeyTimes, NearlyRegularTimesCostLittle) {
  Times bits = make(3000, [](int i) { return static_cast<float>(i) / 30.0f; });
  const std::size_t regular_bytes = write_clip_set(set_of(bits)).size();
  for (std::size_t i = 5; i < bits.size(); i += 300) bits[i] = std::nextafter(bits[i], 1e30f);
  EXPECT_LT(write_clip_set(set_of(bits)).size(), regular_bytes + 60);
}

TEST(KeyTimes, ClipsOfOneRateShareTheFormula) {
  ClipSet set = set_of(make(31, [](int i) { return static_cast<float>(i) / 30.0f; }));
  const double alone = count_bits(set).times;
  set.clips.push_back(set.clips[0]);
  set.clips[1].times = make(91, [](int i) { return static_cast<float>(i) / 30.0f; });
  set.clips[1].windows[0].length = 91;
  EXPECT_LT(count_bits(set).times, 1.6 * alone);
}

}  // namespace
}  // namespace nmc::codec
