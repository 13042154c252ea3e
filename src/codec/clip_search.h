// The search for one clip's smallest levels within the bound: windows, steps and the weight of a bit, by real bytes.
#pragma once

#include <cstddef>
#include <vector>

#include "codec/clip_set.h"
#include "codec/compress.h"
#include "codec/prepared_clip.h"

namespace nmc::codec {

/// The smallest levels found, at least one: at efforts above 5 those of the lower effort first, then each that is
/// smaller alone. They are within the tolerance by the encoder's own measurement unless nothing is. `tried` gets what
/// the search has looked at, before and after corrections; null: nothing is recorded.
std::vector<LevelClip> search_clip(const SearchContext& context, const PreparedClip& prepared, std::size_t index,
                                   std::vector<Candidate>* tried = nullptr);

}  // namespace nmc::codec
