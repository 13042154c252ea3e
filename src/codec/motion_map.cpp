#include "codec/motion_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"

namespace nmc::codec {
namespace {

glm::dmat3 cross_matrix(const glm::dvec3& v) { return {{0, v.z, -v.y}, {-v.z, 0, v.x}, {v.y, -v.x, 0}}; }

/// How a change of a rotation vector turns the body: exp(v + d) = exp(v) exp(J d) to first order, with q = exp(v).
glm::dmat3 right_jacobian(const glm::dvec3& v, const glm::dquat& q) {
  const double angle = glm::length(v), square = angle * angle, half_sine = glm::length(glm::dvec3(q.x, q.y, q.z));
  const double a = angle > 1e-4 ? 2 * half_sine * half_sine / square : 0.5 - square / 24;
  const double b = angle > 1e-4 ? (angle - 2 * half_sine * q.w) / (square * angle) : 1.0 / 6 - square / 120;
  const glm::dmat3 k = cross_matrix(v);
  return glm::dmat3(1.0) - a * k + b * (k * k);
}

/// Without its size. A mirroring matrix turns the other way round: the signed cube root of the determinant takes care
/// of it.
glm::dmat3 unscaled(const glm::dmat3& linear) {
  const double volume = glm::determinant(linear);
  if (std::abs(volume - 1) < 1e-9) return linear;
  const double size = std::cbrt(volume);
  return std::abs(size) > 1e-12 ? linear / size : glm::dmat3(1.0);
}

double row_value(const ConstValues& values, int first, int a, Eigen::Index n) { return values(first + a, n); }

}  // namespace

MotionMap::Property MotionMap::add_property(const LayoutBlock* block, bool all, Eigen::Index rows) {
  Property property;
  if (!block) return property;
  property.free = all ? block->block.first : block->first_moving;
  property.value = block->block.first;
  property.width = block->block.width;
  property.target = block->target;
  property.row = row_count_;
  row_count_ += rows;
  return property;
}

MotionMap::MotionMap(const motion::Skeleton& skeleton, const SetFrame& frame, const ClipLayout& layout,
                     const Points& points, const Eigen::MatrixXd& fixed, FreeParameters free)
    : rest_(skeleton.rest), frame_(&frame) {
  const bool all = free == FreeParameters::all;
  free_count_ = static_cast<Eigen::Index>(all ? layout.parameters.size() : layout.moving.size());
  const std::size_t nodes = skeleton.size();
  std::vector<const LayoutBlock*> rotations(nodes), translations(nodes), scales(nodes), weights(nodes);
  std::vector<bool> held(nodes);
  for (const LayoutBlock& block : layout.blocks) {
    const NodeTarget& target = frame.targets[block.target];
    const auto node = static_cast<std::size_t>(target.node);
    if (all || block.state != State::fixed) {
      (target.path == Path::rotation      ? rotations
       : target.path == Path::translation ? translations
       : target.path == Path::scale       ? scales
                                          : weights)[node] = &block;
      continue;
    }
    if (target.path == Path::weights) continue;
    held[node] = true;
    const auto at = [&](int a) { return fixed(block.block.first + a, 0); };
    if (target.path == Path::rotation) {
      rest_[node].rotation = frame.rotation_reference[block.target] * motion::rotation_of_vector({at(0), at(1), at(2)});
      continue;
    }
    glm::dvec3& value = target.path == Path::translation ? rest_[node].translation : rest_[node].scale;
    for (int a = 0; a < 3; ++a) value[a] = frame.value_reference[block.target][static_cast<std::size_t>(a)] + at(a);
  }
  // A node without free parameters moves with the nearest mover above: above[node] is that mover, chain[node] leads
  // from it to the node.
  std::vector<int> above(nodes, -1);
  std::vector<glm::dmat4> chain(nodes, glm::dmat4(1.0));
  for (const int index : skeleton.order) {
    const auto node = static_cast<std::size_t>(index);
    const int parent = skeleton.parent[node];
    const int over = parent < 0 ? -1 : above[static_cast<std::size_t>(parent)];
    const glm::dmat4 before = parent < 0 ? glm::dmat4(1.0) : chain[static_cast<std::size_t>(parent)];
    if (!rotations[node] && !translations[node] && !scales[node]) {
      above[node] = over;
      chain[node] = before * (held[node] ? motion::to_matrix(rest_[node]) : skeleton.rest_matrix[node]);
      continue;
    }
    Mover mover;
    mover.node = index;
    mover.parent = over;
    mover.chain = before;
    mover.has_chain = before != glm::dmat4(1.0);
    mover.offset_row = row_count_;
    row_count_ += 3;
    mover.rotation = add_property(rotations[node], all, rotations[node] ? 3 * rotations[node]->block.width : 0);
    mover.translation = add_property(translations[node], all, 9);
    mover.scale = add_property(scales[node], all, 12);
    stretches_ = stretches_ || scales[node];
    above[node] = static_cast<int>(movers_.size());
    chain[node] = glm::dmat4(1.0);
    movers_.push_back(mover);
  }
  first_.push_back(0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::uint32_t k = points.first[i]; k < points.first[i + 1]; ++k) {
      const Influence& influence = points.influences[k];
      const auto node = static_cast<std::size_t>(influence.node);
      const glm::dvec4 offset =
          chain[node] * glm::dvec4(influence.offset[0], influence.offset[1], influence.offset[2], 1.0);
      shares_.push_back({above[node], influence.weight * offset, row_count_});
      if (above[node] >= 0) row_count_ += 3;
    }
    first_.push_back(shares_.size());
  }
  for (const MorphReach& morph : points.morphs)
    if (const LayoutBlock* block = weights[static_cast<std::size_t>(morph.node)];
        block && morph.target < block->block.width)
      morphs_.push_back({(all ? block->block.first : block->first_moving) + morph.target,
                         block->block.first + morph.target, morph.reach});
}

