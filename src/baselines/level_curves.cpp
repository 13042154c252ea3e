#include "baselines/level_curves.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "baselines/splines.h"

namespace nmc::baselines {
namespace {

using Eigen::Index;

constexpr int most_bits = 16;
constexpr unsigned most_base_bits = 16;

/// A curve's lowest value in few bits, not above it.
double base_of(unsigned level, double low, double high, int bits) {
  return low + (high - low) * static_cast<double>(level) / static_cast<double>((1u << bits) - 1);
}

unsigned base_level(double value, double low, double high, int bits) {
  if (!(high > low)) return 0;
  const auto most = static_cast<double>((1u << bits) - 1);
  return static_cast<unsigned>(std::clamp(std::floor((value - low) / (high - low) * most), 0.0, most));
}

double as_float(double value) { return static_cast<double>(static_cast<float>(value)); }

}  // namespace

int bits_for(double range, double expected) {
  if (!(range > 0)) return 0;
  if (!(expected > 0)) return most_bits;
  return std::clamp(static_cast<int>(std::ceil(std::log2(range / (4 * expected)))), 0, most_bits);
}

unsigned quantize(double value, double low, double range, int bits) {
  if (!(range > 0)) return 0;
  const double count = std::exp2(bits);
  return static_cast<unsigned>(std::clamp(std::floor((value - low) / range * count), 0.0, count - 1));
}

double dequantize(unsigned level, double low, double range, int bits) {
  return low + (static_cast<double>(level) + 0.5) * range / std::exp2(bits);
}

std::vector<Eigen::VectorXd> write_curves(CurveStreams& streams, const std::vector<Eigen::VectorXd>& curves,
                                          const CurveSettings& settings, double widest, CurveCounts& counts) {
  std::vector<Eigen::VectorXd> read;
  if (curves.empty()) return read;
  std::vector<std::vector<Index>> points;
  std::vector<double> lows, highs;
  for (const Eigen::VectorXd& curve : curves) {
    points.push_back(fit_catmull_rom(curve, settings.span, settings.threshold));
    const Eigen::VectorXd values = columns_at(curve.transpose(), points.back()).transpose();
    lows.push_back(values.minCoeff());
    highs.push_back(values.maxCoeff());
  }
  const double low = as_float(*std::min_element(lows.begin(), lows.end()) - 1e-6 * widest);
  const double high = as_float(*std::max_element(lows.begin(), lows.end()) + 1e-6 * widest);
  const bool uniform = settings.uniform_bits > 0;
  const int base_bits = uniform ? 0 : settings.base_bits;
  std::vector<unsigned> bases(curves.size(), 0);
  double range = 0;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    if (!uniform) bases[c] = base_level(lows[c], low, high, base_bits);
    range = std::max(range, highs[c] - (uniform ? low : base_of(bases[c], low, high, base_bits)));
  }
  range = as_float(uniform ? std::max(range, widest) : 1.000001 * range);
  const int bits = uniform ? settings.uniform_bits : bits_for(range, settings.expected);
  streams.ranges.f32(low);
  streams.ranges.f32(high);
  streams.ranges.f32(range);
  streams.ranges.u8(static_cast<unsigned>(bits));
  streams.ranges.u8(static_cast<unsigned>(base_bits));
  for (std::size_t c = 0; c < curves.size(); ++c) {
    if (base_bits > 8)
      streams.large.u16(bases[c]);
    else if (base_bits > 0)
      streams.small.u8(bases[c]);
    const double base = base_bits > 0 ? base_of(bases[c], low, high, base_bits) : low;
    const std::vector<Index> regular = regular_points(curves[c].size(), settings.span);
    std::vector<Index> added;
    std::set_difference(points[c].begin(), points[c].end(), regular.begin(), regular.end(), std::back_inserter(added));
    streams.points.count(added.size());
    for (std::size_t i = 0; i < added.size(); ++i)
      streams.points.count(static_cast<std::uint64_t>(added[i] - (i ? added[i - 1] : 0)));
    Eigen::VectorXd rounded(static_cast<Index>(points[c].size()));
    for (std::size_t i = 0; i < points[c].size(); ++i) {
      const unsigned level = quantize(curves[c](points[c][i]), base, range, bits);
      if (bits > 8)
        streams.large.u16(level);
      else if (bits > 0)
        streams.small.u8(level);
      rounded(static_cast<Index>(i)) = dequantize(level, base, range, bits);
    }
    counts.bits += bits * static_cast<double>(points[c].size());
    counts.values += points[c].size();
    read.push_back(catmull_rom(points[c], rounded));
  }
  return read;
}

std::vector<Eigen::VectorXd> read_curves(CurveReaders& readers, const std::vector<Index>& lengths, Index span) {
  std::vector<Eigen::VectorXd> curves;
  if (lengths.empty()) return curves;
  const double low = readers.ranges.f32(), high = readers.ranges.f32(), range = readers.ranges.f32();
  const unsigned bits = readers.ranges.u8(), base_bits = readers.ranges.u8();
  if (bits > most_bits || base_bits > most_base_bits) refuse_damaged("values have too many bits");
  for (const Index length : lengths) {
    double base = low;
    if (base_bits > 8)
      base = base_of(readers.large.u16(), low, high, static_cast<int>(base_bits));
    else if (base_bits > 0)
      base = base_of(readers.small.u8(), low, high, static_cast<int>(base_bits));
    std::vector<Index> points = regular_points(length, span);
    const std::uint64_t added = readers.points.count(static_cast<std::uint64_t>(length));
    Index last = 0;
    for (std::uint64_t i = 0; i < added; ++i) {
      last += static_cast<Index>(readers.points.count(static_cast<std::uint64_t>(length)));
      if (last >= length) refuse_damaged("a control point lies outside its clip");
      points.push_back(last);
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    Eigen::VectorXd values(static_cast<Index>(points.size()));
    for (double& x : values) {
      const unsigned level = bits > 8 ? readers.large.u16() : bits > 0 ? readers.small.u8() : 0;
      x = dequantize(level, base, range, static_cast<int>(bits));
    }
    curves.push_back(catmull_rom(points, values));
  }
  return curves;
}

}  // namespace nmc::baselines
