// Curves on one time grid: finding the grid, sampling, and back to curves.
#include "motion/clip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/error.h"
#include "motion/curve.h"

namespace nmc::motion {
namespace {

constexpr double same_key_seconds = 1e-6;
constexpr int max_subdivisions = 64;

/// The key times that a number of curves share.
struct Grid {
  const std::vector<float>* times = nullptr;
  std::size_t curves = 0;
};

/// The different key grids in order of their first curves.
std::vector<Grid> distinct_grids(const std::vector<Curve>& curves) {
  std::vector<Grid> grids;
  for (const Curve& curve : curves) {
    const auto same = std::find_if(grids.begin(), grids.end(), [&](const Grid& g) { return *g.times == curve.times; });
    if (same != grids.end()) {
      ++same->curves;
    } else {
      grids.push_back({&curve.times, 1});
    }
  }
  return grids;
}

/// A key time with all grids that have it.
struct Key {
  float seconds = 0.0f;
  std::size_t first = 0;   ///< into the sorted (time, grid) entries
  std::size_t last = 0;    ///< one past
  std::size_t curves = 0;  ///< curves that have it
  std::size_t grid = 0;    ///< the earliest grid that has it
};

/// Whether `candidate` gives the bits of a merged key rather than `chosen`.
bool is_preferred(const Key& candidate, const Key& chosen) {
  if (candidate.curves != chosen.curves) return candidate.curves > chosen.curves;
  return candidate.grid < chosen.grid;
}

std::vector<float> union_of_times(const std::vector<Grid>& grids) {
  std::vector<std::pair<float, std::size_t>> entries;
  for (std::size_t g = 0; g < grids.size(); ++g) {
    for (const float t : *grids[g].times) entries.emplace_back(t, g);
  }
  std::sort(entries.begin(), entries.end());

  std::vector<Key> keys;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (keys.empty() || keys.back().seconds != entries[i].first) {
      keys.push_back({entries[i].first, i, i, 0, entries[i].second});
    }
    keys.back().last = i + 1;
    keys.back().curves += grids[entries[i].second].curves;
  }

  constexpr std::size_t none = static_cast<std::size_t>(-1);
  std::vector<std::size_t> cluster_of_grid(grids.size(), none);
  std::vector<float> result;
  for (std::size_t at = 0; at < keys.size();) {
    const std::size_t cluster = at;
    const auto belongs = [&](const Key& key) {
      if (static_cast<double>(key.seconds) - static_cast<double>(keys[cluster].seconds) >= same_key_seconds)
        return false;
      return std::none_of(entries.begin() + static_cast<std::ptrdiff_t>(key.first),
                          entries.begin() + static_cast<std::ptrdiff_t>(key.last),
                          [&](const auto& entry) { return cluster_of_grid[entry.second] == cluster; });
    };
    Key chosen = keys[cluster];
    while (at < keys.size() && belongs(keys[at])) {
      for (std::size_t i = keys[at].first; i < keys[at].last; ++i) cluster_of_grid[entries[i].second] = cluster;
      if (is_preferred(keys[at], chosen)) chosen = keys[at];
      ++at;
    }
    result.push_back(chosen.seconds);
  }
  return result;
}

std::vector<float> subdivide(const std::vector<float>& keys, int subdivisions) {
  std::vector<float> result;
  for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
    const double start = keys[i], step = (static_cast<double>(keys[i + 1]) - start) / subdivisions;
    result.push_back(keys[i]);
    for (int k = 1; k < subdivisions; ++k) {
      const float t = static_cast<float>(start + step * k);
      if (t > result.back() && t < keys[i + 1]) result.push_back(t);
    }
  }
  if (!keys.empty()) result.push_back(keys.back());
  return result;
}

using Row = std::vector<double>;

/// How far two values of a curve are apart: radians for rotations, else the length of the difference.
double distance(const Curve& curve, const Row& a, const Row& b) {
  double minus = 0.0, plus = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    minus += (a[i] - b[i]) * (a[i] - b[i]);
    plus += (a[i] + b[i]) * (a[i] + b[i]);
  }
  if (curve.path != Path::rotation) return std::sqrt(minus);
  return 4.0 * std::atan2(std::sqrt(std::min(minus, plus)), std::sqrt(std::max(minus, plus)));
}

/// Whether straight interpolation from `start` to `end` stays within `limit` of the curve at the quarters between.
bool is_straight(CurveReader& reader, float start, float end, double limit) {
  const Curve& curve = reader.curve();
  const std::size_t width = static_cast<std::size_t>(curve.width);
  Curve chord{curve.node, curve.path, Interpolation::linear, curve.width, {start, end}, {}};
  Row truth(width), straight(width);
  for (const float t : chord.times) {
    reader.read(t, truth);
    for (const double x : truth) chord.values.push_back(static_cast<float>(x));
  }
  for (const double quarter : {0.25, 0.5, 0.75}) {
    const double t = start + quarter * (static_cast<double>(end) - start);
    reader.read(t, truth);
    evaluate(chord, t, straight);
    if (!(distance(curve, truth, straight) <= limit)) return false;
  }
  return true;
}

bool follows(const Curve& curve, const std::vector<float>& times, double limit) {
  CurveReader reader(curve);
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    if (!is_straight(reader, times[i], times[i + 1], limit)) return false;
  }
  return true;
}

