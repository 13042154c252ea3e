// Poses without where the body stands and looks: root alignment (Lin et al. 2011, section 3), with the root's own
// motion as Catmull-Rom splines.
#pragma once

#include <Eigen/Core>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "baselines/bytes.h"
#include "baselines/markers.h"

namespace nmc::baselines {

/// The root of one clip: rows are its position and its turn, about the vertical alone (one angle, unwrapped) or in full
/// (x, y, z, w); one sample a column.
struct RootMotion {
  bool full = false;
  Eigen::MatrixXd rows;

  glm::dvec3 position(Eigen::Index n) const { return {rows(0, n), rows(1, n), rows(2, n)}; }
  glm::dquat turn(Eigen::Index n) const;
};

/// Full alignment where some root turns from upright by more than `large_tilt_radians` (somersaults, breakdance).
inline constexpr double large_tilt_radians = 1.0;
std::vector<RootMotion> find_roots(const MarkerRig& rig, const std::vector<Eigen::MatrixXd>& values);

/// Writes control points in 16 bits, `span` samples apart and where the curve is farther away than `threshold` (world
/// units; of turns the angle times a fifth of the size), and returns what a decoder reads.
std::vector<RootMotion> write_roots(ByteWriter& bytes, const std::vector<RootMotion>& roots, double size,
                                    Eigen::Index span, double threshold);
std::vector<RootMotion> read_roots(ByteReader& bytes, const std::vector<Eigen::Index>& frames);

/// World markers as seen from the root, and back; extra rows stay.
Eigen::MatrixXd align(const MarkerRig& rig, const RootMotion& root, Eigen::MatrixXd markers);
Eigen::MatrixXd unalign(const MarkerRig& rig, const RootMotion& root, Eigen::MatrixXd markers);

}  // namespace nmc::baselines