void MotionMap::turn(const Mover& mover, const ConstValues& values, Eigen::Index n, MoverPose& pose) const {
  const auto at = [&](int a) { return row_value(values, mover.rotation.value, a, n); };
  if (mover.rotation.free < 0) {
    pose.rotation = rest_[static_cast<std::size_t>(mover.node)].rotation;
  } else if (mover.rotation.width == 4) {
    const glm::dquat q(at(3), at(0), at(1), at(2));
    pose.rotation = glm::length(q) > 1e-12 ? glm::normalize(q) : glm::dquat(1, 0, 0, 0);
  } else {
    pose.change = motion::rotation_of_vector({at(0), at(1), at(2)});
    pose.rotation = frame_->rotation_reference[mover.rotation.target] * pose.change;
  }
}

void MotionMap::pose(const ConstValues& values, Eigen::Index n, std::vector<MoverPose>& poses) const {
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    const Mover& mover = movers_[i];
    MoverPose& pose = poses[i];
    turn(mover, values, n, pose);
    motion::Transform local = rest_[static_cast<std::size_t>(mover.node)];
    local.rotation = pose.rotation;
    for (int a = 0; a < 3; ++a) {
      const auto k = static_cast<std::size_t>(a);
      if (mover.translation.free >= 0)
        local.translation[a] =
            frame_->value_reference[mover.translation.target][k] + row_value(values, mover.translation.value, a, n);
      if (mover.scale.free >= 0)
        local.scale[a] = frame_->value_reference[mover.scale.target][k] + row_value(values, mover.scale.value, a, n);
    }
    if (mover.parent < 0)
      pose.above = mover.chain;
    else if (mover.has_chain)
      pose.above = poses[static_cast<std::size_t>(mover.parent)].world * mover.chain;
    else
      pose.above = poses[static_cast<std::size_t>(mover.parent)].world;
    pose.world = pose.above * motion::to_matrix(local);
  }
}

Rows MotionMap::positions(const ConstValues& values, int threads) const {
  Rows out(error_rows(), values.cols());
  parallel_for(static_cast<std::size_t>(blocks_of(values.cols())), threads, [&](std::size_t block) {
    const Eigen::Index first = static_cast<Eigen::Index>(block) * lanes;
    positions(values, first, std::min(values.cols(), first + lanes), out);
  });
  return out;
}