/// Whether every key has the value of the first (rotations: up to sign) and no tangent bends the way between.
bool never_changes(const Curve& curve) {
  const std::size_t width = static_cast<std::size_t>(curve.width);
  const bool cubic = curve.interpolation == Interpolation::cubic_spline;
  const std::size_t row = cubic ? 3 * width : width, offset = cubic ? width : 0;
  const float* first = curve.values.data() + offset;
  for (std::size_t key = 0; key < curve.times.size(); ++key) {
    const float* value = curve.values.data() + key * row + offset;
    bool same = true, negated = curve.path == Path::rotation && !cubic;
    for (std::size_t i = 0; i < width; ++i) {
      same = same && value[i] == first[i];
      negated = negated && value[i] == -first[i];
      if (cubic && (*(value + i - width) != 0.0f || *(value + i + width) != 0.0f)) return false;
    }
    if (!same && !negated) return false;
  }
  return true;
}

/// Rows of float values; rotations with continuous signs.
std::vector<float> sampled_rows(const Curve& curve, const std::vector<float>& times) {
  const std::size_t width = static_cast<std::size_t>(curve.width);
  CurveReader reader(curve);
  std::vector<float> rows;
  rows.reserve(times.size() * width);
  Row value(width), previous;
  for (const float t : times) {
    reader.read(t, value);
    if (curve.path == Path::rotation && !previous.empty()) {
      double dot = 0.0;
      for (std::size_t i = 0; i < 4; ++i) dot += value[i] * previous[i];
      if (dot < 0.0) {
        for (double& x : value) x = -x;
      }
    }
    for (const double x : value) rows.push_back(static_cast<float>(x));
    previous = value;
  }
  return rows;
}

bool rows_are_equal(const std::vector<float>& rows, std::size_t width) {
  for (std::size_t i = width; i < rows.size(); ++i) {
    if (rows[i] != rows[i - width]) return false;
  }
  return true;
}

}  // namespace

std::vector<float> common_times(const std::vector<Curve>& curves, int subdivisions) {
  if (subdivisions < 1 || subdivisions > max_subdivisions) {
    throw Error(ErrorCode::internal,
                "Times can be divided into 1 to 64 parts, not " + std::to_string(subdivisions) + "; this is a defect.");
  }
  const std::vector<Grid> grids = distinct_grids(curves);
  const std::vector<float> keys = grids.size() == 1 ? *grids[0].times : union_of_times(grids);
  return subdivisions == 1 ? keys : subdivide(keys, subdivisions);
}

int needed_subdivisions(const std::vector<Curve>& curves, double max_angle_radians, double max_distance) {
  const std::vector<float> keys = common_times(curves);
  int needed = 1;
  for (const Curve& curve : curves) {
    if (curve.interpolation != Interpolation::cubic_spline) continue;
    const double limit = curve.path == Path::translation ? max_distance : max_angle_radians;
    while (needed < max_subdivisions && !follows(curve, subdivide(keys, needed), limit)) needed *= 2;
  }
  return needed;
}

double sample_rate_hz(const std::vector<float>& times) {
  if (times.size() < 2) return 0.0;
  std::vector<double> spacings;
  for (std::size_t i = 0; i + 1 < times.size(); ++i) {
    spacings.push_back(static_cast<double>(times[i + 1]) - static_cast<double>(times[i]));
  }
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>((spacings.size() - 1) / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  const double median = *middle;
  double sum = 0.0;
  int count = 0;
  for (const double spacing : spacings) {
    if (std::abs(spacing - median) > 0.1 * median) continue;
    sum += spacing;
    ++count;
  }
  return sum > 0.0 ? count / sum : 0.0;
}

Clip sample_clip(const std::string& name, const std::vector<Curve>& curves, const std::vector<float>& times) {
  Clip clip{name, times, {}};
  for (const Curve& curve : curves) {
    const CurveReader checked(curve);
    const bool constant = never_changes(checked.curve());
    if (curve.interpolation == Interpolation::step && !constant) {
      throw Error(ErrorCode::internal, "The STEP curve of node " + std::to_string(curve.node) + " in animation '" +
                                           name +
                                           "' changes its value and cannot become part of a clip; this is a defect.");
    }
    const std::size_t width = static_cast<std::size_t>(curve.width);
    // One row is enough; a slerp between equal keys may differ in the last bit.
    Track track{curve.node, curve.path, curve.width, {}};
    track.values = sampled_rows(curve, constant && !times.empty() ? std::vector<float>{times.front()} : times);
    if (rows_are_equal(track.values, width)) track.values.resize(std::min(track.values.size(), width));
    clip.tracks.push_back(std::move(track));
  }
  return clip;
}

Animation to_animation(const Clip& clip) {
  Animation animation{clip.name, {}};
  if (clip.times.empty()) return animation;
  const std::vector<float> ends =
      clip.times.size() == 1 ? clip.times : std::vector<float>{clip.times.front(), clip.times.back()};
  for (const Track& track : clip.tracks) {
    Curve curve{track.node, track.path, Interpolation::linear, track.width, track.constant() ? ends : clip.times, {}};
    curve.values = track.values;
    if (track.constant() && ends.size() == 2) {
      curve.values.insert(curve.values.end(), track.values.begin(), track.values.end());
    }
    animation.curves.push_back(std::move(curve));
  }
  return animation;
}

}  // namespace nmc::motion
