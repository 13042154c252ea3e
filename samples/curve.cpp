// Smooth curves of one variable that motions are drawn with.
#include "samples/curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace nmc::samples {
namespace {

using Key = Curve::Key;

double secant(const Key& a, const Key& b) { return (b.second - a.second) / (b.first - a.first); }

/// The slope of a monotone cubic at a key from the secants on both sides (weighted harmonic mean, Fritsch and Butland
/// 1984).
double monotone_slope(double before_width, double before, double after_width, double after) {
  if (before * after <= 0.0) return 0.0;
  const double w1 = 2.0 * after_width + before_width;
  const double w2 = after_width + 2.0 * before_width;
  return (w1 + w2) / (w1 / before + w2 / after);
}

std::uint32_t next_random(std::uint32_t& state) {  // xorshift32, Marsaglia 2003
  state ^= state << 13;
  state ^= state >> 17;
  state ^= state << 5;
  return state;
}

}  // namespace

Curve::Curve(std::initializer_list<Key> keys, bool periodic)
    : keys_(keys), slopes_(keys.size(), 0.0), periodic_(periodic) {
  const std::size_t count = keys_.size();
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if (i == 0 && !periodic_) continue;
    const std::size_t before = i == 0 ? count - 2 : i - 1;
    const double before_width = keys_[before + 1].first - keys_[before].first;
    const double after_width = keys_[i + 1].first - keys_[i].first;
    slopes_[i] = monotone_slope(before_width, secant(keys_[before], keys_[before + 1]), after_width,
                                secant(keys_[i], keys_[i + 1]));
  }
  if (periodic_) slopes_.back() = slopes_.front();
}

double Curve::operator()(double position) const {
  const double first = keys_.front().first, last = keys_.back().first;
  if (periodic_) position -= std::floor((position - first) / (last - first)) * (last - first);
  if (position <= first) return keys_.front().second;
  if (position >= last) return keys_.back().second;
  const auto after =
      std::upper_bound(keys_.begin(), keys_.end(), position, [](double p, const Key& key) { return p < key.first; });
  const auto i = static_cast<std::size_t>(after - keys_.begin()) - 1;
  const double width = keys_[i + 1].first - keys_[i].first;
  const double u = (position - keys_[i].first) / width;
  const double v = 1.0 - u;
  return v * v * (1.0 + 2.0 * u) * keys_[i].second + u * u * (3.0 - 2.0 * u) * keys_[i + 1].second +
         width * u * v * (v * slopes_[i] - u * slopes_[i + 1]);
}

double smooth_step(double from, double to, double position) {
  const double u = std::clamp((position - from) / (to - from), 0.0, 1.0);
  return u * u * u * (10.0 + u * (6.0 * u - 15.0));
}

double fidget(double seconds, double period, int low, int high, std::uint32_t seed) {
  constexpr double turn = 2.0 * std::numbers::pi;
  std::uint32_t state = seed * 2654435761u + 1u;
  double sum = 0.0, power = 0.0;
  for (int harmonic = low; harmonic <= high; ++harmonic) {
    next_random(state);
    const double phase = turn * next_random(state) / 4294967296.0;
    const double amplitude = 1.0 / harmonic;
    sum += amplitude * std::sin(turn * harmonic * seconds / period + phase);
    power += amplitude * amplitude;
  }
  return sum / std::sqrt(2.0 * power);
}

}  // namespace nmc::samples
