// make_golden FOLDER: writes the good streams of tests/golden, and beside each what it says, by closed forms.
//
// A stream, once it is in the tree, stays as it is: every later decoder has to read it. New features get new files.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "codec/clip_set.h"
#include "codec/closed_form.h"

namespace nmc::test {
namespace {

using codec::Basis;
using codec::ClipLayer;
using codec::LevelAtom;
using codec::LevelClip;
using codec::LevelWindow;
using Json = nlohmann::ordered_json;

constexpr int hidden0 = 3, hidden1 = 2;

/// Whole numbers that look like chance and are the same everywhere.
class Numbers {
 public:
  int between(int low, int high) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return low + static_cast<int>((state_ >> 33) % static_cast<std::uint64_t>(high - low + 1));
  }

 private:
  std::uint64_t state_ = 4;
};

/// A translation, two rotations, a scale and two morph weights.
ClipSet empty_set() {
  ClipSet set;
  set.base_step = 0.0078125f;
  set.anchor_exponent = -2;
  set.targets = {{Path::translation, 3, {1, 2, 2}, {40, -90, 300}, {}},
                 {Path::rotation, 4, {0, 0, -1, -1}, {30, 0, -70, 0}, {}},
                 {Path::rotation, 4, {3, 3, 3, 3}, {0, 100, 5, 0}, {}},
                 {Path::scale, 3, {2, 2, 2}, {0, 7, 0}, {}},
                 {Path::weights, 2, {4, 5}, {50, 0}, {}}};
  return set;
}

std::vector<float> times_at(std::size_t count, const std::function<float(std::size_t)>& time) {
  std::vector<float> times;
  for (std::size_t n = 0; n < count; ++n) times.push_back(time(n));
  return times;
}

std::vector<float> thirtieths(std::size_t count) {
  return times_at(count, [](std::size_t n) { return static_cast<float>(static_cast<double>(n) / 30); });
}

struct ClipShape {
  Basis basis = Basis::cosine;
  std::vector<std::uint32_t> windows{7};  ///< lengths; of the cosine basis all samples
  std::vector<State> states{State::moving, State::moving, State::quaternion, State::moving, State::moving};
  int features = 3;
};

LevelClip make_clip(const ClipSet& set, const ClipShape& shape, Numbers& numbers) {
  LevelClip clip;
  clip.basis = shape.basis;
  clip.states = shape.states;
  clip.step_exponent = 1;
  std::uint32_t begin = 0;
  for (const std::uint32_t length : shape.windows) {
    clip.windows.push_back({begin, length, {}});
    begin += length;
  }
  const bool cosine = shape.basis == Basis::cosine;
  clip.times = thirtieths(cosine ? begin : begin + 1);
  std::vector<State> states;
  for (std::size_t t = 0; t < set.targets.size(); ++t)
    states.insert(states.end(), static_cast<std::size_t>(codec::parameter_count(set.targets[t], shape.states[t])),
                  shape.states[t]);
  const std::size_t rows = cosine ? 1 : shape.windows.size() + 1;
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t p = 0; p < states.size(); ++p)
      clip.anchors.push_back(r > 0 && states[p] == State::fixed      ? clip.anchors[p]
                             : states[p] == codec::State::quaternion ? numbers.between(150, 300)
                                                                     : numbers.between(-60, 60));
  for (LevelWindow& window : clip.windows)
    for (std::size_t p = 0; p < states.size(); ++p)
      for (int j = 1; states[p] >= State::moving && j <= shape.features; ++j)
        if (const int level = numbers.between(-12, 12); level % 3 == 0 && level != 0)
          window.weights.push_back({j, static_cast<int>(p), level});
  return clip;
}

ClipSet one_clip(const ClipShape& shape) {
  ClipSet set = empty_set();
  Numbers numbers;
  set.clips.push_back(make_clip(set, shape, numbers));
  return set;
}

ClipSet with_times(const std::vector<float>& times) {
  ClipSet set = one_clip({Basis::cosine, {static_cast<std::uint32_t>(times.size())}});
  set.clips[0].times = times;
  return set;
}

