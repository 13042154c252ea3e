// Smooth curves of one variable that motions are drawn with.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <utility>
#include <vector>

namespace nmc::samples {

/// A smooth curve through keys that never overshoots between them (monotone cubic, Fritsch and Carlson 1980).
/// Continuous first derivative. Before the first and after the last key it stays at their values, unless it is
/// periodic.
class Curve {
 public:
  using Key = std::pair<double, double>;  ///< position, value

  /// Keys by rising position. A periodic curve repeats with the distance between the first and the last key, whose
  /// values are equal.
  explicit Curve(std::initializer_list<Key> keys, bool periodic = false);

  double operator()(double position) const;

 private:
  std::vector<Key> keys_;
  std::vector<double> slopes_;
  bool periodic_;
};

/// 0 up to `from`, 1 beyond `to`, between them the quintic with zero first and second derivative at both ends.
double smooth_step(double from, double to, double position);

/// Smooth fidgeting: a sum of sines with fixed pseudo-random phases, values about -1 .. 1, that repeats every `period`
/// seconds. `low` and `high` are the lowest and highest harmonic of 1/period; `seed` chooses the phases.
double fidget(double seconds, double period, int low, int high, std::uint32_t seed);

}  // namespace nmc::samples
