// How long the C decoder takes for a pose and for a whole clip, beside a plain sampler of the same keys (binary search
// and slerp). bench_pose_speed [FILE...]: the first stream of each compressed file; without files made clips of 50
// joints.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "codec/clip_set.h"
#include "codec/decoded_set.h"
#include "codec/reference_codec.h"
#include "gltf/document.h"
#include "gltf/edit.h"

namespace {

using namespace nmc;
using codec::Basis;
using codec::ClipSet;
using codec::State;

constexpr int joints = 50, samples = 120, window_samples = 30;

/// One moving translation and 50 moving rotations; of each window's features the low ones have levels, as trained clips
/// have.
ClipSet made_set(double weights_per_row) {
  std::mt19937 random(3);
  const auto between = [&](int low, int high) {
    return low + static_cast<int>(random() % static_cast<unsigned>(high - low + 1));
  };
  ClipSet set;
  set.base_step = 0.002f;
  set.targets.push_back({Path::translation, 3, {0, 0, 0}, {10, 20, 30}, {}});
  for (int j = 0; j < joints; ++j)
    set.targets.push_back(
        {Path::rotation, 4, {0, 0, 0, 0}, {between(-300, 300), between(-300, 300), between(-300, 300), 0}, {}});
  codec::LevelClip clip;
  clip.basis = Basis::sine;
  clip.states.assign(set.targets.size(), State::moving);
  const int parameters = 3 * (joints + 1), windows = samples / window_samples;
  for (int n = 0; n <= samples; ++n) clip.times.push_back(static_cast<float>(n) / 30.0f);
  for (int i = 0; i < (windows + 1) * parameters; ++i) clip.anchors.push_back(between(-200, 200));
  for (int k = 0; k < windows; ++k) {
    codec::LevelWindow window{static_cast<std::uint32_t>(k * window_samples), window_samples, {}};
    for (int p = 0; p < parameters; ++p)
      for (int j = 1; j <= 12; ++j)
        if (const int level = between(-30, 30); level != 0 && between(0, 999) < weights_per_row / 12 * 1000)
          window.weights.push_back({j, p, level});
    clip.windows.push_back(std::move(window));
  }
  set.clips.push_back(std::move(clip));
  return set;
}

/// Keys as a file without compression holds them: each target has its samples one after the other.
struct Keys {
  std::vector<float> times;
  std::vector<std::vector<float>> values;
};

Keys keys_of(const nmc_set& set, std::uint32_t clip, void* scratch) {
  Keys keys;
  const float* times = nmc_times(&set, clip);
  keys.times.assign(times, times + set.clips[clip].samples);
  keys.values.resize(set.info.targets);
  std::vector<float> pose(set.info.slots);
  for (std::uint32_t n = 0; n < keys.times.size(); ++n) {
    nmc_sample(&set, clip, n, pose.data(), scratch);
    for (std::uint32_t t = 0; t < set.info.targets; ++t)
      keys.values[t].insert(keys.values[t].end(), pose.begin() + set.targets[t].offset,
                            pose.begin() + set.targets[t].offset + set.targets[t].width);
  }
  return keys;
}

void slerp(const float* a, const float* b, float u, float* out) {
  float dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const float sign = dot < 0 ? -1.0f : 1.0f;
  dot = std::min(dot * sign, 1.0f);
  float wa = 1 - u, wb = u;
  if (dot < 0.9995f) {
    const float angle = std::acos(dot), s = 1 / std::sin(angle);
    wa = std::sin((1 - u) * angle) * s;
    wb = std::sin(u * angle) * s;
  }
  for (int i = 0; i < 4; ++i) out[i] = wa * a[i] + wb * sign * b[i];
}

/// What an engine does for each channel: finds the keys, then mixes two of them.
void sample_keys(const nmc_set& set, const Keys& keys, float seconds, float* pose) {
  for (std::uint32_t t = 0; t < set.info.targets; ++t) {
    const auto next = std::upper_bound(keys.times.begin() + 1, keys.times.end() - 1, seconds);
    const auto n = static_cast<std::size_t>(next - keys.times.begin()) - 1;
    const float u = std::clamp((seconds - keys.times[n]) / (keys.times[n + 1] - keys.times[n]), 0.0f, 1.0f);
    const nmc_target& target = set.targets[t];
    const float *a = keys.values[t].data() + n * target.width, *b = a + target.width;
    float* out = pose + target.offset;
    if (target.path == NMC_ROTATION)
      slerp(a, b, u, out);
    else
      for (std::uint32_t i = 0; i < target.width; ++i) out[i] = (1 - u) * a[i] + u * b[i];
  }
}

/// Nanoseconds of one call, the median of several rounds.
double nanoseconds(int calls, const std::function<void(int)>& call) {
  std::vector<double> rounds;
  for (int round = 0; round < 15; ++round) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < calls; ++i) call(i);
    rounds.push_back(std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count() /
                     calls);
  }
  std::nth_element(rounds.begin(), rounds.begin() + 7, rounds.end());
  return rounds[7];
}

