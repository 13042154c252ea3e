// The clip sets of a file in the default profile: which clips share one, how exactly its poses are written.
#pragma once

#include <functional>
#include <vector>

#include "codec/compress.h"
#include "codec/source.h"

namespace nmc::codec {

/// Says what becomes of the clips of a new set: writes the outcome of each (compressed, kept_over_tolerance, ...) into
/// the results, which have one entry per animation.
using Judge = std::function<void(const EncodedSet& set, std::vector<ClipResult>& results)>;

/// For each bound one set of all clips that have it, another with finer steps for those that need it. Only clips that
/// the judge found compressed are in a set.
std::vector<EncodedSet> encode_standard_sets(const Source& source, const CompressOptions& options, const Judge& judge,
                                             std::vector<ClipResult>& results);

}  // namespace nmc::codec
