#include "baselines/root_alignment.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <iterator>

#include "baselines/splines.h"
#include "motion/index.h"
#include "motion/skeleton.h"

namespace nmc::baselines {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double turn_share = 0.2;  // what an angle moves, share of size
constexpr double levels = 65535;

glm::dquat root_rotation(const MarkerRig& rig, const MatrixXd& values, Index n) {
  return motion::decompose(world_of(*rig.skeleton, *rig.head, values, n)[motion::at(rig.root)]).rotation;
}

/// How the root stands in its mean pose over all clips: turns count from there.
glm::dquat mean_turn(const MarkerRig& rig, const std::vector<MatrixXd>& values) {
  glm::dquat sum(0, 0, 0, 0);
  for (const MatrixXd& v : values)
    for (Index n = 0; n < v.cols(); ++n) {
      const glm::dquat q = root_rotation(rig, v, n);
      sum = sum + (glm::dot(sum, q) < 0 ? -q : q);
    }
  return glm::length(sum) > 1e-9 ? glm::normalize(sum) : glm::dquat(1, 0, 0, 0);
}

double nearest_turn(double angle, double last) {
  return angle + glm::two_pi<double>() * std::round((last - angle) / glm::two_pi<double>());
}

MatrixXd transform(const MarkerRig& rig, const RootMotion& root, MatrixXd markers, bool forward) {
  for (Index n = 0; n < markers.cols(); ++n) {
    const glm::dquat turn = root.turn(n), back = glm::inverse(turn);
    const glm::dvec3 origin = root.position(n);
    for (Index row = 0; row < rig.marker_rows(); row += 3) {
      glm::dvec3 p(markers(row, n), markers(row + 1, n), markers(row + 2, n));
      p = forward ? back * (p - origin) : turn * p + origin;
      for (int a = 0; a < 3; ++a) markers(row + a, n) = p[a];
    }
  }
  return markers;
}

}  // namespace

glm::dquat RootMotion::turn(Index n) const {
  if (!full) return glm::angleAxis(rows(3, n), glm::dvec3(0, 1, 0));
  const glm::dquat q(rows(6, n), rows(3, n), rows(4, n), rows(5, n));
  return glm::length(q) > 1e-6 ? glm::normalize(q) : glm::dquat(1, 0, 0, 0);
}

std::vector<RootMotion> find_roots(const MarkerRig& rig, const std::vector<MatrixXd>& values) {
  std::vector<RootMotion> roots(values.size());
  if (rig.root < 0) {
    for (std::size_t c = 0; c < values.size(); ++c) roots[c].rows = MatrixXd::Zero(4, values[c].cols());
    return roots;
  }
  // Mean pose: its own up is what "upright" means.
  const glm::dquat mean = mean_turn(rig, values);
  const glm::dvec3 up = glm::inverse(mean) * glm::dvec3(0, 1, 0);
  double tilt = 0;
  for (const MatrixXd& v : values)
    for (Index n = 0; n < v.cols(); ++n)
      tilt = std::max(tilt, std::acos(std::clamp((root_rotation(rig, v, n) * up).y, -1.0, 1.0)));
  for (std::size_t c = 0; c < values.size(); ++c) {
    RootMotion& root = roots[c];
    root.full = tilt > large_tilt_radians;
    root.rows.resize(root.full ? 7 : 4, values[c].cols());
    glm::dquat last(1, 0, 0, 0);
    for (Index n = 0; n < values[c].cols(); ++n) {
      const glm::dmat4 world = world_of(*rig.skeleton, *rig.head, values[c], n)[motion::at(rig.root)];
      for (int a = 0; a < 3; ++a) root.rows(a, n) = world[3][a];
      glm::dquat q = motion::decompose(world).rotation;
      if (root.full) {
        if (glm::dot(q, last) < 0) q = -q;
        last = q;
        root.rows.block<4, 1>(3, n) = Eigen::Vector4d(q.x, q.y, q.z, q.w);
        continue;
      }
      const glm::dquat from_mean = q * glm::inverse(mean);
      const double angle = 2 * std::atan2(from_mean.y, from_mean.w);  // the twist about the vertical
      root.rows(3, n) = n == 0 ? angle : nearest_turn(angle, root.rows(3, n - 1));
    }
  }
  return roots;
}

