// Loops whose corrections do not open a seam.
#pragma once

#include <Eigen/Core>

#include "codec/clip_set.h"

namespace nmc::codec {

/// What atoms change at one end of a loop they change at the other as well from then on, or they would open the seam
/// that the anchors close. The less corrected end follows: the other one needs what it has. `signs`: per parameter what
/// a change at the first sample is at the last one (end_signs).
void close_seam(LevelClip& clip, const Eigen::VectorXd& signs, Eigen::Index samples);

}  // namespace nmc::codec
