// Clip sets with something in every part of the format, the same on every call.
#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "codec/clip_set.h"

namespace nmc::test {

struct SetShape {
  codec::Basis basis = codec::Basis::cosine;
  std::vector<std::uint32_t> windows{31};  ///< lengths; cosine: samples, periodic: samples - 1
  int clips = 1;
  bool network = false;
  bool quantized = false;
  bool exact = false;
  int features = 9;  ///< the largest feature index
};

class SetMaker {
 public:
  explicit SetMaker(std::uint32_t seed = 1) : random_(seed) {}

  codec::ClipSet make(const SetShape& shape) {
    codec::ClipSet set;
    set.exact_references = shape.exact;
    set.has_network = shape.network;
    set.quantized_network = shape.quantized;
    set.base_step = 0.002f;
    set.anchor_exponent = 3;
    add_targets(set, shape.exact);
    for (int c = 0; c < shape.clips; ++c) set.clips.push_back(make_clip(set, shape, c));
    if (shape.network) add_shared(set);
    return set;
  }

  static constexpr int hidden0 = 5, hidden1 = 4;

 private:
  using State = codec::State;

  int between(int low, int high) {
    return low + static_cast<int>(random_() % static_cast<std::uint32_t>(high - low + 1));
  }
  float number() { return static_cast<float>(between(-1000, 1000)) / 1500; }

  void add_targets(codec::ClipSet& set, bool exact) {
    const std::vector<std::pair<Path, int>> kinds{{Path::translation, 3}, {Path::rotation, 4}, {Path::rotation, 4},
                                                  {Path::scale, 3},       {Path::weights, 5},  {Path::translation, 3},
                                                  {Path::rotation, 4},    {Path::scale, 3},    {Path::rotation, 4}};
    for (const auto& [path, width] : kinds) {
      codec::SetTarget target{path, width, {}, {}, {}};
      for (int a = 0; a < width; ++a) {
        target.step_exponents.push_back(exact                              ? 0
                                        : path == Path::rotation && a == 3 ? target.step_exponents.back()
                                                                           : between(-2, 3));
        target.reference.push_back(path == Path::rotation && a == 3 ? 0 : between(-300, 300));
        target.exact_reference.push_back(number());
      }
      if (path == Path::rotation) target.exact_reference = {0.5f, -0.5f, 0.1f, 0.7f};
      set.targets.push_back(std::move(target));
    }
  }

  static std::vector<State> states_of(int clip) {
    std::vector<State> states{State::moving, State::moving, State::quaternion, State::moving, State::moving,
                              State::fixed,  State::fixed,  State::absent,     State::absent};
    if (clip % 3 == 1) states[5] = states[6] = State::absent;
    if (clip % 3 == 2) std::swap(states[1], states[2]);
    return states;
  }

  codec::LevelClip make_clip(const codec::ClipSet& set, const SetShape& shape, int index) {
    codec::LevelClip clip;
    clip.basis = shape.basis;
    clip.states = states_of(index);
    clip.reference = index == 0 ? -1 : index / 2;
    clip.step_exponent = index - 1;
    std::uint32_t begin = 0;
    for (const std::uint32_t length : shape.windows) {
      clip.windows.push_back({begin, length, {}});
      begin += length;
    }
    const std::uint32_t samples = shape.basis == codec::Basis::cosine ? begin : begin + 1;
    for (std::uint32_t n = 0; n < samples; ++n)
      clip.times.push_back(static_cast<float>(static_cast<double>(n + 5 * static_cast<unsigned>(index)) / 30));
    const std::size_t rows = shape.basis == codec::Basis::cosine ? 1 : shape.windows.size() + 1;
    std::vector<bool> moving, quaternion;
    for (std::size_t t = 0; t < set.targets.size(); ++t)
      for (int a = 0; a < codec::parameter_count(set.targets[t], clip.states[t]); ++a) {
        moving.push_back(clip.states[t] != State::fixed);
        quaternion.push_back(clip.states[t] == State::quaternion);
      }
    const std::size_t parameters = moving.size();
    for (std::size_t r = 0; r < rows; ++r)
      for (std::size_t p = 0; p < parameters; ++p)
        clip.anchors.push_back(!moving[p] && r > 0 ? clip.anchors[p]
                               : quaternion[p]     ? between(300, 500)
                                                   : between(-200, 200));
    for (codec::LevelWindow& window : clip.windows)
      for (std::size_t p = 0; p < parameters; ++p)
        for (int j = 1; moving[p] && j <= shape.features; ++j)
          if (between(0, 3) == 0) {
            const int level = quaternion[p] ? between(-9, 9) : between(-60, 60);
            if (level != 0) window.weights.push_back({j, static_cast<int>(p), level});
          }
    for (std::uint32_t n = 0; n < samples; n += 7) {
      const int parameter = between(0, static_cast<int>(parameters) - 1);
      if (moving[static_cast<std::size_t>(parameter)])
        clip.atoms.push_back({n, parameter, between(0, 4), between(1, 20)});
    }
    if (shape.network) {
      clip.layer.half_cycles = {3, 1 + index, 8};
      const std::size_t inputs = 2 * clip.layer.half_cycles.size() + 1;
      clip.layer.w0 = tensor(hidden0 * inputs, shape.quantized);
      clip.layer.b0 = tensor(hidden0, shape.quantized);
    }
    return clip;
  }

  std::vector<float> tensor(std::size_t count, bool quantized) {
    std::vector<float> values;
    for (std::size_t i = 0; i < count; ++i)
      values.push_back(quantized ? static_cast<float>(between(-90, 90)) : number());
    if (quantized) values.push_back(0.0078f);
    return values;
  }

  void add_shared(codec::ClipSet& set) {
    int outputs = 0;
    for (std::size_t t = 0; t < set.targets.size(); ++t)
      if (set.clips.front().states[t] == State::moving || set.clips.front().states[t] == State::quaternion)
        outputs += codec::parameter_count(set.targets[t], set.clips.front().states[t]);
    const auto m = static_cast<std::size_t>(outputs);
    const bool quantized = set.quantized_network;
    set.shared = {hidden0,
                  hidden1,
                  outputs,
                  tensor(hidden1 * hidden0, quantized),
                  tensor(hidden1, quantized),
                  tensor(m * hidden1, quantized),
                  tensor(m, quantized)};
    // Quaternions that pass near zero have no direction to compare: W2's influence stays below their anchors.
    for (std::vector<float>* t : {&set.shared.w2, &set.shared.b2})
      for (std::size_t i = 0; i + (quantized ? 1 : 0) < t->size(); ++i)
        (*t)[i] = quantized ? static_cast<float>(static_cast<int>((*t)[i]) / 8) : (*t)[i] / 8;
  }

  std::mt19937 random_;
};

}  // namespace nmc::test
