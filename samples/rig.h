// Skeletons and poses of the sample characters. Model space: metres, +Y up, the character faces +Z, its left is +X.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace nmc::samples {

/// A bone. Parents come before their children.
struct Joint {
  std::string name;
  int parent = -1;                      ///< -1 for the root
  glm::dvec3 head{0.0};                 ///< rest position in model space
  glm::dvec3 tail{0.0};                 ///< end of the bone in the rest pose
  glm::dquat rest{1.0, 0.0, 0.0, 0.0};  ///< rest rotation in model space
};

/// How the bones' own axes lie in the rest pose.
enum class RestStyle {
  along_bone,  ///< local Y runs along the bone, as Blender and Mixamo write it
  half_turn,   ///< every local rest rotation is within 0.1 radians of a half turn about some skew axis
};

struct Rig {
  std::vector<Joint> joints;

  /// Appends a bone and returns its index. `parent` is a name, empty for the root.
  int add(const std::string& name, std::string_view parent, const glm::dvec3& head, const glm::dvec3& tail);

  /// The index of a joint. Throws std::out_of_range for a name that does not exist.
  int find(std::string_view name) const;
};

/// Sets all rest rotations.
void set_rest_rotations(Rig& rig, RestStyle style);

/// A pose said in the character's own axes: `turns[j]` turns joint j against its parent, about axes that are the
/// model's in the rest pose. The identity is the rest pose whatever the bones' own axes are.
struct Pose {
  glm::dvec3 root_position{0.0};  ///< of joint 0, in model space
  std::vector<glm::dquat> turns;
};

Pose rest_pose(const Rig& rig);

/// Where a pose puts every joint.
struct PlacedPose {
  std::vector<glm::dvec3> positions;  ///< of the joints' heads, in model space
  std::vector<glm::dquat> turns;      ///< from the rest pose, in model space
};

PlacedPose place(const Rig& rig, const Pose& pose);

/// The glTF node values of a joint.
glm::dvec3 local_translation(const Rig& rig, const Pose& pose, int joint);
glm::dquat local_rotation(const Rig& rig, const Pose& pose, int joint);

/// Turns in radians about the model's axes: about +X a forward bow, about +Y to the left, about +Z the left side up.
glm::dquat about_x(double radians);
glm::dquat about_y(double radians);
glm::dquat about_z(double radians);

/// The mirror image of a turn or a point in the plane x = 0.
glm::dquat mirrored(const glm::dquat& turn);
glm::dvec3 mirrored(const glm::dvec3& point);

/// The bend of a two-bone chain that reaches from `start` to `end`.
struct TwoBoneBend {
  glm::dvec3 middle{0.0};  ///< the bent joint's position
  glm::dvec3 side{0.0};    ///< unit hinge axis
  double stretch = 0.0;    ///< distance asked for / length of the straight chain; above 1 the end is not reached
};

/// Bends so that the middle joint moves towards `pole` (a direction). Lengths in metres.
TwoBoneBend bend_two_bones(const glm::dvec3& start, const glm::dvec3& end, double upper_length, double lower_length,
                           const glm::dvec3& pole);

/// The turn that takes a bone direction and its hinge axis in the rest pose to those wanted.
glm::dquat aim(const glm::dvec3& rest_direction, const glm::dvec3& rest_side, const glm::dvec3& direction,
               const glm::dvec3& side);

}  // namespace nmc::samples
