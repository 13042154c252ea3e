// Evaluation of one animation curve, as glTF 2.0 section 3.11 and appendix C say.
#pragma once

#include <cstddef>
#include <span>

#include "base/animation.h"

namespace nmc::motion {

/// The value of `curve` at `seconds`, clamped to the keyed range; out has curve.width entries. Rotations (x, y, z, w)
/// come out with unit length; LINEAR rotations are slerped on the short arc between normalised keys. A rotation of
/// length zero counts as the identity. Throws Error (internal) for a curve without keys or whose values do not fit its
/// times.
void evaluate(const Curve& curve, double seconds, std::span<double> out);

/// The values at many times: out has times.size() rows of curve.width. Linear in keys + times when the times increase.
void evaluate(const Curve& curve, std::span<const double> times, std::span<double> out);

/// Reads one curve again and again; remembers its place, so that increasing times cost a step each. The curve must
/// outlive it.
class CurveReader {
 public:
  /// Throws Error (internal) as evaluate does.
  explicit CurveReader(const Curve& curve);

  /// As evaluate.
  void read(double seconds, std::span<double> out);

  const Curve& curve() const { return *curve_; }

 private:
  void seek(double seconds);

  const Curve* curve_;
  std::size_t segment_ = 0;  ///< the key at or before the last time; keys - 2 at most, 0 with one key
};

}  // namespace nmc::motion
