#include "codec/motion_map.h"

#include <algorithm>
#include <cmath>

namespace nmc::codec {
namespace {

glm::dmat3 cross_matrix(const glm::dvec3& v) { return {{0, v.z, -v.y}, {-v.z, 0, v.x}, {v.y, -v.x, 0}}; }

/// How a change of a rotation vector turns the body: exp(v + d) = exp(v) exp(J d) to first order.
glm::dmat3 right_jacobian(const glm::dvec3& v) {
  const double angle = glm::length(v), square = angle * angle;
  const double a = angle > 1e-4 ? (1 - std::cos(angle)) / square : 0.5 - square / 24;
  const double b = angle > 1e-4 ? (angle - std::sin(angle)) / (square * angle) : 1.0 / 6 - square / 120;
  const glm::dmat3 k = cross_matrix(v);
  return glm::dmat3(1.0) - a * k + b * (k * k);
}

double row_value(const Eigen::MatrixXd& values, int first, int a, Eigen::Index n) { return values(first + a, n); }

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

glm::dquat MotionMap::rotation(const Mover& mover, const Eigen::MatrixXd& values, Eigen::Index n) const {
  const auto at = [&](int a) { return row_value(values, mover.rotation.value, a, n); };
  if (mover.rotation.width == 4) {
    const glm::dquat q(at(3), at(0), at(1), at(2));
    return glm::length(q) > 1e-12 ? glm::normalize(q) : glm::dquat(1, 0, 0, 0);
  }
  return frame_->rotation_reference[mover.rotation.target] * motion::rotation_of_vector({at(0), at(1), at(2)});
}

void MotionMap::world(const Eigen::MatrixXd& values, Eigen::Index n, std::vector<glm::dmat4>& world) const {
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    const Mover& mover = movers_[i];
    motion::Transform local = rest_[static_cast<std::size_t>(mover.node)];
    if (mover.rotation.free >= 0) local.rotation = rotation(mover, values, n);
    for (int a = 0; a < 3; ++a) {
      const auto k = static_cast<std::size_t>(a);
      if (mover.translation.free >= 0)
        local.translation[a] =
            frame_->value_reference[mover.translation.target][k] + row_value(values, mover.translation.value, a, n);
      if (mover.scale.free >= 0)
        local.scale[a] = frame_->value_reference[mover.scale.target][k] + row_value(values, mover.scale.value, a, n);
    }
    const glm::dmat4 above =
        mover.parent < 0 ? mover.chain : world[static_cast<std::size_t>(mover.parent)] * mover.chain;
    world[i] = above * motion::to_matrix(local);
  }
}

Rows MotionMap::positions(const Eigen::MatrixXd& values) const {
  Rows out(error_rows(), values.cols());
  std::vector<glm::dmat4> world_of(movers_.size());
  for (Eigen::Index n = 0; n < values.cols(); ++n) {
    world(values, n, world_of);
    for (Eigen::Index i = 0; i < point_count(); ++i) {
      glm::dvec3 p(0.0);
      for (std::size_t k = first_[static_cast<std::size_t>(i)]; k < first_[static_cast<std::size_t>(i) + 1]; ++k)
        p +=
            glm::dvec3(shares_[k].mover < 0 ? shares_[k].offset
                                            : world_of[static_cast<std::size_t>(shares_[k].mover)] * shares_[k].offset);
      for (int a = 0; a < 3; ++a) out(3 * i + a, n) = static_cast<float>(p[a]);
    }
    for (std::size_t m = 0; m < morphs_.size(); ++m)
      out(3 * point_count() + static_cast<Eigen::Index>(m), n) =
          static_cast<float>(morphs_[m].reach * values(morphs_[m].value, n));
  }
  return out;
}

void MotionMap::linearise_rotation(const Mover& mover, const glm::dmat3& above, const Eigen::MatrixXd& values,
                                   Eigen::Index n) {
  const glm::dmat3 turn = above * glm::mat3_cast(rotation(mover, values, n));
  const auto at = [&](int a) { return row_value(values, mover.rotation.value, a, n); };
  if (mover.rotation.width == 3) {
    const glm::dmat3 map = turn * right_jacobian({at(0), at(1), at(2)});
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) rows_(mover.rotation.row + 3 * b + a, n) = static_cast<float>(map[b][a]);
    return;
  }
  const double x = at(0), y = at(1), z = at(2), w = at(3);
  const double f = 2 / std::max(1e-12, x * x + y * y + z * z + w * w);
  const glm::dvec3 body[4] = {
      {f * w, f * -z, f * y}, {f * z, f * w, f * -x}, {f * -y, f * x, f * w}, {f * -x, f * -y, f * -z}};
  for (int b = 0; b < 4; ++b) {
    const glm::dvec3 column = turn * body[b];
    for (int a = 0; a < 3; ++a) rows_(mover.rotation.row + 3 * b + a, n) = static_cast<float>(column[a]);
  }
}

