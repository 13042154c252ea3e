// The default profile with a hidden layer beside the sparse ones, measured.
#pragma once

#include <filesystem>

#include "codec/compress.h"
#include "rate_measurement.h"

namespace nmc::bench {

/// The smallest of the default's clip sets with networks of several sizes (hidden_layer.h), each searched, written and
/// decoded as a whole. The format wants all clips beside a network to move the same parameters, so that a set of
/// several clips grows already without one: the note says what the network takes and what the same set takes without
/// it.
Measurement measure_hidden_layer(const std::filesystem::path& path, const codec::CompressOptions& options);

}  // namespace nmc::bench
