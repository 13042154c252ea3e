// Evaluation of STEP, LINEAR and CUBICSPLINE curves in double precision.
#include "motion/curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/error.h"

namespace nmc::motion {
namespace {

using Quaternion = std::array<double, 4>;

/// Below this angle (radians) the chord and the arc agree to the last bit.
constexpr double chord_angle_radians = 1e-9;

void normalize(std::span<double> q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (length == 0.0) {
    q[0] = q[1] = q[2] = 0.0;
    q[3] = 1.0;
    return;
  }
  for (double& x : q) x /= length;
}

Quaternion unit_key(const float* key) {
  Quaternion q{key[0], key[1], key[2], key[3]};
  normalize(q);
  return q;
}

void slerp(const float* from, const float* to, double u, std::span<double> out) {
  const Quaternion a = unit_key(from);
  Quaternion b = unit_key(to);
  const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  if (dot < 0.0) {
    for (double& x : b) x = -x;
  }
  double difference = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    difference += (b[i] - a[i]) * (b[i] - a[i]);
    sum += (b[i] + a[i]) * (b[i] + a[i]);
  }
  // Half chord over half diagonal: exact to rounding for all angles, where acos(dot) loses half its digits near zero.
  const double angle = 2.0 * std::atan2(std::sqrt(difference), std::sqrt(sum));
  double share_a = 1.0 - u, share_b = u;
  if (!(angle < chord_angle_radians)) {
    const double sine = std::sin(angle);
    share_a = std::sin((1.0 - u) * angle) / sine;
    share_b = std::sin(u * angle) / sine;
  }
  for (std::size_t i = 0; i < 4; ++i) out[i] = share_a * a[i] + share_b * b[i];
  normalize(out);
}

/// Appendix C.5: the Hermite cubic with tangents per second.
void cubic(const float* from, const float* to, std::size_t width, double span_seconds, double u,
           std::span<double> out) {
  const double u2 = u * u, u3 = u2 * u;
  const float* start = from + width;
  const float* out_tangent = from + 2 * width;
  const float* in_tangent = to;
  const float* end = to + width;
  for (std::size_t i = 0; i < width; ++i) {
    out[i] = (2 * u3 - 3 * u2 + 1) * start[i] + span_seconds * (u3 - 2 * u2 + u) * out_tangent[i] +
             (-2 * u3 + 3 * u2) * end[i] + span_seconds * (u3 - u2) * in_tangent[i];
  }
}

std::size_t rows_per_key(const Curve& curve) { return curve.interpolation == Interpolation::cubic_spline ? 3 : 1; }

}  // namespace

CurveReader::CurveReader(const Curve& curve) : curve_(&curve) {
  const bool width_fits = curve.width > 0 && (curve.path != Path::rotation || curve.width == 4);
  const std::size_t row = width_fits ? static_cast<std::size_t>(curve.width) * rows_per_key(curve) : 0;
  if (!width_fits || curve.times.empty() || curve.values.size() % row != 0 ||
      curve.values.size() / row != curve.times.size()) {
    throw Error(ErrorCode::internal, "The curve of node " + std::to_string(curve.node) +
                                         " has no keys or its values do not fit its times; this is a defect.");
  }
}

void CurveReader::seek(double seconds) {
  const std::vector<float>& times = curve_->times;
  if (times.size() < 2) return;
  constexpr std::size_t near = 4;  // segments that a player steps over from one pose to the next
  const std::size_t last = times.size() - 2;
  if (seconds < static_cast<double>(times[segment_]) ||
      seconds >= static_cast<double>(times[std::min(last, segment_ + near)])) {
    const auto after = std::upper_bound(times.begin(), times.end(), seconds,
                                        [](double t, float key) { return t < static_cast<double>(key); });
    segment_ = std::min(last, static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - times.begin() - 1, 0)));
    return;
  }
  while (segment_ < last && static_cast<double>(times[segment_ + 1]) <= seconds) ++segment_;
}

void CurveReader::read(double seconds, std::span<double> out) {
  const Curve& curve = *curve_;
  const std::size_t width = static_cast<std::size_t>(curve.width);
  const std::size_t row = width * rows_per_key(curve);
  const std::size_t value_offset = curve.interpolation == Interpolation::cubic_spline ? width : 0;
  seek(seconds);

  const std::size_t next = std::min(segment_ + 1, curve.times.size() - 1);
  const double start = curve.times[segment_];
  const double span_seconds = static_cast<double>(curve.times[next]) - start;
  const double u = span_seconds > 0.0 ? std::clamp((seconds - start) / span_seconds, 0.0, 1.0) : 0.0;
  const float* from = curve.values.data() + segment_ * row;
  const float* to = curve.values.data() + next * row;

  const auto copy_key = [&](const float* key) {
    for (std::size_t i = 0; i < width; ++i) out[i] = key[value_offset + i];
    if (curve.path == Path::rotation) normalize(out.first(4));
  };
  if (u == 0.0) return copy_key(from);
  if (u == 1.0) return copy_key(to);
  switch (curve.interpolation) {
    case Interpolation::step:
      return copy_key(from);
    case Interpolation::cubic_spline:
      cubic(from, to, width, span_seconds, u, out);
      if (curve.path == Path::rotation) normalize(out.first(4));
      return;
    case Interpolation::linear:
      if (curve.path == Path::rotation) return slerp(from, to, u, out.first(4));
      for (std::size_t i = 0; i < width; ++i) out[i] = (1.0 - u) * from[i] + u * to[i];
  }
}

void evaluate(const Curve& curve, double seconds, std::span<double> out) { CurveReader(curve).read(seconds, out); }

void evaluate(const Curve& curve, std::span<const double> times, std::span<double> out) {
  CurveReader reader(curve);
  const std::size_t width = static_cast<std::size_t>(curve.width);
  for (std::size_t i = 0; i < times.size(); ++i) reader.read(times[i], out.subspan(i * width, width));
}

}  // namespace nmc::motion