void MotionMap::linearise(const Eigen::MatrixXd& values) {
  samples_ = values.cols();
  rows_.resize(row_count_, samples_);
  std::vector<glm::dmat4> world_of(movers_.size());
  for (Eigen::Index n = 0; n < samples_; ++n) {
    world(values, n, world_of);
    for (std::size_t i = 0; i < movers_.size(); ++i) {
      const Mover& mover = movers_[i];
      const glm::dmat4 over =
          mover.parent < 0 ? mover.chain : world_of[static_cast<std::size_t>(mover.parent)] * mover.chain;
      const glm::dvec3 origin(world_of[i][3]);
      const glm::dvec3 from =
          mover.parent < 0 ? glm::dvec3(0.0) : glm::dvec3(world_of[static_cast<std::size_t>(mover.parent)][3]);
      for (int a = 0; a < 3; ++a) rows_(mover.offset_row + a, n) = static_cast<float>(origin[a] - from[a]);
      const glm::dmat3 linear(over);
      const double size = std::cbrt(glm::determinant(linear));
      // A mirroring parent turns the other way round: the signed cube root of the determinant takes care of it.
      const glm::dmat3 turn = std::abs(size) > 1e-12 ? linear / size : glm::dmat3(1.0);
      if (mover.rotation.free >= 0) linearise_rotation(mover, turn, values, n);
      if (mover.translation.free >= 0)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) rows_(mover.translation.row + 3 * b + a, n) = static_cast<float>(linear[b][a]);
      if (mover.scale.free >= 0) {
        const glm::dmat3 axes =
            turn * glm::mat3_cast(mover.rotation.free >= 0 ? rotation(mover, values, n)
                                                           : rest_[static_cast<std::size_t>(mover.node)].rotation);
        for (int b = 0; b < 3; ++b) {
          for (int a = 0; a < 3; ++a) rows_(mover.scale.row + 3 * b + a, n) = static_cast<float>(axes[b][a]);
          const double s = frame_->value_reference[mover.scale.target][static_cast<std::size_t>(b)] +
                           row_value(values, mover.scale.value, b, n);
          rows_(mover.scale.row + 9 + b, n) =
              static_cast<float>(1.0 / (s < 0 ? std::min(s, -1e-3) : std::max(s, 1e-3)));
        }
      }
    }
    for (const Share& share : shares_) {
      if (share.mover < 0) continue;
      const glm::dmat4& m = world_of[static_cast<std::size_t>(share.mover)];
      const glm::dvec3 arm = glm::dvec3(m * share.offset) - share.offset.w * glm::dvec3(m[3]);
      for (int a = 0; a < 3; ++a) rows_(share.row + a, n) = static_cast<float>(arm[a]);
    }
  }
}

