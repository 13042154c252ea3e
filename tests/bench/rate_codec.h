// The two profiles of the codec, measured.
#pragma once

#include <filesystem>
#include <vector>

#include "codec/compress.h"
#include "rate_measurement.h"
#include "rate_reference.h"

namespace nmc::bench {

/// The bytes of a file as it is.
Measurement measure_cost(const std::filesystem::path& path);

/// codec::compress with these options. Time and memory are those of compressing, without reading and measuring.
Measurement measure_codec(const std::filesystem::path& path, const codec::CompressOptions& options);

/// The default with one part after the other left out, and with every clip in a set of its own: the sum over files
/// with one animation each.
std::vector<codec::CompressOptions> ablations(const codec::CompressOptions& options);
Measurement measure_clips_apart(const std::filesystem::path& path, const codec::CompressOptions& options);

/// Fills bytes and errors from a file that was made.
void measure_result(const Reference& reference, const gltf::Document& made, Measurement& row);

}  // namespace nmc::bench
