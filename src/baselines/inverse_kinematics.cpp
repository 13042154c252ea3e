#include "baselines/inverse_kinematics.h"

#include <Eigen/LU>
#include <algorithm>

#include "baselines/markers.h"
#include "motion/index.h"
#include "motion/pose_parameters.h"

namespace nmc::baselines {

using motion::at;

ReachingPose::ReachingPose(const motion::Skeleton& skeleton, const Head& head, Eigen::MatrixXd& values, Eigen::Index n)
    : skeleton_(skeleton),
      head_(head),
      values_(values),
      n_(n),
      rotation_(skeleton.size(), nullptr),
      locals_(locals_of(skeleton, head, values, n)),
      animated_(skeleton.size(), 0),
      world_(skeleton.size()) {
  for (const Channel& channel : head_.channels) {
    if (channel.target.path != Path::weights) animated_[at(channel.target.node)] = 1;
    if (channel.moves && channel.target.path == Path::rotation) rotation_[at(channel.target.node)] = &channel;
  }
  update();
}

void ReachingPose::update() {
  for (const int node : skeleton_.order) {
    const glm::dmat4 local =
        animated_[at(node)] ? motion::to_matrix(locals_[at(node)]) : skeleton_.rest_matrix[at(node)];
    const int parent = skeleton_.parent[at(node)];
    world_[at(node)] = parent < 0 ? local : world_[at(parent)] * local;
  }
}

void ReachingPose::turn(int node, const glm::dvec3& by) {
  const int parent = skeleton_.parent[at(node)];
  const glm::dquat above = parent < 0 ? glm::dquat(1, 0, 0, 0) : motion::decompose(world_[at(parent)]).rotation;
  const glm::dquat change = motion::rotation_of_vector(glm::inverse(above) * by);
  locals_[at(node)].rotation = glm::normalize(change * locals_[at(node)].rotation);
}

double ReachingPose::reach(int node, const glm::dvec3& target, int chain, double tolerance) {
  std::vector<int> joints;
  for (int above = skeleton_.parent[at(node)]; above >= 0 && static_cast<int>(joints.size()) < chain;
       above = skeleton_.parent[at(above)])
    if (rotation_[at(above)]) joints.push_back(above);
  double distance = glm::length(target - position(node));
  constexpr int most_steps = 60;
  constexpr double least_damping = 0.05, most_damping = 100;
  double damping = least_damping;  // of a step, in reaches; more of it after one that led away
  for (int step = 0; step < most_steps && distance > tolerance && !joints.empty(); ++step) {
    Eigen::MatrixXd jacobian(3, 3 * static_cast<Eigen::Index>(joints.size()));
    double reach = 0;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const glm::dvec3 arm = position(node) - position(joints[j]);
      reach = std::max(reach, glm::length(arm));
      Eigen::Matrix3d block;
      block << 0, arm.z, -arm.y, -arm.z, 0, arm.x, arm.y, -arm.x, 0;
      jacobian.middleCols<3>(3 * static_cast<Eigen::Index>(j)) = block;
    }
    if (!(reach > 0)) break;
    const glm::dvec3 way = target - position(node);
    const Eigen::Matrix3d normal =
        jacobian * jacobian.transpose() + damping * damping * reach * reach * Eigen::Matrix3d::Identity();
    const Eigen::VectorXd by = jacobian.transpose() * normal.inverse() * Eigen::Vector3d(way.x, way.y, way.z);
    if (!by.allFinite()) break;
    const std::vector<motion::Transform> before = locals_;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const auto i = 3 * static_cast<Eigen::Index>(j);
      turn(joints[j], {by(i), by(i + 1), by(i + 2)});
    }
    update();
    const double now = glm::length(target - position(node));
    if (!(now < distance)) {
      locals_ = before;
      update();
      damping *= 4;
      if (damping > most_damping) break;
      continue;
    }
    damping = std::max(least_damping, damping / 4);
    distance = now;
  }
  for (const int joint : joints) {
    const glm::dquat& q = locals_[at(joint)].rotation;
    const Eigen::Index first = rotation_[at(joint)]->first;
    values_.block<4, 1>(first, n_) = Eigen::Vector4d(q.x, q.y, q.z, q.w);
  }
  return distance;
}

}  // namespace nmc::baselines
