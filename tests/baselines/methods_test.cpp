// Every method: bytes from which alone the motion comes back, the bound where it promises one, damaged bytes.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <ostream>
#include <random>

#include "base/error.h"
#include "baselines/comparison.h"
#include "baselines/method.h"
#include "baselines/tiny_source.h"
#include "motion/error.h"

namespace nmc::baselines {

/// How a failing test names its method.
void PrintTo(const Method& method, std::ostream* out) { *out << method.name; }

}  // namespace nmc::baselines

namespace nmc::test {
namespace {

using baselines::Bytes;
using baselines::Method;

class EveryMethod : public testing::TestWithParam<Method> {
 protected:
  const Method& method() const { return GetParam(); }
  Bytes encode(const codec::Source& source, double knob) const { return method().prepare(source, {})->encode(knob); }

  double error_of(const codec::Source& source, const Bytes& bytes) const {
    const std::vector<motion::Clip> clips = method().decode(bytes, source.skeleton);
    EXPECT_EQ(clips.size(), source.clips.size());
    const motion::ErrorMeter meter(source.skeleton, source.all_points);
    double worst = 0;
    for (std::size_t i = 0; i < clips.size(); ++i)
      worst = std::max(worst, meter.report(source.clips[i].original, codec::with_kept(source.clips[i], clips[i])).max);
    return worst / source.size;
  }
};

INSTANTIATE_TEST_SUITE_P(All, EveryMethod,
                         testing::ValuesIn(baselines::all_methods().begin(), baselines::all_methods().end()),
                         [](const auto& each) {
                           std::string name(each.param.name);
                           std::erase(name, '-');
                           return name;
                         });

TEST_P(EveryMethod, GivesTheMotionBackFromItsBytes) {
  const codec::Source source = tiny_source();
  // The rest pose alone is this far off: a method that stored nothing would be.
  double still = 0;
  const motion::ErrorMeter meter(source.skeleton, source.all_points);
  for (const codec::ClipSource& clip : source.clips)
    still = std::max(still, meter.report(clip.original, {clip.name, clip.kept.curves}).max / source.size);
  // Networks and poses solved from end effectors do not follow such a short, wild clip well.
  const bool is_rough = method().name.starts_with("nmc-") || method().name == "pga-ik";
  const double knob = method().keeps_bound ? 0.02 : 0.002;
  EXPECT_LT(error_of(source, encode(source, knob)), (is_rough ? 0.7 : 0.1) * still);
}

TEST_P(EveryMethod, KeepsTheBoundThatItPromises) {
  if (!method().keeps_bound || method().name.starts_with("nmc-")) GTEST_SKIP() << "it promises none";
  const codec::Source source = tiny_source();
  for (const double tolerance : {0.03, 0.003}) EXPECT_LE(error_of(source, encode(source, tolerance)), tolerance);
}

TEST_P(EveryMethod, HasTheSameBytesOnEveryCall) {
  const codec::Source source = tiny_source();
  const auto encoder = method().prepare(source, {});
  const Bytes first = encoder->encode(0.02);
  encoder->encode(0.1);
  EXPECT_EQ(encoder->encode(0.02), first);
  EXPECT_EQ(encode(source, 0.02), first);
}

TEST_P(EveryMethod, RefusesOrReadsDamagedBytes) {
  const codec::Source source = tiny_source();
  const Bytes good = encode(source, 0.02);
  std::mt19937 random(7);
  int refused = 0;
  for (int round = 0; round < 150; ++round) {
    Bytes bad = good;
    if (round % 3 == 0) bad.resize(random() % good.size());
    for (unsigned i = 0; i < 1 + random() % 3 && !bad.empty(); ++i)
      bad[random() % bad.size()] = static_cast<std::uint8_t>(random());
    try {
      const std::vector<motion::Clip> clips = method().decode(bad, source.skeleton);
      for (const motion::Clip& clip : clips)
        for (const motion::Track& track : clip.tracks)
          for (const float value : track.values) EXPECT_TRUE(std::isfinite(value));
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_input);
      ++refused;
    }
  }
  EXPECT_GE(refused, 50);  // every truncated one
}

TEST(Compare, TakesTheFewestBytesWithinEachTolerance) {
  const codec::Source source = tiny_source();
  baselines::CompareOptions options;
  for (const char* name : {"svd", "draco", "meshopt"}) options.methods.push_back(baselines::find_method(name));
  options.tolerances = {0.002, 0.02};
  const baselines::Comparison result = baselines::compare(source, options);
  ASSERT_EQ(result.methods.size(), 3U);
  for (const baselines::MethodResult& method : result.methods) {
    ASSERT_EQ(method.best.size(), 2U);
    for (std::size_t t = 0; t < 2; ++t) {
      ASSERT_TRUE(method.best[t]) << method.method->name;
      const baselines::Encoding& best = method.curve[*method.best[t]];
      EXPECT_LE(best.max_error, options.tolerances[t] * source.size);
      for (const baselines::Encoding& other : method.curve)
        EXPECT_TRUE(other.max_error > options.tolerances[t] * source.size || best.bytes.size() <= other.bytes.size());
    }
    EXPECT_LE(method.curve[*method.best[1]].bytes.size(), method.curve[*method.best[0]].bytes.size());
  }
}

}  // namespace
}  // namespace nmc::test
