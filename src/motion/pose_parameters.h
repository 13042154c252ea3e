// Pose parameters (Tojo et al. 2022, section 3): the numbers per frame that the network learns, from local transforms
// and back.
#pragma once

#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <vector>

#include "motion/clip.h"

namespace nmc::motion {

/// How a track is written as parameters.
enum class Form : std::uint8_t {
  vector = 0,      ///< translation, scale, weights: the numbers themselves
  axis_angle = 1,  ///< rotation q = reference * exp(v / 2), v the rotation vector in radians: 3 parameters
  quaternion = 2,  ///< rotation as x, y, z, w, sign-continuous: 4 parameters, normalised on the way back
};

/// Where one track's parameters lie in a pose vector.
struct Block {
  Form form = Form::vector;
  glm::dquat reference{1.0, 0.0, 0.0, 0.0};  ///< for axis_angle
  int first = 0;                             ///< index of the first parameter
  int width = 3;                             ///< number of parameters
};

/// Rotation vector (radians) of a unit quaternion, on the short arc (length at most pi), and back. Exact to rounding
/// for small angles too.
glm::dvec3 rotation_vector(const glm::dquat& q);
glm::dquat rotation_of_vector(const glm::dvec3& v);

/// The mean rotation of the rows (x, y, z, w) in the sense of the largest eigenvector of their outer products, and the
/// largest angle (radians, at most pi) between it and a row. The identity and 0 for no rows.
struct MeanRotation {
  glm::dquat mean{1.0, 0.0, 0.0, 0.0};
  double largest_angle_radians = 0.0;
};
MeanRotation mean_rotation(std::span<const float> quaternions);

/// Beyond this angle from its reference a rotation takes the quaternion form.
inline constexpr double axis_angle_limit_radians = 2.4;

/// The track's values as parameters: rows x block.width, row-major (one row for a constant track). A rotation vector is
/// given the multiple of a full turn that brings it nearest to the previous row's, so that motion past pi stays
/// continuous. The quaternion form starts on the reference's side (dot product with it at least 0) and is
/// sign-continuous. Throws Error (internal) when track and block do not fit.
std::vector<double> to_parameters(const Track& track, const Block& block);

/// The inverse: rows x track width values; rotations of unit length and sign-continuous, the identity where a
/// quaternion has length zero. Throws Error (internal) when parameters, block and path do not fit.
std::vector<float> from_parameters(std::span<const double> parameters, const Block& block, Path path);

}  // namespace nmc::motion
