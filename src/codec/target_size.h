// The other way round: the tolerance for a number of bytes.
#pragma once

#include <cstddef>

#include "codec/compress.h"

namespace nmc::codec {

/// The bytes of all animations, keys and JSON.
std::size_t animation_bytes(const CompressResult& result);

/// Compresses with the smallest tolerance found at which animation_bytes is at most `bytes`; it is searched for by
/// whole compressions, nine at most, between 0.001 % and 50 % of the character's size. options.tolerance is not used.
/// Throws Error as `compress`, and usage where the coarsest tolerance needs more bytes.
CompressResult compress_to_size(const gltf::Document& document, CompressOptions options, std::size_t bytes);

}  // namespace nmc::codec
