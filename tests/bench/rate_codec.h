// The two profiles of the codec, measured.
#pragma once

#include <filesystem>

#include "codec/compress.h"
#include "rate_measurement.h"
#include "rate_reference.h"

namespace nmc::bench {

/// The bytes of a file as it is.
Measurement measure_cost(const std::filesystem::path& path);

/// codec::compress with these options. Time and memory are those of compressing, without reading and measuring.
Measurement measure_codec(const std::filesystem::path& path, const codec::CompressOptions& options);

/// Fills bytes and errors from a file that was made.
void measure_result(const Reference& reference, const gltf::Document& made, Measurement& row);

}  // namespace nmc::bench