/// Three clips that predict one another, with every state after every other.
ClipSet clips() {
  ClipSet set = empty_set();
  Numbers numbers;
  set.clips.push_back(make_clip(set, {}, numbers));
  ClipShape second{Basis::sine, {3, 2}};
  second.states = {State::fixed, State::absent, State::fixed, State::absent, State::fixed};
  set.clips.push_back(make_clip(set, second, numbers));
  set.clips.back().reference = 0;
  ClipShape third{Basis::periodic, {5}};
  third.states = {State::absent, State::quaternion, State::moving, State::fixed, State::moving};
  set.clips.push_back(make_clip(set, third, numbers));
  set.clips.back().reference = 1;
  set.clips.push_back(set.clips[0]);
  set.clips.back().reference = 2;
  return set;
}

ClipSet exact_references() {
  ClipSet set = one_clip({});
  set.exact_references = true;
  set.clips[0].states[4] = State::moving;
  for (codec::SetTarget& target : set.targets) {
    target.step_exponents.assign(static_cast<std::size_t>(target.width), 0);
    target.exact_reference = {0.1f, -123.456f, 1e-6f};
    if (target.path == Path::rotation) target.exact_reference = {0.5f, -0.5f, 0.5f, 0.5f};
    if (target.path == Path::weights) target.exact_reference = {0.25f, 1.0f};
  }
  return set;
}

ClipSet atoms() {
  ClipSet set = one_clip({Basis::sine, {12}});
  set.clips[0].atoms = {{0, 0, 2, 40}, {4, 8, 3, -25}, {4, 14, 0, 9}, {12, 3, 1, 100}};
  return set;
}

/// In the middle, at the first and at the last sample that can have one, at the seam of two windows.
ClipSet jumps(Basis basis, std::vector<std::uint32_t> windows) {
  constexpr int jump = codec::LevelAtom::jump_width;
  ClipSet set = one_clip({basis, std::move(windows)});
  const auto last = static_cast<std::uint32_t>(set.clips[0].times.size() - 1);
  set.clips[0].atoms = {{1, 0, jump, 300}, {3, 3, jump, -45}, {3, 3, 1, 20}, {4, 8, jump, 7}, {last, 9, jump, -500}};
  return set;
}

std::vector<float> tensor(std::size_t count, bool quantized, Numbers& numbers) {
  std::vector<float> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(quantized ? static_cast<float>(numbers.between(-40, 40))
                               : static_cast<float>(numbers.between(-1000, 1000)) / 2000);
  if (quantized) values.push_back(0.0125f);
  return values;
}

ClipSet network(bool quantized, int features) {
  ClipShape shape;
  shape.features = features;
  ClipSet set = one_clip(shape);
  Numbers numbers;
  set.has_network = true;
  set.quantized_network = quantized;
  const std::vector<int> half_cycles{3, 1};
  set.clips[0].layer = {half_cycles, tensor(hidden0 * 5, quantized, numbers), tensor(hidden0, quantized, numbers)};
  const std::size_t outputs = set.clips[0].anchors.size();
  set.shared = {hidden0,
                hidden1,
                static_cast<int>(outputs),
                tensor(hidden1 * hidden0, quantized, numbers),
                tensor(hidden1, quantized, numbers),
                tensor(outputs * hidden1, quantized, numbers),
                tensor(outputs, quantized, numbers)};
  return set;
}

/// A network beside everything else a clip can have, with layers that three clips share.
ClipSet network_clips() {
  ClipSet set = network(true, 3);
  Numbers numbers;
  const std::vector<State> states = set.clips[0].states;
  set.clips[0].atoms = {{1, 0, 1, 12}, {4, 8, LevelAtom::jump_width, 7}};
  set.clips.push_back(make_clip(set, {Basis::sine, {3, 2}, states, 2}, numbers));
  set.clips.back().layer = {{2}, tensor(hidden0 * 3, true, numbers), tensor(hidden0, true, numbers)};
  set.clips.back().atoms = {{2, 3, 0, -9}};
  set.clips.push_back(make_clip(set, {Basis::periodic, {6}, states}, numbers));
  set.clips.back().layer = {{4, 2, 6}, tensor(hidden0 * 7, true, numbers), tensor(hidden0, true, numbers)};
  set.clips.back().reference = 1;
  return set;
}