void MotionMap::positions(const ConstValues& values, Eigen::Index first, Eigen::Index end, Rows& out) const {
  std::vector<MoverPose> poses(movers_.size());
  for (Eigen::Index n = first; n < end; ++n) {
    pose(values, n, poses);
    for (Eigen::Index i = 0; i < point_count(); ++i) {
      glm::dvec3 p(0.0);
      for (std::size_t k = first_[static_cast<std::size_t>(i)]; k < first_[static_cast<std::size_t>(i) + 1]; ++k)
        p += glm::dvec3(shares_[k].mover < 0
                            ? shares_[k].offset
                            : poses[static_cast<std::size_t>(shares_[k].mover)].world * shares_[k].offset);
      for (int a = 0; a < 3; ++a) out(3 * i + a, n) = static_cast<float>(p[a]);
    }
    for (std::size_t m = 0; m < morphs_.size(); ++m)
      out(3 * point_count() + static_cast<Eigen::Index>(m), n) =
          static_cast<float>(morphs_[m].reach * values(morphs_[m].value, n));
  }
}

void MotionMap::linearise_rotation(const Mover& mover, const MoverPose& pose, const glm::dmat3& above,
                                   const ConstValues& values, Eigen::Index block, Eigen::Index lane) {
  const glm::dmat3 turn = above * glm::mat3_cast(pose.rotation);
  const auto at = [&](int a) { return row_value(values, mover.rotation.value, a, lane); };
  if (mover.rotation.width == 3) {
    const glm::dmat3 map = turn * right_jacobian({at(0), at(1), at(2)}, pose.change);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) entry(mover.rotation.row + 3 * b + a, block, lane) = static_cast<float>(map[b][a]);
    return;
  }
  const double x = at(0), y = at(1), z = at(2), w = at(3);
  // A pose half-way between two may have next to no quaternion left: the map there means nothing, and should not be
  // huge.
  constexpr double least_square = 0.1;
  const double f = 2 / std::max(least_square, x * x + y * y + z * z + w * w);
  const glm::dvec3 body[4] = {
      {f * w, f * -z, f * y}, {f * z, f * w, f * -x}, {f * -y, f * x, f * w}, {f * -x, f * -y, f * -z}};
  for (int b = 0; b < 4; ++b) {
    const glm::dvec3 column = turn * body[b];
    for (int a = 0; a < 3; ++a) entry(mover.rotation.row + 3 * b + a, block, lane) = static_cast<float>(column[a]);
  }
}

void MotionMap::forget() {
  samples_ = 0;
  rows_.resize(lanes, 0);
}

void MotionMap::resize(Eigen::Index samples) {
  samples_ = samples;
  rows_.setZero(lanes, row_count_ * block_count());
}

void MotionMap::linearise(const ConstValues& values, int threads) {
  resize(values.cols());
  parallel_for(static_cast<std::size_t>(block_count()), threads, [&](std::size_t block) {
    const Eigen::Index first = static_cast<Eigen::Index>(block) * lanes;
    linearise_block(values.middleCols(first, std::min(lanes, samples_ - first)), static_cast<Eigen::Index>(block));
  });
}

