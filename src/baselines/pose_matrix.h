// The pose matrix Y of Tojo et al. 2022, section 3: translations, the root's rotation as a quaternion, the others as
// axis-angle.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "baselines/motion_data.h"
#include "motion/pose_parameters.h"

namespace nmc::baselines {

/// How one clip's moving channels are written as parameters. Axis-angle is relative to the rest rotation.
struct PoseForms {
  std::vector<motion::Form> forms;  ///< per moving channel, in order
  int rows = 0;                     ///< parameters per frame
};

/// A rotation below no other that moves, or one that turns too far from rest for axis-angle, is a quaternion.
PoseForms pose_forms(const motion::Skeleton& skeleton, const Head& head, const Eigen::MatrixXd& values);

/// Parameters x frames of values (rows as in MotionData), and back.
Eigen::MatrixXd to_pose_matrix(const motion::Skeleton& skeleton, const Head& head, const PoseForms& forms,
                               const Eigen::MatrixXd& values);
Eigen::MatrixXd from_pose_matrix(const motion::Skeleton& skeleton, const Head& head, const PoseForms& forms,
                                 const Eigen::MatrixXd& poses);

void write_forms(ByteWriter& bytes, const PoseForms& forms);
PoseForms read_forms(ByteReader& bytes, const Head& head);

}  // namespace nmc::baselines