void measure(const char* name, const std::vector<std::uint8_t>& stream) {
  const codec::DecodedSet decoded(stream, name);
  const nmc_set& set = decoded.raw();
  std::vector<std::uint64_t> scratch(set.info.scratch_bytes / 8 + 1);
  std::vector<float> pose(set.info.slots);
  std::uint32_t clip = 0;  // the longest
  for (std::uint32_t c = 1; c < set.info.clips; ++c)
    if (set.clips[c].samples > set.clips[clip].samples) clip = c;
  if (set.clips[clip].samples < 2) return;
  const Keys keys = keys_of(set, clip, scratch.data());
  const nmc_clip& shape = set.clips[clip];
  std::uint32_t weights = 0, rotations = 0;
  for (std::uint32_t k = 0; k < shape.windows; ++k) weights += set.windows[shape.first_window + k].weights;
  for (std::uint32_t t = 0; t < set.info.targets; ++t)
    rotations += set.targets[t].path == NMC_ROTATION && nmc_state(&set, clip, t) >= NMC_MOVING ? 1 : 0;

  std::mt19937 random(1);
  std::vector<float> moments(4096);
  for (float& moment : moments)
    moment =
        keys.times.front() + (keys.times.back() - keys.times.front()) * static_cast<float>(random() % 10000) / 10000;
  const int calls = 20000;
  const auto moment = [&](int i) { return moments[static_cast<std::size_t>(i) % moments.size()]; };
  const double random_pose =
      nanoseconds(calls, [&](int i) { nmc_evaluate(&set, clip, moment(i), NMC_CLAMP, pose.data(), scratch.data()); });
  const double key_pose = nanoseconds(calls, [&](int i) {
    nmc_sample(&set, clip, static_cast<std::uint32_t>(i) % shape.samples, pose.data(), scratch.data());
  });
  const double plain = nanoseconds(calls, [&](int i) { sample_keys(set, keys, moment(i), pose.data()); });
  std::printf("%s: %zu bytes, %u moving rotations, %u samples, %u windows, %.0f weights a window\n", name,
              stream.size(), rotations, shape.samples, shape.windows, static_cast<double>(weights) / shape.windows);
  std::printf("  pose at a random time %9.0f ns (%.1f a rotation)\n", random_pose,
              random_pose / std::max(rotations, 1u));
  std::printf("  pose at a key         %9.0f ns; whole clip %.0f ns\n", key_pose, key_pose * shape.samples);
  std::printf("  plain keys            %9.0f ns\n", plain);
}

}  // namespace

int main(int count, char** arguments) try {
  if (count > 1) {
    for (int i = 1; i < count; ++i) {
      const gltf::CompressedContent content = gltf::read_compression(gltf::read_document(arguments[i]));
      if (content.clip_sets.empty()) {
        std::fprintf(stderr, "%s: nothing in it is compressed\n", arguments[i]);
        return 1;
      }
      measure(arguments[i], content.clip_sets.front().stream);
    }
    return 0;
  }
  for (const double weights : {0.0, 1.0, 3.0})
    measure(("made, " + std::to_string(weights).substr(0, 3) + " weights a row").c_str(),
            write_clip_set(made_set(weights)));
  return 0;
} catch (const nmc::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