Json expected_clip(const ClipSet& set, std::size_t index) {
  const LevelClip& clip = set.clips[index];
  const ClosedForm truth(set, index);
  Json states = Json::array(), poses = Json::array(), times = Json::array();
  for (const State state : clip.states) states.push_back(static_cast<int>(state));
  const auto rounded = [](const Values& values) {
    Json list = Json::array();
    for (const double value : values) list.push_back(std::round(value * 1e9) / 1e9);
    return list;
  };
  for (std::size_t n = 0; n < clip.times.size(); ++n) {
    const auto sample = static_cast<std::uint32_t>(n);
    times.push_back(static_cast<double>(clip.times[n]));
    if (n % 2 == 0 || n + 1 == clip.times.size())
      poses.push_back({{"seconds", clip.times[n]}, {"values", rounded(truth.pose(sample))}});
    if (n % 3 != 1 || n + 1 == clip.times.size()) continue;
    const double u = 0.375;
    const double seconds = clip.times[n] + u * (static_cast<double>(clip.times[n + 1]) - clip.times[n]);
    poses.push_back({{"seconds", seconds}, {"values", rounded(truth.between(sample, u))}});
  }
  return {{"times", times}, {"states", states}, {"poses", poses}};
}

Json expected(const ClipSet& set) {
  static const char* const paths[] = {"translation", "rotation", "scale", "weights"};
  Json targets = Json::array(), clips = Json::array();
  for (const codec::SetTarget& target : set.targets)
    targets.push_back({{"path", paths[static_cast<int>(target.path)]}, {"width", target.width}});
  for (std::size_t c = 0; c < set.clips.size(); ++c) clips.push_back(expected_clip(set, c));
  return {{"targets", targets}, {"clips", clips}};
}

void write(const std::string& path, const ClipSet& set) {
  const std::vector<std::uint8_t> stream = write_clip_set(set);
  std::ofstream(path + ".nmc", std::ios::binary)
      .write(reinterpret_cast<const char*>(stream.data()), static_cast<std::streamsize>(stream.size()));
  std::ofstream(path + ".json") << expected(set).dump() << "\n";
}

float product(std::size_t n) { return static_cast<float>(n + 4) * 0.0333f; }

std::vector<float> sums(std::size_t count) {
  std::vector<float> times{0.7f};
  while (times.size() < count) times.push_back(times.back() + 0.0417f);
  return times;
}

void write_all(const std::string& folder) {
  const auto put = [&](const char* name, const ClipSet& set) { write(folder + "/" + name, set); };
  put("cosine", one_clip({Basis::cosine, {7}}));
  put("one_sample", one_clip({Basis::cosine, {1}, ClipShape{}.states, 0}));
  put("periodic", one_clip({Basis::periodic, {6}}));
  put("sine", one_clip({Basis::sine, {6}}));
  put("sine_even_windows", one_clip({Basis::sine, {3, 3, 4}}));
  put("sine_uneven_windows", one_clip({Basis::sine, {5, 1, 2}}));
  put("clips", clips());
  put("exact_references", exact_references());
  put("atoms", atoms());
  put("jumps", jumps(Basis::sine, {3, 3, 4}));
  put("jumps_cosine", jumps(Basis::cosine, {7}));
  put("jumps_periodic", jumps(Basis::periodic, {6}));
  put("network_float", network(false, 0));
  put("network_float_weights", network(false, 3));
  put("network_quantized", network(true, 0));
  put("network_clips", network_clips());
  put("times_rate",
      with_times(times_at(6, [](std::size_t n) { return static_cast<float>((static_cast<double>(n) - 2) / 24); })));
  put("times_product", with_times(times_at(6, product)));
  put("times_double", with_times(times_at(6, [](std::size_t n) {
        return static_cast<float>(1.5f + static_cast<double>(n) * 0.041708333333333);
      })));
  put("times_sum", with_times(sums(6)));
  put("times_uneven", with_times({-0.25f, 0.0f, 0.1f, 0.1000001f, 0.5f, 7.0f}));
}

}  // namespace
}  // namespace nmc::test

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: make_golden FOLDER\n";
    return 1;
  }
  nmc::test::write_all(arguments[1]);
  return 0;
}
