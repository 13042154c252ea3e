// Turns the animations of a typed model into curves, or says why a channel stays as it is.
#pragma once

#include "gltf/asset.h"
#include "gltf/typed_model.h"

namespace nmc::gltf {

/// Reads all animations; `nodes` are the asset's. Throws Error (invalid_input) naming the sampler or channel.
std::vector<AnimationSource> read_animations(const Document& document, const TypedModel& typed,
                                             const std::vector<Node>& nodes);

}  // namespace nmc::gltf