void MotionMap::linearise_block(const ConstValues& values, Eigen::Index block) {
  std::vector<MoverPose> poses(movers_.size());
  for (Eigen::Index lane = 0; lane < values.cols(); ++lane) {
    pose(values, lane, poses);
    for (std::size_t i = 0; i < movers_.size(); ++i) {
      const Mover& mover = movers_[i];
      const glm::dvec3 origin(poses[i].world[3]);
      const glm::dvec3 from =
          mover.parent < 0 ? glm::dvec3(0.0) : glm::dvec3(poses[static_cast<std::size_t>(mover.parent)].world[3]);
      for (int a = 0; a < 3; ++a) entry(mover.offset_row + a, block, lane) = static_cast<float>(origin[a] - from[a]);
      const glm::dmat3 linear(poses[i].above), turn = unscaled(linear);
      if (mover.rotation.free >= 0) linearise_rotation(mover, poses[i], turn, values, block, lane);
      if (mover.translation.free >= 0)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b)
            entry(mover.translation.row + 3 * b + a, block, lane) = static_cast<float>(linear[b][a]);
      if (mover.scale.free >= 0) {
        const glm::dmat3 axes = turn * glm::mat3_cast(poses[i].rotation);
        for (int b = 0; b < 3; ++b) {
          for (int a = 0; a < 3; ++a) entry(mover.scale.row + 3 * b + a, block, lane) = static_cast<float>(axes[b][a]);
          const double s = frame_->value_reference[mover.scale.target][static_cast<std::size_t>(b)] +
                           row_value(values, mover.scale.value, b, lane);
          entry(mover.scale.row + 9 + b, block, lane) =
              static_cast<float>(1.0 / (s < 0 ? std::min(s, -1e-3) : std::max(s, 1e-3)));
        }
      }
    }
    for (const Share& share : shares_) {
      if (share.mover < 0) continue;
      const glm::dmat4& m = poses[static_cast<std::size_t>(share.mover)].world;
      const glm::dvec3 arm = glm::dvec3(m * share.offset) - share.offset.w * glm::dvec3(m[3]);
      for (int a = 0; a < 3; ++a) entry(share.row + a, block, lane) = static_cast<float>(arm[a]);
    }
  }
}

/// What a mover's own parameters and its parent's motion make of its origin's velocity (3 numbers), its turning (3) and
/// its stretching (9).
void MotionMap::move(std::size_t i, Eigen::Index block, const LaneRows& delta, LaneRows& state) const {
  const Mover& mover = movers_[i];
  const Eigen::Index width = state_width(), s = width * static_cast<Eigen::Index>(i);
  const auto at = [&](Eigen::Index r) { return row(block, r); };
  if (mover.parent < 0) {
    state.middleCols(s, width).setZero();
  } else {
    const Eigen::Index p = width * mover.parent, r = mover.offset_row;
    state.col(s + 0) = state.col(p + 0) + state.col(p + 4) * at(r + 2) - state.col(p + 5) * at(r + 1);
    state.col(s + 1) = state.col(p + 1) + state.col(p + 5) * at(r + 0) - state.col(p + 3) * at(r + 2);
    state.col(s + 2) = state.col(p + 2) + state.col(p + 3) * at(r + 1) - state.col(p + 4) * at(r + 0);
    state.middleCols(s + 3, 3) = state.middleCols(p + 3, 3);
    if (stretches_) {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) state.col(s + a) += state.col(p + 6 + 3 * b + a) * at(r + b);
      state.middleCols(s + 6, 9) = state.middleCols(p + 6, 9);
    }
  }
  if (mover.translation.free >= 0)
    for (int b = 0; b < 3; ++b)
      for (int a = 0; a < 3; ++a)
        state.col(s + a) += at(mover.translation.row + 3 * b + a) * delta.col(mover.translation.free + b);
  if (mover.rotation.free >= 0)
    for (int b = 0; b < mover.rotation.width; ++b)
      for (int a = 0; a < 3; ++a)
        state.col(s + 3 + a) += at(mover.rotation.row + 3 * b + a) * delta.col(mover.rotation.free + b);
  if (mover.scale.free >= 0)
    for (int k = 0; k < 3; ++k)
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a)
          state.col(s + 6 + 3 * b + a) += delta.col(mover.scale.free + k) * at(mover.scale.row + 9 + k) *
                                          at(mover.scale.row + 3 * k + a) * at(mover.scale.row + 3 * k + b);
}

