// Errors between samples: where a rotation turns so far in one step that a small error on either side sends it another
// way, its values on both sides are set right.
#pragma once

#include <Eigen/Core>
#include <vector>

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

/// What an error between two samples is mended with.
enum class Mending {
  tips,       ///< steps of single parameters where they are enough: what goes the other way round is tipped back
  true_poses  ///< true values alone: tips at one pair of samples may undo those at the next one
};

/// Looks at what single steps or targets do to the errors of a pair that are always enough.
inline constexpr int most_tries = 600;

/// Corrects samples n - 1 and n, so that the errors there and at `seconds` between them are within `bound` (world
/// units): tips, or brings as few targets as are needed to their true values; where rounding stands in the way of
/// these, goes a few steps from them; of either no more than `tries` are looked at, and where that is not enough
/// all targets are brought to their true values. What is corrected is put into `atoms`; `values` (all parameters
/// x samples), of which no other samples are looked at, follow. False where an error is still above the bound.
bool mend_between(const BetweenInput& input, Eigen::Index n, double seconds, double bound, Mending mending, int tries,
                  Eigen::MatrixXd& values, std::vector<LevelAtom>& atoms);

}  // namespace nmc::codec
