// Virtual markers: joint rotations as positions in space, which are more linear (Arikan 2006; Lin et al. 2011, section
// 3), and back.
#pragma once

#include <Eigen/Core>
#include <glm/glm.hpp>
#include <vector>

#include "baselines/motion_data.h"
#include "motion/skeleton.h"

namespace nmc::baselines {

enum class MarkerSet {
  full,     ///< three per joint: its origin and two beside it (Arikan 2006)
  compact,  ///< the child's origin in place of the second, where there is a bone (Lin et al. 2011, figure 2)
};

struct Marker {
  int node = -1;
  glm::dvec3 offset{0.0};  ///< in the node's space
};

/// A joint whose rotation two markers tell: the rotation that brings `bone` and `side` (offsets in the joint's space)
/// to where the markers are.
struct MarkedJoint {
  int node = -1;
  int bone_marker = -1, side_marker = -1;
  glm::dvec3 bone{0.0}, side{0.0};
};

/// Which markers a skeleton has, found from what both encoder and decoder know.
struct MarkerRig {
  const motion::Skeleton* skeleton = nullptr;
  const Head* head = nullptr;
  double size = 1;
  std::vector<Marker> markers;
  std::vector<MarkedJoint> joints;  ///< parents before children
  std::vector<int> origin_marker;   ///< per node: the marker at its origin, -1 without
  int root = -1;                    ///< the first node that moves
  int extra_rows = 0;               ///< scales and morph weights, in units of `size`, behind the markers

  int marker_rows() const { return 3 * static_cast<int>(markers.size()); }
  int rows() const { return marker_rows() + extra_rows; }
};

/// Both outlive the rig. `size`: the character's, world units.
MarkerRig make_marker_rig(const motion::Skeleton& skeleton, const Head& head, MarkerSet set, double size);

/// World positions (x, y, z of each marker, then the extra rows) x samples of the values of a MotionData, and back.
/// Joints turn to where their markers are seen from where the chain has put them.
Eigen::MatrixXd to_markers(const MarkerRig& rig, const Eigen::MatrixXd& values);
Eigen::MatrixXd from_markers(const MarkerRig& rig, const Eigen::MatrixXd& markers);

/// World matrices of all nodes for sample n of values.
std::vector<glm::dmat4> world_of(const motion::Skeleton& skeleton, const Head& head, const Eigen::MatrixXd& values,
                                 Eigen::Index n);

/// The local transforms of all nodes in one sample.
std::vector<motion::Transform> locals_of(const motion::Skeleton& skeleton, const Head& head,
                                         const Eigen::MatrixXd& values, Eigen::Index n);

}  // namespace nmc::baselines