void MotionMap::point_error(Eigen::Index point, Eigen::Index block, const LaneRows& state, LaneRows& error) const {
  const auto at = [&](Eigen::Index r) { return row(block, r); };
  Lanes x = Lanes::Zero(), y = x, z = x;
  for (std::size_t k = first_[static_cast<std::size_t>(point)]; k < first_[static_cast<std::size_t>(point) + 1]; ++k) {
    const Share& share = shares_[k];
    if (share.mover < 0) continue;
    const Eigen::Index s = state_width() * share.mover, c = share.row;
    const auto w = static_cast<float>(share.offset.w);
    const Lanes arm_x = at(c), arm_y = at(c + 1), arm_z = at(c + 2);
    x += w * state.col(s + 0) + state.col(s + 4) * arm_z - state.col(s + 5) * arm_y;
    y += w * state.col(s + 1) + state.col(s + 5) * arm_x - state.col(s + 3) * arm_z;
    z += w * state.col(s + 2) + state.col(s + 3) * arm_y - state.col(s + 4) * arm_x;
    if (!stretches_) continue;
    const Eigen::Index t = s + 6;
    x += state.col(t + 0) * arm_x + state.col(t + 3) * arm_y + state.col(t + 6) * arm_z;
    y += state.col(t + 1) * arm_x + state.col(t + 4) * arm_y + state.col(t + 7) * arm_z;
    z += state.col(t + 2) * arm_x + state.col(t + 5) * arm_y + state.col(t + 8) * arm_z;
  }
  error.col(0) = x;
  error.col(1) = y;
  error.col(2) = z;
}

/// The transpose of point_error.
void MotionMap::pull(Eigen::Index point, Eigen::Index block, const LaneRows& weight, LaneRows& state) const {
  const auto at = [&](Eigen::Index r) { return row(block, r); };
  const Lanes x = weight.col(0), y = weight.col(1), z = weight.col(2);
  for (std::size_t k = first_[static_cast<std::size_t>(point)]; k < first_[static_cast<std::size_t>(point) + 1]; ++k) {
    const Share& share = shares_[k];
    if (share.mover < 0) continue;
    const Eigen::Index s = state_width() * share.mover, c = share.row;
    const auto w = static_cast<float>(share.offset.w);
    const Lanes arm_x = at(c), arm_y = at(c + 1), arm_z = at(c + 2);
    state.col(s + 0) += w * x;
    state.col(s + 1) += w * y;
    state.col(s + 2) += w * z;
    state.col(s + 3) += arm_y * z - arm_z * y;
    state.col(s + 4) += arm_z * x - arm_x * z;
    state.col(s + 5) += arm_x * y - arm_y * x;
    if (!stretches_) continue;
    for (int b = 0; b < 3; ++b) {
      const Lanes arm = at(c + b);
      state.col(s + 6 + 3 * b) += x * arm;
      state.col(s + 7 + 3 * b) += y * arm;
      state.col(s + 8 + 3 * b) += z * arm;
    }
  }
}

/// The transpose of move over all movers: what pulls at them becomes a gradient of their parameters.
void MotionMap::settle(Eigen::Index block, LaneRows& state, LaneRows& gradient) const {
  const auto at = [&](Eigen::Index r) { return row(block, r); };
  for (std::size_t i = movers_.size(); i-- > 0;) {
    const Mover& mover = movers_[i];
    const Eigen::Index s = state_width() * static_cast<Eigen::Index>(i);
    if (mover.translation.free >= 0)
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a)
          gradient.col(mover.translation.free + b) += at(mover.translation.row + 3 * b + a) * state.col(s + a);
    if (mover.rotation.free >= 0)
      for (int b = 0; b < mover.rotation.width; ++b)
        for (int a = 0; a < 3; ++a)
          gradient.col(mover.rotation.free + b) += at(mover.rotation.row + 3 * b + a) * state.col(s + 3 + a);
    if (mover.scale.free >= 0)
      for (int k = 0; k < 3; ++k)
        for (int b = 0; b < 3; ++b)
          for (int a = 0; a < 3; ++a)
            gradient.col(mover.scale.free + k) += state.col(s + 6 + 3 * b + a) * at(mover.scale.row + 9 + k) *
                                                  at(mover.scale.row + 3 * k + a) * at(mover.scale.row + 3 * k + b);
    if (mover.parent < 0) continue;
    const Eigen::Index p = state_width() * mover.parent, r = mover.offset_row;
    state.middleCols(p, 6) += state.middleCols(s, 6);
    state.col(p + 3) += at(r + 1) * state.col(s + 2) - at(r + 2) * state.col(s + 1);
    state.col(p + 4) += at(r + 2) * state.col(s + 0) - at(r + 0) * state.col(s + 2);
    state.col(p + 5) += at(r + 0) * state.col(s + 1) - at(r + 1) * state.col(s + 0);
    if (stretches_) {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) state.col(p + 6 + 3 * b + a) += state.col(s + a) * at(r + b);
      state.middleCols(p + 6, 9) += state.middleCols(s + 6, 9);
    }
  }
}