void MotionMap::errors(const Rows& delta, Rows& error, Eigen::Index from) const {
  const Eigen::Index width =
      stretches_ ? 15 : 6;  // per mover: origin's velocity, turning, and for stretches a full matrix
  const Eigen::Index count = delta.cols();
  Rows state(width * static_cast<Eigen::Index>(movers_.size()), count);
  const auto row = [&](Eigen::Index r) { return rows_.row(r).segment(from, count); };
  for (std::size_t i = 0; i < movers_.size(); ++i) {
    const Mover& mover = movers_[i];
    const Eigen::Index s = width * static_cast<Eigen::Index>(i);
    if (mover.parent < 0) {
      state.middleRows(s, width).setZero();
    } else {
      const Eigen::Index p = width * mover.parent;
      const Eigen::Index r = mover.offset_row;
      state.row(s + 0) = state.row(p + 0) + state.row(p + 4) * row(r + 2) - state.row(p + 5) * row(r + 1);
      state.row(s + 1) = state.row(p + 1) + state.row(p + 5) * row(r + 0) - state.row(p + 3) * row(r + 2);
      state.row(s + 2) = state.row(p + 2) + state.row(p + 3) * row(r + 1) - state.row(p + 4) * row(r + 0);
      state.middleRows(s + 3, 3) = state.middleRows(p + 3, 3);
      if (stretches_) {
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) state.row(s + a) += state.row(p + 6 + 3 * b + a) * row(r + b);
        state.middleRows(s + 6, 9) = state.middleRows(p + 6, 9);
      }
    }
    if (mover.translation.free >= 0)
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a)
          state.row(s + a) += row(mover.translation.row + 3 * b + a) * delta.row(mover.translation.free + b);
    if (mover.rotation.free >= 0)
      for (int b = 0; b < mover.rotation.width; ++b)
        for (int a = 0; a < 3; ++a)
          state.row(s + 3 + a) += row(mover.rotation.row + 3 * b + a) * delta.row(mover.rotation.free + b);
    if (mover.scale.free >= 0)
      for (int k = 0; k < 3; ++k)
        for (int b = 0; b < 3; ++b)
          for (int a = 0; a < 3; ++a)
            state.row(s + 6 + 3 * b + a) += delta.row(mover.scale.free + k) * row(mover.scale.row + 9 + k) *
                                            row(mover.scale.row + 3 * k + a) * row(mover.scale.row + 3 * k + b);
  }
  error.resize(error_rows(), count);
  for (Eigen::Index i = 0; i < point_count(); ++i) {
    error.middleRows(3 * i, 3).setZero();
    for (std::size_t k = first_[static_cast<std::size_t>(i)]; k < first_[static_cast<std::size_t>(i) + 1]; ++k) {
      const Share& share = shares_[k];
      if (share.mover < 0) continue;
      const Eigen::Index s = width * share.mover, c = share.row;
      const float w = static_cast<float>(share.offset.w);
      error.row(3 * i + 0) += w * state.row(s + 0) + state.row(s + 4) * row(c + 2) - state.row(s + 5) * row(c + 1);
      error.row(3 * i + 1) += w * state.row(s + 1) + state.row(s + 5) * row(c + 0) - state.row(s + 3) * row(c + 2);
      error.row(3 * i + 2) += w * state.row(s + 2) + state.row(s + 3) * row(c + 1) - state.row(s + 4) * row(c + 0);
      if (stretches_)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) error.row(3 * i + a) += state.row(s + 6 + 3 * b + a) * row(c + b);
    }
  }
  for (std::size_t m = 0; m < morphs_.size(); ++m)
    error.row(3 * point_count() + static_cast<Eigen::Index>(m)) =
        static_cast<float>(morphs_[m].reach) * delta.row(morphs_[m].free);
}

