// What spline curves in a subspace lose: joints on the floor, recorded apart and put right by inverse kinematics (Lin
// et al. 2011, section 5.3).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "baselines/bytes.h"
#include "baselines/motion_data.h"

namespace nmc::baselines {

/// Records the floor contacts of some clips and rectifies the decoded ones as the decoder will. `wanted` and `decoded`:
/// values of MotionData. `step`: of the way between frames, world units (the paper: 4 bits for up to 2.5 cm).
void write_contacts(ByteWriter& bytes, const motion::Skeleton& skeleton, const Head& head,
                    const std::vector<Eigen::MatrixXd>& wanted, const std::vector<Eigen::MatrixXd>& decoded,
                    double size, double step);

/// Reads the contacts and moves the joints of the decoded clips to them.
void apply_contacts(ByteReader& bytes, const motion::Skeleton& skeleton, const Head& head,
                    std::vector<Eigen::MatrixXd>& decoded);

}  // namespace nmc::baselines
