// What the contexts of the format bring: the code length of a stream's numbers without them.
#pragma once

#include <filesystem>

#include "codec/compress.h"
#include "rate_measurement.h"

namespace nmc::bench {

/// The default's file with the same levels, where each kind of number that has contexts (references, states, anchors,
/// numbers of frequencies, weights; gltf_ext/README.md, A.3 to A.5) has one plain adaptive run instead. Counted, not
/// written: the format has no such streams.
Measurement measure_without_contexts(const std::filesystem::path& path, const codec::CompressOptions& options);

}  // namespace nmc::bench
