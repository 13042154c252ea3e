// What was tried for the animations of a file, in short, as a compressed document keeps it (gltf_ext/README.md, "What
// the writer tried").
#pragma once

#include <optional>
#include <vector>

#include "codec/compress.h"
#include "codec/source.h"
#include "gltf/edit.h"

namespace nmc::codec {

/// Puts the summary into the extras of an edit that was made of these sets.
void put_search_records(const std::vector<ClipResult>& clips, const std::vector<EncodedSet>& sets,
                        gltf::CompressionEdit& edit);

/// What the extras of a document say. They are anybody's: what is not as put_search_records makes it is left out.
std::optional<SearchRecord> read_search(const gltf::Json& extras);  ///< of an animation
std::vector<PoseRecord> read_poses(const gltf::Json& extras);       ///< of a clip set
std::vector<KeptRecord> read_kept(const gltf::Json& extras);        ///< of the root

}  // namespace nmc::codec