namespace {

/// The part of a block of samples that lies within `count` columns of a matrix whose first column is sample `from`.
struct Overlap {
  Eigen::Index lane = 0, column = 0, size = 0;
};

Overlap overlap(Eigen::Index block, Eigen::Index from, Eigen::Index count) {
  const Eigen::Index begin = std::max(block * lanes, from), end = std::min((block + 1) * lanes, from + count);
  return {begin - block * lanes, begin - from, end - begin};
}

void load(const Rows& from, const Overlap& part, LaneRows& to) {
  to.resize(lanes, from.rows());
  if (part.size < lanes) to.setZero();
  for (Eigen::Index r = 0; r < from.rows(); ++r)
    to.col(r).segment(part.lane, part.size) = from.row(r).segment(part.column, part.size).transpose();
}

/// The largest weight of a squared error, and how much of it counts in the mean that rates are weighed against: a few
/// peaks should be lowered, not make all bits dear.
constexpr float most_weight = 100.0f, most_counted = 2.0f;

Lanes weight_of(const Lanes& square, int power) {
  if (power == 2) return Lanes::Constant(1.05f);
  if (power == 4) return square.min(most_weight) + 0.05f;
  return (square * square).min(most_weight) + 0.05f;
}

}  // namespace

void MotionMap::errors(const Rows& delta, Rows& error, Eigen::Index from) const {
  error.resize(error_rows(), delta.cols());
  LaneRows moves, state(lanes, state_width() * static_cast<Eigen::Index>(movers_.size())), e(lanes, 3);
  for (Eigen::Index block = from / lanes; block * lanes < from + delta.cols(); ++block) {
    const Overlap part = overlap(block, from, delta.cols());
    load(delta, part, moves);
    for (std::size_t i = 0; i < movers_.size(); ++i) move(i, block, moves, state);
    for (Eigen::Index q = 0; q < point_count(); ++q) {
      point_error(q, block, state, e);
      for (int a = 0; a < 3; ++a)
        error.row(3 * q + a).segment(part.column, part.size) = e.col(a).segment(part.lane, part.size).transpose();
    }
  }
  for (std::size_t m = 0; m < morphs_.size(); ++m)
    error.row(3 * point_count() + static_cast<Eigen::Index>(m)) =
        static_cast<float>(morphs_[m].reach) * delta.row(morphs_[m].free);
}

void MotionMap::gradient(const Rows& weight, Rows& gradient, Eigen::Index from) const {
  gradient.setZero(free_count_, weight.cols());
  LaneRows weights, state(lanes, state_width() * static_cast<Eigen::Index>(movers_.size())), e(lanes, 3), found;
  for (Eigen::Index block = from / lanes; block * lanes < from + weight.cols(); ++block) {
    const Overlap part = overlap(block, from, weight.cols());
    load(weight, part, weights);
    state.setZero();
    for (Eigen::Index q = 0; q < point_count(); ++q) {
      e = weights.middleCols(3 * q, 3);
      if ((e == 0).all()) continue;
      pull(q, block, e, state);
    }
    found.setZero(lanes, free_count_);
    settle(block, state, found);
    for (Eigen::Index i = 0; i < free_count_; ++i)
      gradient.row(i).segment(part.column, part.size) = found.col(i).segment(part.lane, part.size).transpose();
  }
  for (std::size_t m = 0; m < morphs_.size(); ++m)
    gradient.row(morphs_[m].free) +=
        static_cast<float>(morphs_[m].reach) * weight.row(3 * point_count() + static_cast<Eigen::Index>(m));
}

