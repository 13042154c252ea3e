// The features of one window as a matrix, as the decoder computes them.
#pragma once

#include <Eigen/Core>

#include "codec/clip_set.h"

namespace nmc::codec {

/// count x samples: row j - 1 is feature j at samples begin .. begin + samples - 1 of the window.
Eigen::MatrixXd window_features(Basis basis, std::uint32_t window_length, Eigen::Index count, Eigen::Index samples);

/// The largest feature index that adds to what anchors give.
Eigen::Index feature_limit(Basis basis, std::uint32_t window_length);

/// The shares of a window's first and second anchor pose at its samples: 2 x samples (cosine: the first is one, the
/// second zero).
Eigen::MatrixXd anchor_shares(Basis basis, std::uint32_t window_length, Eigen::Index samples);

}  // namespace nmc::codec
