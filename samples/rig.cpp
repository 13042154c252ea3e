// Skeletons and poses of the sample characters.
#include "samples/rig.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace nmc::samples {
namespace {

/// Columns: hinge axis made orthogonal to the bone, bone direction, their cross product.
glm::dmat3 frame(const glm::dvec3& direction, const glm::dvec3& side) {
  const glm::dvec3 y = glm::normalize(direction);
  const glm::dvec3 z = glm::normalize(glm::cross(side, y));
  return {glm::cross(y, z), y, z};
}

glm::dquat along_bone(const Joint& joint) {
  const glm::dvec3 y = glm::normalize(joint.tail - joint.head);
  const glm::dvec3 front = std::abs(y.z) > 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
  return glm::quat_cast(frame(y, glm::cross(y, front)));
}

glm::dquat near_half_turn(std::size_t joint) {
  const double k = static_cast<double>(joint);
  const glm::dvec3 axis = glm::normalize(glm::dvec3(std::cos(1.7 * k), std::sin(1.7 * k), 0.5 * std::sin(0.9 * k)));
  return glm::angleAxis(std::numbers::pi - 0.1 * std::abs(std::sin(2.3 * k)), axis);
}

}  // namespace

int Rig::add(const std::string& name, std::string_view parent, const glm::dvec3& head, const glm::dvec3& tail) {
  joints.push_back({name, parent.empty() ? -1 : find(parent), head, tail, {}});
  return static_cast<int>(joints.size()) - 1;
}

int Rig::find(std::string_view name) const {
  const auto found = std::find_if(joints.begin(), joints.end(), [&](const Joint& joint) { return joint.name == name; });
  if (found == joints.end()) throw std::out_of_range("no joint named " + std::string(name));
  return static_cast<int>(found - joints.begin());
}

void set_rest_rotations(Rig& rig, RestStyle style) {
  for (std::size_t j = 0; j < rig.joints.size(); ++j) {
    Joint& joint = rig.joints[j];
    if (style == RestStyle::along_bone) {
      joint.rest = along_bone(joint);
    } else {
      const glm::dquat parent =
          joint.parent < 0 ? glm::dquat(1, 0, 0, 0) : rig.joints[static_cast<std::size_t>(joint.parent)].rest;
      joint.rest = glm::normalize(parent * near_half_turn(j));
    }
  }
}

Pose rest_pose(const Rig& rig) {
  return {rig.joints.at(0).head, std::vector<glm::dquat>(rig.joints.size(), glm::dquat(1, 0, 0, 0))};
}

PlacedPose place(const Rig& rig, const Pose& pose) {
  PlacedPose placed{std::vector<glm::dvec3>(rig.joints.size()), std::vector<glm::dquat>(rig.joints.size())};
  for (std::size_t j = 0; j < rig.joints.size(); ++j) {
    const Joint& joint = rig.joints[j];
    if (joint.parent < 0) {
      placed.positions[j] = pose.root_position;
      placed.turns[j] = pose.turns[j];
      continue;
    }
    const auto parent = static_cast<std::size_t>(joint.parent);
    placed.positions[j] = placed.positions[parent] + placed.turns[parent] * (joint.head - rig.joints[parent].head);
    placed.turns[j] = placed.turns[parent] * pose.turns[j];
  }
  return placed;
}

glm::dvec3 local_translation(const Rig& rig, const Pose& pose, int index) {
  const Joint& joint = rig.joints[static_cast<std::size_t>(index)];
  if (joint.parent < 0) return pose.root_position;
  const Joint& parent = rig.joints[static_cast<std::size_t>(joint.parent)];
  return glm::conjugate(parent.rest) * (joint.head - parent.head);
}

glm::dquat local_rotation(const Rig& rig, const Pose& pose, int index) {
  const auto j = static_cast<std::size_t>(index);
  const Joint& joint = rig.joints[j];
  const glm::dquat in_model = pose.turns[j] * joint.rest;
  if (joint.parent < 0) return glm::normalize(in_model);
  return glm::normalize(glm::conjugate(rig.joints[static_cast<std::size_t>(joint.parent)].rest) * in_model);
}

glm::dquat about_x(double radians) { return glm::angleAxis(radians, glm::dvec3(1, 0, 0)); }
glm::dquat about_y(double radians) { return glm::angleAxis(radians, glm::dvec3(0, 1, 0)); }
glm::dquat about_z(double radians) { return glm::angleAxis(radians, glm::dvec3(0, 0, 1)); }

glm::dquat mirrored(const glm::dquat& turn) { return {turn.w, turn.x, -turn.y, -turn.z}; }
glm::dvec3 mirrored(const glm::dvec3& point) { return {-point.x, point.y, point.z}; }

TwoBoneBend bend_two_bones(const glm::dvec3& start, const glm::dvec3& end, double upper_length, double lower_length,
                           const glm::dvec3& pole) {
  const glm::dvec3 reach = end - start;
  const double asked = glm::length(reach);
  const double longest = upper_length + lower_length;
  const double distance = std::clamp(asked, std::abs(upper_length - lower_length) + 1e-6, longest * (1.0 - 1e-9));
  const glm::dvec3 direction = reach / asked;
  const glm::dvec3 side = glm::normalize(glm::cross(pole, direction));
  const glm::dvec3 outward = glm::cross(direction, side);
  const double cosine = (upper_length * upper_length + distance * distance - lower_length * lower_length) /
                        (2.0 * upper_length * distance);
  const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
  const glm::dvec3 middle = start + upper_length * (std::cos(angle) * direction + std::sin(angle) * outward);
  return {middle, side, asked / longest};
}

glm::dquat aim(const glm::dvec3& rest_direction, const glm::dvec3& rest_side, const glm::dvec3& direction,
               const glm::dvec3& side) {
  return glm::normalize(glm::quat_cast(frame(direction, side) * glm::transpose(frame(rest_direction, rest_side))));
}

}  // namespace nmc::samples
