#include "baselines/pga_ik.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "baselines/level_curves.h"
#include "baselines/principal_components.h"
#include "motion/clip.h"
#include "motion/index.h"
#include "motion/pose_parameters.h"

namespace nmc::baselines {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using motion::at;

constexpr double span_seconds = 8.0 / 120;
constexpr int number_bits = 16;
constexpr double prior = 0.003;      // of coefficients (in standard deviations) against end effectors (in sizes)
constexpr double steadiness = 0.01;  // the same for their change from the frame before
constexpr int most_steps = 12;
constexpr Index most_axes = 60;

double rate_of(const Head& head) {
  double rate = 0;
  for (const std::vector<float>& t : head.times) rate = std::max(rate, motion::sample_rate_hz(t));
  return rate > 0 ? rate : 120;
}

glm::dquat quaternion(const MatrixXd& values, Index first, Index n) {
  return glm::normalize(glm::dquat(values(first + 3, n), values(first, n), values(first + 1, n), values(first + 2, n)));
}

/// What the model poses: the rotations below the root; the root itself is stored.
struct PgaRig {
  MarkerRig markers;                    ///< for its root
  std::vector<const Channel*> turning;  ///< rotations that the axes move
  std::vector<int> ends;                ///< joints whose ways are stored
};

PgaRig make_rig(const motion::Skeleton& skeleton, const Head& head, double size) {
  PgaRig rig;
  rig.markers = make_marker_rig(skeleton, head, MarkerSet::compact, size);
  std::vector<char> turns(skeleton.size(), 0), inner(skeleton.size(), 0);
  for (const Channel& channel : head.channels) {
    if (!channel.moves || channel.target.path != Path::rotation) continue;
    turns[at(channel.target.node)] = 1;
    if (channel.target.node != rig.markers.root) rig.turning.push_back(&channel);
  }
  // The ends of chains of joints that turn: joints below them that do not, or else they themselves.
  const std::vector<int>& joints = skeleton.joints.empty() ? skeleton.order : skeleton.joints;
  for (const int node : joints)
    for (int above = skeleton.parent[at(node)]; above >= 0; above = skeleton.parent[at(above)]) inner[at(above)] = 1;
  for (const int node : joints)
    if (!inner[at(node)] && node != rig.markers.root) rig.ends.push_back(node);
  return rig;
}

/// The model in the tangent space at each joint's mean rotation.
struct PgaModel {
  MatrixXd means;  ///< 3 x joints: rotation vectors from rest
  VectorXd still;  ///< values of moving channels that the model does not pose
  MatrixXd axes;   ///< 3 joints x axes, in radians per standard deviation
};

glm::dquat mean_of(const motion::Skeleton& skeleton, const PgaRig& rig, const PgaModel& model, std::size_t j) {
  const auto i = static_cast<Index>(j);
  return skeleton.rest[at(rig.turning[j]->target.node)].rotation *
         motion::rotation_of_vector({model.means(0, i), model.means(1, i), model.means(2, i)});
}

/// Sets the rotations of coefficients into a column of values.
void pose(const motion::Skeleton& skeleton, const PgaRig& rig, const PgaModel& model, const VectorXd& coefficients,
          MatrixXd& values, Index n) {
  const VectorXd tangent = model.axes * coefficients;
  for (std::size_t j = 0; j < rig.turning.size(); ++j) {
    const auto i = 3 * static_cast<Index>(j);
    const glm::dquat q =
        mean_of(skeleton, rig, model, j) * motion::rotation_of_vector({tangent(i), tangent(i + 1), tangent(i + 2)});
    values.block<4, 1>(rig.turning[j]->first, n) = Eigen::Vector4d(q.x, q.y, q.z, q.w);
  }
}

/// Puts the root where it was stored, in the space of its parent.
void place_root(const motion::Skeleton& skeleton, const Head& head, const PgaRig& rig, const RootMotion& root,
                MatrixXd& values, Index n) {
  if (rig.markers.root < 0) return;
  const int parent = skeleton.parent[at(rig.markers.root)];
  const glm::dmat4 above = parent < 0 ? glm::dmat4(1.0) : world_of(skeleton, head, values, n)[at(parent)];
  const glm::dvec3 position(glm::inverse(above) * glm::dvec4(root.position(n), 1.0));
  const glm::dquat turn = glm::inverse(motion::decompose(above).rotation) * root.turn(n);
  for (const Channel& channel : head.channels) {
    if (!channel.moves || channel.target.node != rig.markers.root) continue;
    if (channel.target.path == Path::translation)
      values.block<3, 1>(channel.first, n) = Eigen::Vector3d(position.x, position.y, position.z);
    if (channel.target.path == Path::rotation)
      values.block<4, 1>(channel.first, n) = Eigen::Vector4d(turn.x, turn.y, turn.z, turn.w);
  }
}

VectorXd end_positions(const motion::Skeleton& skeleton, const PgaRig& rig, const std::vector<glm::dmat4>& world) {
  VectorXd positions(3 * static_cast<Index>(rig.ends.size()));
  for (std::size_t e = 0; e < rig.ends.size(); ++e)
    for (int a = 0; a < 3; ++a) positions(3 * static_cast<Index>(e) + a) = world[at(rig.ends[e])][3][a];
  (void)skeleton;
  return positions;
}

/// How the end effectors move per radian of each joint's tangent: 3 ends x 3 joints. To first order a tangent turns by
/// itself in the space of its joint.
MatrixXd tangent_jacobian(const motion::Skeleton& skeleton, const PgaRig& rig, const std::vector<glm::dmat4>& world) {
  MatrixXd jacobian =
      MatrixXd::Zero(3 * static_cast<Index>(rig.ends.size()), 3 * static_cast<Index>(rig.turning.size()));
  for (std::size_t e = 0; e < rig.ends.size(); ++e) {
    std::vector<char> above(skeleton.size(), 0);
    for (int node = skeleton.parent[at(rig.ends[e])]; node >= 0; node = skeleton.parent[at(node)]) above[at(node)] = 1;
    for (std::size_t j = 0; j < rig.turning.size(); ++j) {
      const int node = rig.turning[j]->target.node;
      if (!above[at(node)]) continue;
      const glm::dmat4& m = world[at(node)];
      const glm::dvec3 arm(world[at(rig.ends[e])][3] - m[3]);
      for (int a = 0; a < 3; ++a) {
        const glm::dvec3 way = glm::cross(glm::normalize(glm::dvec3(m[a])), arm);
        for (int b = 0; b < 3; ++b) jacobian(3 * static_cast<Index>(e) + b, 3 * static_cast<Index>(j) + a) = way[b];
      }
    }
  }
  return jacobian;
}

/// Coefficients that bring the end effectors to their targets: Levenberg and Marquardt from those of the frame before.
VectorXd solve(const motion::Skeleton& skeleton, const Head& head, const PgaRig& rig, const PgaModel& model,
               const VectorXd& targets, const VectorXd& before, double size, MatrixXd& values, Index n) {
  VectorXd coefficients = before;
  const auto cost = [&](const VectorXd& c, const VectorXd& ends) {
    return (ends - targets).squaredNorm() / (size * size) + prior * prior * c.squaredNorm() +
           steadiness * steadiness * (c - before).squaredNorm();
  };
  pose(skeleton, rig, model, coefficients, values, n);
  std::vector<glm::dmat4> world = world_of(skeleton, head, values, n);
  VectorXd ends = end_positions(skeleton, rig, world);
  double now = cost(coefficients, ends), damping = 1e-6;
  for (int step = 0; step < most_steps; ++step) {
    const MatrixXd jacobian = tangent_jacobian(skeleton, rig, world) * model.axes / size;
    MatrixXd normal = jacobian.transpose() * jacobian;
    normal.diagonal().array() += prior * prior + steadiness * steadiness + damping;
    const VectorXd gradient = jacobian.transpose() * (ends - targets) / size + prior * prior * coefficients +
                              steadiness * steadiness * (coefficients - before);
    const VectorXd tried = coefficients - normal.ldlt().solve(gradient);
    if (!tried.allFinite()) break;
    pose(skeleton, rig, model, tried, values, n);
    std::vector<glm::dmat4> tried_world = world_of(skeleton, head, values, n);
    const VectorXd tried_ends = end_positions(skeleton, rig, tried_world);
    const double value = cost(tried, tried_ends);
    if (!(value < now)) {
      damping = std::max(100 * damping, 1e-4);
      if (damping > 1e3) break;
      continue;
    }
    const bool settled = now - value < 1e-4 * now;
    coefficients = tried;
    ends = tried_ends;
    world = std::move(tried_world);
    now = value;
    damping /= 10;
    if (settled) break;
  }
  pose(skeleton, rig, model, coefficients, values, n);
  return coefficients;
}

std::vector<RootMotion> full_roots(const PgaRig& rig, const std::vector<MatrixXd>& clips) {
  std::vector<RootMotion> roots;
  for (const MatrixXd& values : clips) {
    RootMotion root{true, MatrixXd::Zero(7, values.cols())};
    glm::dquat last(1, 0, 0, 0);
    for (Index n = 0; rig.markers.root >= 0 && n < values.cols(); ++n) {
      const glm::dmat4 world = world_of(*rig.markers.skeleton, *rig.markers.head, values, n)[at(rig.markers.root)];
      glm::dquat q = motion::decompose(world).rotation;
      if (glm::dot(q, last) < 0) q = -q;
      last = q;
      root.rows.col(n) << world[3][0], world[3][1], world[3][2], q.x, q.y, q.z, q.w;
    }
    roots.push_back(std::move(root));
  }
  return roots;
}

/// Intrinsic means by iteration in the tangent space.
MatrixXd intrinsic_means(const motion::Skeleton& skeleton, const PgaRig& rig, const std::vector<MatrixXd>& clips) {
  MatrixXd means = MatrixXd::Zero(3, static_cast<Index>(rig.turning.size()));
  for (std::size_t j = 0; j < rig.turning.size(); ++j) {
    const glm::dquat rest = skeleton.rest[at(rig.turning[j]->target.node)].rotation;
    std::vector<float> rows;
    for (const MatrixXd& values : clips)
      for (const double x : values.middleRows(rig.turning[j]->first, 4).reshaped())
        rows.push_back(static_cast<float>(x));
    glm::dquat mean = motion::mean_rotation(rows).mean;
    for (int round = 0; round < 5; ++round) {
      glm::dvec3 sum(0.0);
      double count = 0;
      for (const MatrixXd& values : clips)
        for (Index n = 0; n < values.cols(); ++n, ++count)
          sum += motion::rotation_vector(glm::inverse(mean) * quaternion(values, rig.turning[j]->first, n));
      mean = glm::normalize(mean * motion::rotation_of_vector(sum / count));
    }
    const glm::dvec3 v = motion::rotation_vector(glm::inverse(rest) * mean);
    means.col(static_cast<Index>(j)) << v.x, v.y, v.z;
  }
  return means;
}

void write_levels(ByteWriter& bytes, const MatrixXd& numbers) {
  const auto low = static_cast<double>(static_cast<float>(numbers.size() ? numbers.minCoeff() : 0));
  const auto range =
      static_cast<double>(static_cast<float>(1.000001 * ((numbers.size() ? numbers.maxCoeff() : 0) - low) + 1e-12));
  bytes.f32(low);
  bytes.f32(range);
  for (const double x : numbers.reshaped()) bytes.u16(quantize(x, low, range, number_bits));
}

MatrixXd read_levels(ByteReader& bytes, Index rows, Index columns) {
  const double low = bytes.f32(), range = bytes.f32();
  if (bytes.left() / 2 < static_cast<std::size_t>(rows * columns)) refuse_damaged("it ends too early");
  MatrixXd numbers(rows, columns);
  for (double& x : numbers.reshaped()) x = dequantize(bytes.u16(), low, range, number_bits);
  return numbers;
}

}  // namespace

