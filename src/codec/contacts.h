// Where points of a character stand still: feet on the ground, hands on a wall.
#pragma once

#include <cstddef>
#include <vector>

#include "codec/motion_map.h"

namespace nmc::codec {

/// `weight` where a point stands still, one elsewhere: rows as in MotionMap (points, then morph targets, which never
/// stand) x samples. `positions` are error rows x samples in world units. A point stands still while it moves less than
/// 1 % of the character's size per second for a tenth of a second or longer (motion::contact_spans).
Rows contact_emphasis(const Rows& positions, std::size_t points, const std::vector<float>& times, double size,
                      double weight);

}  // namespace nmc::codec
