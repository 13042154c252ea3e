// Clip sets of the codec (the streams of NMC_animation_compression) as the bytes of a method.
#pragma once

#include <vector>

#include "baselines/method.h"
#include "codec/source.h"

namespace nmc::baselines {

/// The streams with what the extension writes as JSON: which nodes they move, which clips they hold.
Bytes write_sets(std::span<const codec::EncodedSet> sets, std::size_t clips);

/// Clips that no set holds come back without tracks.
std::vector<motion::Clip> decode_sets(std::span<const std::uint8_t> bytes, const motion::Skeleton& skeleton);

std::unique_ptr<Encoder> prepare_nmc(const codec::Source& source, const EncodeSettings& settings);
std::unique_ptr<Encoder> prepare_nmc_paper(const codec::Source& source, const EncodeSettings& settings);
std::unique_ptr<Encoder> prepare_nmc_naive(const codec::Source& source, const EncodeSettings& settings);
std::unique_ptr<Encoder> prepare_dct(const codec::Source& source, const EncodeSettings& settings);

}  // namespace nmc::baselines
