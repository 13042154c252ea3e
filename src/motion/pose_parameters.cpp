// Rotations as vectors, quaternions and means; tracks as parameter rows.
#include "motion/pose_parameters.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>

#include "base/error.h"
#include "motion/symmetric4.h"

namespace nmc::motion {
namespace {

/// Below this the first two terms of the series are exact to rounding (the third is of order x^4).
constexpr double series_limit = 1e-4;

constexpr double two_pi = glm::two_pi<double>();

void require(bool fits) {
  if (!fits) throw Error(ErrorCode::internal, "Pose parameters do not fit their track; this is a defect.");
}

int parameter_width(const Block& block, int track_width) {
  if (block.form == Form::vector) return track_width;
  return block.form == Form::axis_angle ? 3 : 4;
}

glm::dquat row_quaternion(const float* row) { return glm::dquat(row[3], row[0], row[1], row[2]); }

/// The angle (radians, at most pi) between two rotations.
double angle_between(const glm::dquat& a, const glm::dquat& b) {
  const double minus = glm::length(a - b), plus = glm::length(a + b);
  if (std::isnan(minus + plus)) return std::numeric_limits<double>::infinity();
  return 4.0 * std::atan2(std::min(minus, plus), std::max(minus, plus));
}

/// The rotation vector of the same rotation that is nearest to `previous`: v plus whole turns about its axis.
glm::dvec3 continued(const glm::dvec3& v, const glm::dvec3& previous) {
  const double angle = glm::length(v);
  // Without an axis of its own a whole turn goes about the axis of the motion so far.
  const bool has_axis = angle > 1e-9;
  const glm::dvec3 along = has_axis ? v : previous;
  const double length = glm::length(along);
  if (!(length > 1e-9)) return v;
  const glm::dvec3 axis = along / length;
  const double turns = std::round((glm::dot(previous, axis) - (has_axis ? angle : 0.0)) / two_pi);
  return v + axis * (two_pi * turns);
}

std::vector<double> to_rotation_vectors(const Track& track, const glm::dquat& reference) {
  std::vector<double> result;
  result.reserve(track.values.size() / 4 * 3);
  glm::dvec3 previous(0.0);
  for (std::size_t row = 0; row < track.values.size(); row += 4) {
    const glm::dvec3 v = rotation_vector(glm::conjugate(reference) * row_quaternion(&track.values[row]));
    previous = row == 0 ? v : continued(v, previous);
    result.insert(result.end(), {previous.x, previous.y, previous.z});
  }
  return result;
}

std::vector<double> to_quaternions(const Track& track, const glm::dquat& reference) {
  std::vector<double> result;
  result.reserve(track.values.size());
  glm::dquat previous = reference;
  for (std::size_t row = 0; row < track.values.size(); row += 4) {
    glm::dquat q = row_quaternion(&track.values[row]);
    if (glm::dot(previous, q) < 0.0) q = -q;
    result.insert(result.end(), {q.x, q.y, q.z, q.w});
    previous = q;
  }
  return result;
}

glm::dquat normalized_or_identity(const glm::dquat& q) {
  const double length = glm::length(q);
  return length == 0.0 ? glm::dquat(1.0, 0.0, 0.0, 0.0) : q / length;
}

}  // namespace

glm::dvec3 rotation_vector(const glm::dquat& q) {
  const double sign = q.w < 0.0 ? -1.0 : 1.0;
  const glm::dvec3 v = sign * glm::dvec3(q.x, q.y, q.z);
  const double w = sign * q.w;
  const double sine = glm::length(v);
  if (sine < series_limit * w) {
    const double tangent = sine / w;
    return v * (2.0 / w * (1.0 - tangent * tangent / 3.0));
  }
  return sine == 0.0 ? glm::dvec3(0.0) : v * (2.0 * std::atan2(sine, w) / sine);
}

glm::dquat rotation_of_vector(const glm::dvec3& v) {
  const double angle = glm::length(v);
  const double share = angle < series_limit ? 0.5 - angle * angle / 48.0 : std::sin(0.5 * angle) / angle;
  return glm::dquat(std::cos(0.5 * angle), v.x * share, v.y * share, v.z * share);
}

MeanRotation mean_rotation(std::span<const float> quaternions) {
  require(quaternions.size() % 4 == 0);
  MeanRotation result;
  if (quaternions.empty()) return result;
  glm::dmat4 products(0.0);
  for (std::size_t row = 0; row < quaternions.size(); row += 4) {
    const glm::dvec4 q(quaternions[row], quaternions[row + 1], quaternions[row + 2], quaternions[row + 3]);
    products += glm::outerProduct(q, q);
  }
  const glm::dvec4 mean = dominant_eigenvector(products);
  result.mean = glm::dquat(mean.w, mean.x, mean.y, mean.z);
  for (std::size_t row = 0; row < quaternions.size(); row += 4) {
    const glm::dquat q = normalized_or_identity(row_quaternion(&quaternions[row]));
    const double angle = angle_between(result.mean, q);
    if (!(angle <= result.largest_angle_radians)) result.largest_angle_radians = angle;
  }
  return result;
}

std::vector<double> to_parameters(const Track& track, const Block& block) {
  const bool rotation = block.form != Form::vector;
  require(block.width == parameter_width(block, track.width) && rotation == (track.path == Path::rotation));
  require(track.width > 0 && track.values.size() % static_cast<std::size_t>(track.width) == 0);
  require(!rotation || track.width == 4);
  if (block.form == Form::axis_angle) return to_rotation_vectors(track, block.reference);
  if (block.form == Form::quaternion) return to_quaternions(track, block.reference);
  return {track.values.begin(), track.values.end()};
}

std::vector<float> from_parameters(std::span<const double> parameters, const Block& block, Path path) {
  const bool rotation = block.form != Form::vector;
  require(block.width == parameter_width(block, block.width) && rotation == (path == Path::rotation));
  require(block.width > 0 && parameters.size() % static_cast<std::size_t>(block.width) == 0);
  std::vector<float> result;
  if (!rotation) {
    result.reserve(parameters.size());
    for (const double x : parameters) result.push_back(static_cast<float>(x));
    return result;
  }
  const std::size_t width = static_cast<std::size_t>(block.width);
  result.reserve(parameters.size() / width * 4);
  glm::dquat previous(0.0, 0.0, 0.0, 0.0);
  for (std::size_t i = 0; i < parameters.size(); i += width) {
    glm::dquat q = block.form == Form::axis_angle
                       ? block.reference * rotation_of_vector({parameters[i], parameters[i + 1], parameters[i + 2]})
                       : glm::dquat(parameters[i + 3], parameters[i], parameters[i + 1], parameters[i + 2]);
    q = normalized_or_identity(q);
    if (glm::dot(previous, q) < 0.0) q = -q;
    for (const double x : {q.x, q.y, q.z, q.w}) result.push_back(static_cast<float>(x));
    previous = q;
  }
  return result;
}

}  // namespace nmc::motion