LaneRows in_blocks(const Rows& rows) {
  const Eigen::Index blocks = blocks_of(rows.cols());
  LaneRows out = LaneRows::Zero(lanes, blocks * rows.rows());
  for (Eigen::Index block = 0; block < blocks; ++block) {
    const Overlap part = overlap(block, 0, rows.cols());
    for (Eigen::Index r = 0; r < rows.rows(); ++r)
      out.col(block * rows.rows() + r).head(part.size) = rows.row(r).segment(part.column, part.size).transpose();
  }
  return out;
}

Focus MotionMap::focus(const Rows& delta, const LaneRows& offset, double tolerance, int threads) const {
  constexpr float near = 0.25f;  // of the squared tolerance
  constexpr int others = 4;
  const auto limit = near * static_cast<float>(tolerance * tolerance);
  Focus focus;
  focus.blocks.resize(static_cast<std::size_t>(block_count()));
  parallel_for(focus.blocks.size(), threads, [&](std::size_t b) {
    const auto block = static_cast<Eigen::Index>(b);
    const Overlap part = overlap(block, 0, samples_);
    LaneRows moves, state(lanes, state_width() * static_cast<Eigen::Index>(movers_.size())), e(lanes, 3);
    load(delta, part, moves);
    for (std::size_t i = 0; i < movers_.size(); ++i) move(i, block, moves, state);
    int passed = 0;
    for (Eigen::Index q = 0; q < point_count(); ++q) {
      point_error(q, block, state, e);
      e += offset.middleCols(block * error_rows() + 3 * q, 3);
      if (e.square().rowwise().sum().maxCoeff() > limit)
        focus.blocks[b].push_back({q, 1});
      else if (passed++ % others == 0)
        focus.blocks[b].push_back({q, others});
    }
  });
  return focus;
}

double MotionMap::descend_block(Eigen::Index block, const Rows& delta, const LaneRows& offset, const PointLoss& loss,
                                const Focus* focus, Rows& gradient) const {
  const Overlap part = overlap(block, 0, samples_);
  const auto unit = static_cast<float>(1.0 / (loss.tolerance * loss.tolerance));
  const auto width = state_width() * static_cast<Eigen::Index>(movers_.size());
  LaneRows moves, state(lanes, width), pulls = LaneRows::Zero(lanes, width), e(lanes, 3),
                                       found = LaneRows::Zero(lanes, free_count_);
  load(delta, part, moves);
  for (std::size_t i = 0; i < movers_.size(); ++i) move(i, block, moves, state);
  double sum = 0;
  const auto weigh = [&](const Lanes& square, Eigen::Index row, float count) {
    Lanes weight = count * weight_of(square * unit, loss.power);
    sum += static_cast<double>(weight.head(part.size).min(count * most_counted).sum());
    if (loss.emphasis) weight *= loss.emphasis->col(block * seen_count() + row);
    return Lanes(2 * unit * weight);
  };
  const auto descend_point = [&](Eigen::Index q, float count) {
    point_error(q, block, state, e);
    e += offset.middleCols(block * error_rows() + 3 * q, 3);
    const Lanes weight = weigh(e.square().rowwise().sum(), q, count);
    for (int a = 0; a < 3; ++a) e.col(a) *= weight;
    pull(q, block, e, pulls);
  };
  if (focus)
    for (const Focus::Seen& seen : focus->blocks[static_cast<std::size_t>(block)])
      descend_point(seen.point, seen.count);
  else
    for (Eigen::Index q = 0; q < point_count(); ++q) descend_point(q, 1);
  settle(block, pulls, found);
  for (std::size_t m = 0; m < morphs_.size(); ++m) {
    const Eigen::Index q = point_count() + static_cast<Eigen::Index>(m);
    const auto reach = static_cast<float>(morphs_[m].reach);
    Lanes error = reach * moves.col(morphs_[m].free);
    error += offset.col(block * error_rows() + first_row(q));
    found.col(morphs_[m].free) += reach * error * weigh(error.square(), q, 1);
  }
  for (Eigen::Index i = 0; i < free_count_; ++i)
    gradient.row(i).segment(part.column, part.size) = found.col(i).head(part.size).transpose();
  return sum;
}

