// What adding to single parameters would do to the errors of the points that they move.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "codec/motion_map.h"

namespace nmc::codec {

/// Errors of all points and morph targets in some blocks of samples, as in_blocks has them.
using BlockErrors = Eigen::Ref<LaneRows>;
using ConstBlockErrors = Eigen::Ref<const LaneRows>;

/// error += shares * effect; `shares` has one column per block of the effect, `error` the same blocks.
void add_effect(const MotionMap& map, const Effect& effect, const LaneRows& shares, BlockErrors error);

/// The squared error of one point in one block, in units of a limit, by what share s of an effect is added to it:
/// square + s (slope + s bend).
struct Parabola {
  Eigen::Index block = 0;  ///< of the effect's blocks
  Lanes square, slope, bend;

  /// With one share per sample of the block.
  Lanes at(const Eigen::Ref<const Lanes>& shares) const { return square + shares * (slope + shares * bend); }
};

/// Of every point of the effect those blocks where shares of up to `most` either way could bring its error above
/// `limit` or where it is above; `error` has the effect's blocks.
std::vector<Parabola> endangered(const MotionMap& map, const Effect& effect, float most, ConstBlockErrors error,
                                 float limit);

}  // namespace nmc::codec
