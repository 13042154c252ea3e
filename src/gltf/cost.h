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

/// The bytes of a whole file by what they are for.
struct ByteParts {
  std::size_t meshes = 0;          ///< vertex attributes, indices, morph targets, inverse bind matrices
  std::size_t images = 0;          ///< in bufferViews and data URIs
  std::size_t keys = 0;            ///< as AnimationCost.key_bytes, without the streams
  std::size_t animation_json = 0;  ///< as AnimationCost.json_bytes
  std::size_t networks = 0;        ///< the streams of NMC_animation_compression
  std::size_t other = 0;           ///< what is left of the file: the other JSON, padding, what nothing refers to
};

/// Divides `file_bytes`, the size of the document's file. Bytes that two parts use count in both; `other` is then
/// smaller, but never below 0. Throws as total_cost.
ByteParts byte_parts(const Document& document, std::size_t file_bytes);

}  // namespace nmc::gltf
