// The pose of a skeleton under one animation, read at one time after the other.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <vector>

#include "base/animation.h"
#include "motion/curve.h"
#include "motion/index.h"
#include "motion/skeleton.h"

namespace nmc::motion {

/// Binds the curves of an animation to a skeleton. A property without a curve keeps its rest value; a node without
/// translation, rotation and scale curves keeps its exact rest matrix. Of two curves of one property the later counts.
/// Skeleton and animation must outlive it.
class PoseReader {
 public:
  /// Throws Error (internal) for a curve that names no node of the skeleton or is malformed.
  PoseReader(const Skeleton& skeleton, const Animation& animation);

  /// Moves to a time; increasing times are cheapest.
  void read(double seconds);

  /// World matrices of all nodes at the time last read; the rest pose before the first read.
  std::span<const glm::dmat4> world() const { return world_; }

  /// The local rotation of a node.
  const glm::dquat& rotation(int node) const { return local_[at(node)].rotation; }

  /// The morph weights of a node.
  std::span<const double> weights(int node) const { return weights_[at(node)]; }

  /// Nodes whose world matrix can change, parents before children: those with a translation, rotation or scale curve
  /// and all below.
  std::span<const int> moving() const { return moving_; }

  bool has_curve(int node, Path path) const { return has_curve_[at(node)][static_cast<std::size_t>(path)]; }

 private:
  const Skeleton* skeleton_;
  std::vector<CurveReader> readers_;
  std::vector<std::array<bool, 4>> has_curve_;
  std::vector<Transform> local_;
  std::vector<glm::dmat4> local_matrix_, world_;
  std::vector<std::vector<double>> weights_;
  std::vector<int> keyed_, moving_;
};

/// World matrices of all nodes at one time.
std::vector<glm::dmat4> world_pose(const Skeleton& skeleton, const Animation& animation, double seconds);

}  // namespace nmc::motion
