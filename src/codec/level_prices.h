// What the coder's contexts make of a level: cheap among large ones, dear among zeros.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "codec/clip_layout.h"

namespace nmc::codec {

/// A window's weights in levels, before or after rounding: moving parameters x features.
using Weights = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// What a bit of the training's smooth rate costs in truth, at each level of each window (moving parameters x
/// features; so are the prices): about 0.3 among large levels, about 3 among zeros. Estimated from the rounded levels
/// that the coder's contexts see as well (gltf_ext/README.md, A.4.6): the next ones in frequency, those of the
/// target's other parameters, and those of the windows before and after.
std::vector<Weights> level_prices(const std::vector<Weights>& levels, const ClipLayout& layout);

}  // namespace nmc::codec
