// Joints to where they should be: damped least squares on the rotations above them.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "baselines/motion_data.h"

namespace nmc::baselines {

/// The pose of one sample as inverse kinematics changes it.
class ReachingPose {
 public:
  /// All outlive it. Sample n of values.
  ReachingPose(const motion::Skeleton& skeleton, const Head& head, Eigen::MatrixXd& values, Eigen::Index n);

  /// Turns at most `chain` joints above `node` whose rotation moves until its origin is within `tolerance` (world
  /// units) of `target`, or as near as 60 steps bring it; writes the rotations back. Returns the distance that is left.
  double reach(int node, const glm::dvec3& target, int chain, double tolerance);

  glm::dvec3 position(int node) const { return glm::dvec3(world_[static_cast<std::size_t>(node)][3]); }

 private:
  void turn(int node, const glm::dvec3& by);  ///< a rotation vector in world space
  void update();

  const motion::Skeleton& skeleton_;
  const Head& head_;
  Eigen::MatrixXd& values_;
  Eigen::Index n_;
  std::vector<const Channel*> rotation_;  ///< per node; null where it does not move
  std::vector<motion::Transform> locals_;
  std::vector<char> animated_;
  std::vector<glm::dmat4> world_;
};

}  // namespace nmc::baselines