PgaEncoder::PgaEncoder(const codec::Source& source) : source_(source), data_(motion_data(source)) {}

Bytes PgaEncoder::encode(double knob) {
  const double bound = knob * source_.size;
  return encode({.covered = 0, .residual_radians = knob, .way = 0.2 * bound, .expected = 0.05 * bound});
}

Bytes PgaEncoder::encode(const PgaSettings& settings, PgaCounts* counts) const {
  ByteWriter bytes;
  write_head(bytes, data_.head);
  if (data_.head.rows() == 0) return bytes.take();
  const motion::Skeleton& skeleton = source_.skeleton;
  const PgaRig rig = make_rig(skeleton, data_.head, source_.size);
  const Index span = std::max<Index>(2, std::lround(span_seconds * rate_of(data_.head)));
  bytes.f32(source_.size);
  write_roots(bytes, full_roots(rig, data_.clips), source_.size, span, settings.way);
  Index all = 0;
  for (const MatrixXd& values : data_.clips) all += values.cols();
  PgaModel model;
  model.means = intrinsic_means(skeleton, rig, data_.clips);
  model.still = VectorXd::Zero(data_.head.rows());
  MatrixXd tangents(3 * static_cast<Index>(rig.turning.size()), all);
  Index next = 0;
  for (const MatrixXd& values : data_.clips) {
    model.still += values.rowwise().sum() / static_cast<double>(all);
    for (Index n = 0; n < values.cols(); ++n, ++next)
      for (std::size_t j = 0; j < rig.turning.size(); ++j) {
        const glm::dvec3 v = motion::rotation_vector(glm::inverse(mean_of(skeleton, rig, model, j)) *
                                                     quaternion(values, rig.turning[j]->first, n));
        tangents.block<3, 1>(3 * static_cast<Index>(j), next) << v.x, v.y, v.z;
      }
  }
  Index axes = 0;
  if (!rig.turning.empty()) {
    // Geodesics pass through the means.
    PrincipalComponents pga = principal_components(tangents);
    const double joints = static_cast<double>(rig.turning.size());
    axes = std::min(most_axes, settings.covered > 0
                                   ? axes_for_share(pga, settings.covered)
                                   : axes_for_residual(pga, joints * std::pow(settings.residual_radians, 2)));
    model.axes = pga.axes.leftCols(axes) * pga.variances.head(axes).cwiseSqrt().asDiagonal();
  }
  ByteWriter numbers;
  numbers.count(static_cast<std::uint64_t>(axes));
  write_levels(numbers, model.means);
  for (const double x : model.still) numbers.f32(x);
  write_levels(numbers, model.axes);
  bytes.packed(numbers.bytes());
  CurveStreams streams;
  CurveCounts used;
  CurveSettings fit;
  fit.span = span;
  fit.threshold = settings.way;
  fit.expected = settings.expected;
  std::vector<MatrixXd> ends;
  for (const MatrixXd& values : data_.clips) {
    ends.emplace_back(3 * static_cast<Index>(rig.ends.size()), values.cols());
    for (Index n = 0; n < values.cols(); ++n)
      ends.back().col(n) = end_positions(skeleton, rig, world_of(skeleton, data_.head, values, n));
  }
  for (Index row = 0; row < 3 * static_cast<Index>(rig.ends.size()); ++row) {
    std::vector<VectorXd> curves;
    for (const MatrixXd& clip : ends) curves.push_back(clip.row(row).transpose());
    write_curves(streams, curves, fit, source_.size, used);
  }
  for (const ByteWriter* part : {&streams.ranges, &streams.points, &streams.small, &streams.large})
    bytes.packed(part->bytes());
  if (counts) *counts = {static_cast<int>(axes), static_cast<int>(rig.ends.size())};
  return bytes.take();
}