std::vector<RootMotion> write_roots(ByteWriter& bytes, const std::vector<RootMotion>& roots, double size, Index span,
                                    double threshold) {
  const bool full = !roots.empty() && roots.front().full;
  const Index rows = full ? 7 : 4;
  bytes.u8(full ? 1 : 0);
  bytes.count(static_cast<std::uint64_t>(span));
  std::vector<RootMotion> read;
  for (const RootMotion& root : roots) read.push_back({full, MatrixXd(rows, root.rows.cols())});
  ByteWriter places, values;
  for (Index row = 0; row < rows; ++row) {
    double low = 0, high = 0;
    for (std::size_t c = 0; c < roots.size(); ++c) {
      low = c == 0 ? roots[c].rows.row(row).minCoeff() : std::min(low, roots[c].rows.row(row).minCoeff());
      high = c == 0 ? roots[c].rows.row(row).maxCoeff() : std::max(high, roots[c].rows.row(row).maxCoeff());
    }
    low = static_cast<double>(static_cast<float>(low));
    const auto step = static_cast<double>(static_cast<float>(std::max((high - low) / levels, 1e-12)));
    bytes.f32(low);
    bytes.f32(step);
    for (std::size_t c = 0; c < roots.size(); ++c) {
      const Eigen::VectorXd curve = roots[c].rows.row(row).transpose();
      const double unit = row < 3 ? 1.0 : turn_share * size;
      const std::vector<Index> points = fit_catmull_rom(curve, span, threshold / unit);
      const std::vector<Index> regular = regular_points(curve.size(), span);
      std::vector<Index> added;
      std::set_difference(points.begin(), points.end(), regular.begin(), regular.end(), std::back_inserter(added));
      places.count(added.size());
      for (std::size_t i = 0; i < added.size(); ++i)
        places.count(static_cast<std::uint64_t>(added[i] - (i ? added[i - 1] : 0)));
      Eigen::VectorXd rounded(static_cast<Index>(points.size()));
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double level = std::clamp(std::round((curve(points[i]) - low) / step), 0.0, levels);
        values.u16(static_cast<unsigned>(level));
        rounded(static_cast<Index>(i)) = low + level * step;
      }
      read[c].rows.row(row) = catmull_rom(points, rounded).transpose();
    }
  }
  bytes.packed(places.bytes());
  bytes.packed(values.bytes());
  return read;
}

std::vector<RootMotion> read_roots(ByteReader& bytes, const std::vector<Index>& frames) {
  std::vector<RootMotion> roots;
  const bool full = bytes.u8() != 0;
  const auto span = static_cast<Index>(bytes.count(1 << 20));
  if (span < 1) refuse_damaged("control points have no distance");
  const Index rows = full ? 7 : 4;
  std::vector<std::pair<double, double>> ranges;
  for (Index row = 0; row < rows; ++row) {
    const double low = bytes.f32();
    ranges.emplace_back(low, bytes.f32());
  }
  const Bytes place_bytes = bytes.packed(), value_bytes = bytes.packed();
  ByteReader places(place_bytes), values(value_bytes);
  for (const Index count : frames) roots.push_back({full, MatrixXd(rows, count)});
  for (Index row = 0; row < rows; ++row)
    for (std::size_t c = 0; c < frames.size(); ++c) {
      std::vector<Index> points = regular_points(frames[c], span);
      const std::uint64_t added = places.count(static_cast<std::uint64_t>(frames[c]));
      Index last = 0;
      for (std::uint64_t i = 0; i < added; ++i) {
        last += static_cast<Index>(places.count(static_cast<std::uint64_t>(frames[c])));
        if (last >= frames[c]) refuse_damaged("a control point lies outside its clip");
        points.push_back(last);
      }
      std::sort(points.begin(), points.end());
      points.erase(std::unique(points.begin(), points.end()), points.end());
      Eigen::VectorXd levels_read(static_cast<Index>(points.size()));
      const auto [low, step] = ranges[static_cast<std::size_t>(row)];
      for (double& x : levels_read) x = low + step * values.u16();
      roots[c].rows.row(row) = catmull_rom(points, levels_read).transpose();
    }
  places.expect_end();
  values.expect_end();
  return roots;
}

MatrixXd align(const MarkerRig& rig, const RootMotion& root, MatrixXd markers) {
  return transform(rig, root, std::move(markers), true);
}

MatrixXd unalign(const MarkerRig& rig, const RootMotion& root, MatrixXd markers) {
  return transform(rig, root, std::move(markers), false);
}

}  // namespace nmc::baselines
