// The methods that code each channel or each clip by itself: low rank, quantised keys.
#pragma once

#include "baselines/method.h"

namespace nmc::baselines {

/// Low-rank approximation of the pose matrix (Tojo et al. 2022, section 4.1), float32 factors; per clip the smallest
/// rank within the bound.
std::unique_ptr<Encoder> prepare_svd(const codec::Source& source, const EncodeSettings& settings);
std::vector<motion::Clip> decode_svd(std::span<const std::uint8_t> bytes, const motion::Skeleton& skeleton);

/// Draco's keyframe animations, every channel quantised to the same number of bits; per clip the fewest bits within the
/// bound.
std::unique_ptr<Encoder> prepare_draco(const codec::Source& source, const EncodeSettings& settings);
std::vector<motion::Clip> decode_draco(std::span<const std::uint8_t> bytes, const motion::Skeleton& skeleton);

/// Keys as EXT_meshopt_compression stores them: the quaternion filter for rotations, the exponential filter for the
/// rest, then the vertex codec. Per clip the keys kept (each, every second, ...) and the bits that make the fewest
/// bytes within the bound; four bits more for translations than for rotations, as gltfpack's defaults have.
std::unique_ptr<Encoder> prepare_meshopt(const codec::Source& source, const EncodeSettings& settings);
std::vector<motion::Clip> decode_meshopt(std::span<const std::uint8_t> bytes, const motion::Skeleton& skeleton);

}  // namespace nmc::baselines
