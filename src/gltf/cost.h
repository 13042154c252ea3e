// What a document's animations cost in bytes, counted as the referee counts (tools/measure.py, payload).
#pragma once

#include <cstddef>
#include <vector>

#include "gltf/document.h"

namespace nmc::gltf {

/// Bytes. Keys: the elements of accessors that animation samplers use (sparse ones: what is stored), the stored length
/// of their meshopt-compressed bufferViews, and the streams of NMC_animation_compression. JSON: the minified text of
/// animations, of the accessors and bufferViews they use, and of the root's NMC_animation_compression.
struct AnimationCost {
  std::size_t key_bytes = 0;
  std::size_t json_bytes = 0;

  bool operator==(const AnimationCost&) const = default;
};

/// The cost of all animations together. Throws Error (invalid_input) naming an object that the animations refer to and
/// that is broken.
AnimationCost total_cost(const Document& document);

/// The cost of each animation of the file. What several animations use is divided evenly among them, to whole bytes,
/// earlier ones first. Streams of clip sets, their bufferViews and the root extension are left out: how a stream
/// divides into clips is the codec's knowledge. The sum is less than the total by these and by the brackets and commas
/// of the animation list.
std::vector<AnimationCost> animation_costs(const Document& document);

}  // namespace nmc::gltf
