// Errors between samples: where a rotation turns so far in one step that a small error on either side sends it another
// way, its values on both sides are set right.
#pragma once

#include <Eigen/Core>

#include "codec/clip_layout.h"
#include "codec/clip_set.h"
#include "codec/source.h"
#include "codec/sparse_training.h"
#include "motion/error.h"

namespace nmc::codec {

/// What is needed to look between the samples of a clip; all of it outlives this.
struct BetweenInput {
  const ClipSource& clip;
  const SetFrame& frame;
  const ClipLayout& layout;
  const ParameterSteps& steps;
  const motion::ErrorMeter& meter;
};

/// Brings to their true values at samples n - 1 and n as few targets as are needed for the errors there and at
/// `seconds` between them to be within `bound` (world units); where rounding stands in the way, goes a few steps from
/// them. `values` (all parameters x samples) are those of the levels, and follow them. False where an error is still
/// above the bound.
bool mend_between(const BetweenInput& input, Eigen::Index n, double seconds, double bound, Eigen::MatrixXd& values,
                  LevelClip& levels);

}  // namespace nmc::codec
