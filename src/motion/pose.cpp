// Curves to local transforms to world matrices.
#include "motion/pose.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "base/error.h"

namespace nmc::motion {

PoseReader::PoseReader(const Skeleton& skeleton, const Animation& animation)
    : skeleton_(&skeleton),
      has_curve_(skeleton.size()),
      local_(skeleton.rest),
      local_matrix_(skeleton.rest_matrix),
      world_(skeleton.size()),
      weights_(skeleton.rest_weights) {
  weights_.resize(skeleton.size());
  std::map<std::pair<int, Path>, const Curve*> chosen;
  for (const Curve& curve : animation.curves) {
    if (curve.node < 0 || static_cast<std::size_t>(curve.node) >= skeleton.size()) {
      throw Error(ErrorCode::internal, "The animation '" + animation.name + "' moves node " +
                                           std::to_string(curve.node) + ", which does not exist; this is a defect.");
    }
    if (curve.path != Path::weights && curve.width != (curve.path == Path::rotation ? 4 : 3)) {
      throw Error(ErrorCode::internal, "The animation '" + animation.name + "' has values of a wrong width for node " +
                                           std::to_string(curve.node) + "; this is a defect.");
    }
    chosen[{curve.node, curve.path}] = &curve;
  }
  for (const auto& [target, curve] : chosen) {
    const auto [node, path] = target;
    readers_.emplace_back(*curve);
    has_curve_[at(node)][static_cast<std::size_t>(path)] = true;
    if (path == Path::weights) {
      weights_[at(node)].resize(static_cast<std::size_t>(curve->width));
    } else if (keyed_.empty() || keyed_.back() != node) {
      keyed_.push_back(node);
    }
  }

  std::vector<bool> moves(skeleton.size(), false);
  for (const int node : keyed_) moves[at(node)] = true;
  for (const int node : skeleton.order) {
    const int parent = skeleton.parent[at(node)];
    if (parent >= 0 && moves[at(parent)]) moves[at(node)] = true;
    if (moves[at(node)]) moving_.push_back(node);
  }
  world_matrices(skeleton, local_matrix_, world_);
}

void PoseReader::read(double seconds) {
  std::array<double, 4> value{};
  for (CurveReader& reader : readers_) {
    const Curve& curve = reader.curve();
    Transform& local = local_[at(curve.node)];
    if (curve.path == Path::weights) {
      reader.read(seconds, weights_[at(curve.node)]);
      continue;
    }
    reader.read(seconds, value);
    if (curve.path == Path::translation) local.translation = {value[0], value[1], value[2]};
    if (curve.path == Path::rotation) local.rotation = glm::dquat(value[3], value[0], value[1], value[2]);
    if (curve.path == Path::scale) local.scale = {value[0], value[1], value[2]};
  }
  for (const int node : keyed_) local_matrix_[at(node)] = to_matrix(local_[at(node)]);
  for (const int node : moving_) {
    const int parent = skeleton_->parent[at(node)];
    world_[at(node)] = parent < 0 ? local_matrix_[at(node)] : world_[at(parent)] * local_matrix_[at(node)];
  }
}

std::vector<glm::dmat4> world_pose(const Skeleton& skeleton, const Animation& animation, double seconds) {
  PoseReader reader(skeleton, animation);
  reader.read(seconds);
  return {reader.world().begin(), reader.world().end()};
}

}  // namespace nmc::motion