double MotionMap::descend(const Rows& delta, const LaneRows& offset, const PointLoss& loss, const Focus* focus,
                          int threads, Rows& gradient) const {
  gradient.resize(free_count_, samples_);
  std::vector<double> sums(static_cast<std::size_t>(block_count()));
  parallel_for(sums.size(), threads, [&](std::size_t b) {
    sums[b] = descend_block(static_cast<Eigen::Index>(b), delta, offset, loss, focus, gradient);
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0) / static_cast<double>(samples_);
}

Effect MotionMap::effect(Eigen::Index parameter, const BlockRange& blocks) const {
  const auto holds = [&](const Property& property) {
    return property.free >= 0 && parameter >= property.free && parameter < property.free + property.width;
  };
  std::vector<bool> moved(movers_.size());
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    const Mover& mover = movers_[i];
    moved[i] = holds(mover.rotation) || holds(mover.translation) || holds(mover.scale) ||
               (mover.parent >= 0 && moved[static_cast<std::size_t>(mover.parent)]);
  }
  Effect effect;
  effect.blocks = blocks;
  for (Eigen::Index q = 0; q < point_count(); ++q) {
    const auto first = shares_.begin() + static_cast<std::ptrdiff_t>(first_[static_cast<std::size_t>(q)]),
               last = shares_.begin() + static_cast<std::ptrdiff_t>(first_[static_cast<std::size_t>(q) + 1]);
    if (std::any_of(first, last,
                    [&](const Share& s) { return s.mover >= 0 && moved[static_cast<std::size_t>(s.mover)]; }))
      effect.points.push_back(q);
  }
  const std::size_t points = effect.points.size();
  for (std::size_t m = 0; m < morphs_.size(); ++m)
    if (morphs_[m].free == parameter) effect.points.push_back(point_count() + static_cast<Eigen::Index>(m));
  effect.values.setZero(lanes, effect.column(0, blocks.count));
  LaneRows moves = LaneRows::Zero(lanes, free_count_),
           state = LaneRows::Zero(lanes, state_width() * static_cast<Eigen::Index>(movers_.size())), e(lanes, 3);
  for (Eigen::Index b = 0; b < blocks.count; ++b) {
    const Eigen::Index block = blocks.first + b, inside = std::min(lanes, samples_ - block * lanes);
    moves.col(parameter).setZero();
    moves.col(parameter).head(inside).setOnes();
    for (std::size_t i = 0; i < movers_.size(); ++i)
      if (moved[i]) move(i, block, moves, state);
    for (std::size_t k = 0; k < points; ++k) {
      point_error(effect.points[k], block, state, e);
      effect.values.middleCols(effect.column(k, b), 3) = e;
    }
    for (std::size_t k = points; k < effect.points.size(); ++k) {
      const auto reach = morphs_[static_cast<std::size_t>(effect.points[k] - point_count())].reach;
      effect.values.col(effect.column(k, b)).head(inside).setConstant(static_cast<float>(reach));
    }
  }
  return effect;
}

Eigen::VectorXd MotionMap::reach() const {
  Eigen::VectorXd reach(free_count_);
  for (Eigen::Index i = 0; i < free_count_; ++i) {
    const Effect unit = effect(i, {0, block_count()});
    double sum = 0;
    for (Eigen::Index b = 0; b < unit.blocks.count; ++b) {
      Lanes most = Lanes::Zero();
      for (std::size_t k = 0; k < unit.points.size(); ++k)
        most = most.max(unit.values.middleCols<3>(unit.column(k, b)).square().rowwise().sum());
      sum += static_cast<double>(most.sum());
    }
    reach(i) = std::sqrt(sum / static_cast<double>(samples_));
  }
  return reach;
}

}  // namespace nmc::codec
