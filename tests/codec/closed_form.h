// What a clip set means, written out in double from the definitions alone: shares no code with the decoder.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "codec/clip_set.h"

namespace nmc::test {

using codec::Basis;
using codec::ClipSet;
using codec::LevelClip;
using codec::SetTarget;
using codec::State;

using Values = std::vector<double>;
using Quaternion = std::array<double, 4>;  // x, y, z, w

inline Quaternion hamilton(const Quaternion& a, const Quaternion& b) {
  return {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
          a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
}

/// The unit quaternion of a rotation vector (axis times angle in radians).
inline Quaternion quaternion_of(double x, double y, double z) {
  const double angle = std::sqrt(x * x + y * y + z * z);
  const double s = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
  return {x * s, y * s, z * s, std::cos(angle / 2)};
}

/// Spherical interpolation along the shorter arc.
inline Quaternion slerp(const Quaternion& a, Quaternion b, double u) {
  double dot = 0;
  for (std::size_t i = 0; i < 4; ++i) dot += a[i] * b[i];
  if (dot < 0)
    for (double& v : b) v = -v;
  const double angle = std::acos(std::min(1.0, std::abs(dot)));
  Quaternion q;
  for (std::size_t i = 0; i < 4; ++i)
    q[i] = angle < 1e-6 ? (1 - u) * a[i] + u * b[i]
                        : (std::sin((1 - u) * angle) * a[i] + std::sin(u * angle) * b[i]) / std::sin(angle);
  return q;
}

class ClosedForm {
 public:
  ClosedForm(const ClipSet& set, std::size_t clip) : set_(set), clip_(set.clips[clip]) {
    for (std::size_t t = 0; t < set.targets.size(); ++t) {
      const SetTarget& target = set.targets[t];
      const State state = clip_.states[t];
      const int count = state == State::absent                                        ? 0
                        : target.path == Path::rotation && state != State::quaternion ? 3
                                                                                      : target.width;
      for (int axis = 0; axis < count; ++axis)
        parameters_.push_back({&target, axis, state == State::moving || state == State::quaternion});
    }
  }

  /// The parameters at sample n.
  Values parameters(std::uint32_t n) const {
    std::size_t k = 0;
    while (k + 1 < clip_.windows.size() && clip_.windows[k + 1].begin <= n) ++k;
    const auto& window = clip_.windows[k];
    const double u = (static_cast<double>(n) - window.begin) / window.length;
    Values y(parameters_.size());
    for (std::size_t p = 0; p < y.size(); ++p) {
      const double step = anchor_step(p);
      const double first = anchor(k, p) * step;
      y[p] = clip_.basis == Basis::cosine ? first : (1 - u) * first + u * anchor(k + 1, p) * step;
    }
    for (const auto& weight : window.weights) {
      const auto p = static_cast<std::size_t>(weight.parameter);
      const double step = slot_step(p) * std::pow(2.0, -clip_.step_exponent / 4.0) * std::sqrt(2.0 / window.length);
      y[p] += weight.level * step * feature(weight.feature, n, window.length, u);
    }
    for (const auto& atom : clip_.atoms) {
      const double away = std::abs(static_cast<double>(n) - atom.sample), half = std::pow(2.0, atom.width);
      const auto p = static_cast<std::size_t>(atom.parameter);
      if (atom.width == codec::LevelAtom::jump_width) {
        if (atom.sample > window.begin && atom.sample <= window.begin + window.length)
          y[p] += atom.level * anchor_step(p) * ((n >= atom.sample ? 1 : 0) - (clip_.basis == Basis::cosine ? 0 : u));
        continue;
      }
      if (away < half) y[p] += atom.level * anchor_step(p) * 0.5 * (1 + std::cos(std::numbers::pi * away / half));
    }
    if (set_.has_network) {
      const Values add = network(n);
      std::size_t output = 0;
      for (std::size_t p = 0; p < y.size(); ++p)
        if (parameters_[p].moving) y[p] += add[output++];
    }
    return y;
  }

  /// The pose at sample n: all targets' values one after the other.
  Values pose(std::uint32_t n) const {
    const Values y = parameters(n);
    Values pose;
    std::size_t p = 0;
    for (std::size_t t = 0; t < set_.targets.size(); ++t) {
      const SetTarget& target = set_.targets[t];
      const State state = clip_.states[t];
      const bool vector = target.path == Path::rotation && state != State::quaternion;
      if (state == State::quaternion) {
        const double length = std::sqrt(y[p] * y[p] + y[p + 1] * y[p + 1] + y[p + 2] * y[p + 2] + y[p + 3] * y[p + 3]);
        for (std::size_t a = 0; a < 4; ++a) pose.push_back(y[p++] / length);
      } else if (vector) {
        Quaternion q = reference_rotation(target);
        if (state != State::absent) {
          q = hamilton(q, quaternion_of(y[p], y[p + 1], y[p + 2]));
          p += 3;
        }
        pose.insert(pose.end(), q.begin(), q.end());
      } else {
        for (int a = 0; a < target.width; ++a) {
          double value = reference(target, a);
          if (!set_.exact_references && target.path == Path::scale) value += 1;
          pose.push_back(value + (state == State::absent ? 0.0 : y[p++]));
        }
      }
    }
    return pose;
  }

  /// The pose between sample n and the next, at share u.
  Values between(std::uint32_t n, double u) const {
    const Values a = pose(n), b = pose(n + 1);
    Values made;
    for (const SetTarget& target : set_.targets) {
      const std::size_t at = made.size();
      if (target.path == Path::rotation) {
        const Quaternion q =
            slerp({a[at], a[at + 1], a[at + 2], a[at + 3]}, {b[at], b[at + 1], b[at + 2], b[at + 3]}, u);
        made.insert(made.end(), q.begin(), q.end());
      } else {
        for (std::size_t i = 0; i < static_cast<std::size_t>(target.width); ++i)
          made.push_back((1 - u) * a[at + i] + u * b[at + i]);
      }
    }
    return made;
  }

 private:
  struct Parameter {
    const SetTarget* target;
    int axis;
    bool moving;
  };

  double slot_step(const SetTarget& target, int axis) const {
    const int e = target.step_exponents.empty() ? 0 : target.step_exponents[static_cast<std::size_t>(axis)];
    return set_.base_step * std::pow(2.0, -e / 2.0);
  }
  double slot_step(std::size_t p) const { return slot_step(*parameters_[p].target, parameters_[p].axis); }
  double anchor_step(std::size_t p) const { return slot_step(p) * std::pow(2.0, -set_.anchor_exponent / 4.0); }
  double anchor(std::size_t row, std::size_t p) const { return clip_.anchors[row * parameters_.size() + p]; }

  double reference(const SetTarget& target, int axis) const {
    const auto i = static_cast<std::size_t>(axis);
    if (set_.exact_references) return target.exact_reference[i];
    return target.reference[i] * slot_step(target, axis) * std::pow(2.0, -set_.anchor_exponent / 4.0);
  }
  Quaternion reference_rotation(const SetTarget& target) const {
    if (set_.exact_references)
      return {reference(target, 0), reference(target, 1), reference(target, 2), reference(target, 3)};
    return quaternion_of(reference(target, 0), reference(target, 1), reference(target, 2));
  }

  double feature(int j, std::uint32_t n, double length, double u) const {
    constexpr double pi = std::numbers::pi;
    if (clip_.basis == Basis::cosine) return std::cos(pi * j * (2.0 * n + 1) / (2 * length));
    if (clip_.basis == Basis::sine) return std::sin(pi * j * u);
    return j % 2 == 1 ? std::cos(pi * (j + 1) * u) : std::sin(pi * j * u);
  }

  /// A tensor's numbers: float32 as they are, or levels times the step that follows them.
  Values numbers(const std::vector<float>& tensor) const {
    Values values(tensor.begin(), tensor.end());
    if (!set_.quantized_network) return values;
    const double step = values.back();
    values.pop_back();
    for (double& v : values) v *= step;
    return values;
  }

  static Values layer(const Values& w, const Values& b, const Values& in) {
    Values out = b;
    for (std::size_t column = 0; column < in.size(); ++column)
      for (std::size_t row = 0; row < b.size(); ++row) out[row] += w[column * b.size() + row] * in[column];
    return out;
  }
  static Values elu(Values z) {
    for (double& v : z) v = v > 0 ? v : std::exp(v) - 1;
    return z;
  }

  Values network(std::uint32_t n) const {
    const double t = static_cast<double>(n) / (static_cast<double>(clip_.times.size()) - 1);
    Values x{t};
    for (const int k : clip_.layer.half_cycles)
      x.insert(x.end(), {std::sin(std::numbers::pi * k * t), std::cos(std::numbers::pi * k * t)});
    const Values z = elu(layer(numbers(clip_.layer.w0), numbers(clip_.layer.b0), x));
    const Values a = elu(layer(numbers(set_.shared.w1), numbers(set_.shared.b1), z));
    return layer(numbers(set_.shared.w2), numbers(set_.shared.b2), a);
  }

  const ClipSet& set_;
  const LevelClip& clip_;
  std::vector<Parameter> parameters_;
};

}  // namespace nmc::test