std::vector<motion::Clip> decode_pga_ik(std::span<const std::uint8_t> input, const motion::Skeleton& skeleton) {
  ByteReader bytes(input);
  const Head head = read_head(bytes, skeleton);
  std::vector<Index> frames;
  std::vector<MatrixXd> values;
  for (const std::vector<float>& times : head.times) {
    frames.push_back(static_cast<Index>(times.size()));
    values.emplace_back(MatrixXd::Zero(head.rows(), frames.back()));
  }
  if (head.rows() == 0) return to_clips(head, values);
  const double size = bytes.f32();
  if (!(size > 0)) refuse_damaged("the size is not positive");
  const PgaRig rig = make_rig(skeleton, head, size);
  const Index span = std::max<Index>(2, std::lround(span_seconds * rate_of(head)));
  const std::vector<RootMotion> roots = read_roots(bytes, frames);
  const Bytes number_bytes = bytes.packed();
  ByteReader numbers(number_bytes);
  PgaModel model;
  const auto joints = static_cast<Index>(rig.turning.size());
  const auto axes = static_cast<Index>(numbers.count(static_cast<std::uint64_t>(std::min(most_axes, 3 * joints))));
  model.means = read_levels(numbers, 3, joints);
  model.still.resize(head.rows());
  for (double& x : model.still) x = numbers.f32();
  model.axes = read_levels(numbers, 3 * joints, axes);
  numbers.expect_end();
  const Bytes parts[] = {bytes.packed(), bytes.packed(), bytes.packed(), bytes.packed()};
  CurveReaders readers{ByteReader(parts[0]), ByteReader(parts[1]), ByteReader(parts[2]), ByteReader(parts[3])};
  bytes.expect_end();
  std::vector<MatrixXd> ends;
  for (const Index count : frames) ends.emplace_back(3 * static_cast<Index>(rig.ends.size()), count);
  for (Index row = 0; row < 3 * static_cast<Index>(rig.ends.size()); ++row) {
    const std::vector<VectorXd> curves = read_curves(readers, frames, span);
    for (std::size_t c = 0; c < frames.size(); ++c) ends[c].row(row) = curves[c].transpose();
  }
  for (std::size_t c = 0; c < frames.size(); ++c) {
    VectorXd coefficients = VectorXd::Zero(axes);
    for (Index n = 0; n < frames[c]; ++n) {
      values[c].col(n) = model.still;
      place_root(skeleton, head, rig, roots[c], values[c], n);
      coefficients = solve(skeleton, head, rig, model, ends[c].col(n), coefficients, size, values[c], n);
    }
  }
  return to_clips(head, values);
}

std::unique_ptr<Encoder> prepare_pga_ik(const codec::Source& source, const EncodeSettings&) {
  return std::make_unique<PgaEncoder>(source);
}

}  // namespace nmc::baselines
