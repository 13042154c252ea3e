// The plain opponent: a DCT-II of each channel over the whole clip, one step a clip, the codec's own entropy coder.
#pragma once

#include <filesystem>

#include "codec/compress.h"
#include "rate_measurement.h"

namespace nmc::bench {

/// Rounds the transform without training and corrections. Every clip has the coarsest step (in quarters of an octave)
/// that a bisection finds with the decoded error within the tolerance. A clip without one stays as keys, as with the
/// default profile. Of `options` tolerance and threads count.
Measurement measure_dct(const std::filesystem::path& path, const codec::CompressOptions& options);

}  // namespace nmc::bench