void MotionMap::gradient(const Rows& weight, Rows& gradient, Eigen::Index from) const {
  const Eigen::Index width = stretches_ ? 15 : 6;
  const Eigen::Index count = weight.cols();
  Rows state = Rows::Zero(width * static_cast<Eigen::Index>(movers_.size()), count);
  const auto row = [&](Eigen::Index r) { return rows_.row(r).segment(from, count); };
  for (Eigen::Index i = 0; i < point_count(); ++i) {
    const auto g = [&](int a) { return weight.row(3 * i + a); };
    for (std::size_t k = first_[static_cast<std::size_t>(i)]; k < first_[static_cast<std::size_t>(i) + 1]; ++k) {
      const Share& share = shares_[k];
      if (share.mover < 0) continue;
      const Eigen::Index s = width * share.mover, c = share.row;
      const float w = static_cast<float>(share.offset.w);
      for (int a = 0; a < 3; ++a) state.row(s + a) += w * g(a);
      state.row(s + 3) += row(c + 1) * g(2) - row(c + 2) * g(1);
      state.row(s + 4) += row(c + 2) * g(0) - row(c + 0) * g(2);
      state.row(s + 5) += row(c + 0) * g(1) - row(c + 1) * g(0);
      if (stretches_)
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b) state.row(s + 6 + 3 * b + a) += g(a) * row(c + b);
    }
  }
  gradient.setZero(free_count_, count);
  for (std::size_t i = movers_.size(); i-- > 0;) {
    const Mover& mover = movers_[i];
    const Eigen::Index s = width * static_cast<Eigen::Index>(i);
    if (mover.translation.free >= 0)
      for (int b = 0; b < 3; ++b)
        for (int a = 0; a < 3; ++a)
          gradient.row(mover.translation.free + b) += row(mover.translation.row + 3 * b + a) * state.row(s + a);
    if (mover.rotation.free >= 0)
      for (int b = 0; b < mover.rotation.width; ++b)
        for (int a = 0; a < 3; ++a)
          gradient.row(mover.rotation.free + b) += row(mover.rotation.row + 3 * b + a) * state.row(s + 3 + a);
    if (mover.scale.free >= 0)
      for (int k = 0; k < 3; ++k)
        for (int b = 0; b < 3; ++b)
          for (int a = 0; a < 3; ++a)
            gradient.row(mover.scale.free + k) += state.row(s + 6 + 3 * b + a) * row(mover.scale.row + 9 + k) *
                                                  row(mover.scale.row + 3 * k + a) * row(mover.scale.row + 3 * k + b);
    if (mover.parent < 0) continue;
    const Eigen::Index p = width * mover.parent, r = mover.offset_row;
    state.middleRows(p, 6) += state.middleRows(s, 6);
    state.row(p + 3) += row(r + 1) * state.row(s + 2) - row(r + 2) * state.row(s + 1);
    state.row(p + 4) += row(r + 2) * state.row(s + 0) - row(r + 0) * state.row(s + 2);
    state.row(p + 5) += row(r + 0) * state.row(s + 1) - row(r + 1) * state.row(s + 0);
    if (stretches_) {
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) state.row(p + 6 + 3 * b + a) += state.row(s + a) * row(r + b);
      state.middleRows(p + 6, 9) += state.middleRows(s + 6, 9);
    }
  }
  for (std::size_t m = 0; m < morphs_.size(); ++m)
    gradient.row(morphs_[m].free) +=
        static_cast<float>(morphs_[m].reach) * weight.row(3 * point_count() + static_cast<Eigen::Index>(m));
}

Eigen::VectorXd MotionMap::reach() const {
  const Eigen::Index count = free_count_;
  Eigen::VectorXd reach(count);
  Rows delta = Rows::Zero(count, samples_), error;
  for (Eigen::Index i = 0; i < count; ++i) {
    delta.row(i).setOnes();
    errors(delta, error);
    delta.row(i).setZero();
    Eigen::ArrayXf most = Eigen::ArrayXf::Zero(samples_);
    for (Eigen::Index q = 0; q < point_count(); ++q)
      most = most.max(error.middleRows(3 * q, 3).square().colwise().sum().transpose());
    for (Eigen::Index r = 3 * point_count(); r < error_rows(); ++r) most = most.max(error.row(r).square().transpose());
    reach(i) = std::sqrt(static_cast<double>(most.mean()));
  }
  return reach;
}

}  // namespace nmc::codec
