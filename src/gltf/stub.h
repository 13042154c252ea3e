// The one small channel that an animation keeps when all its channels went into a clip set.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "gltf/append.h"
#include "gltf/document.h"
#include "gltf/edit.h"

namespace nmc::gltf {

/// Holds a node at its rest value from the first key time of the animation to the last.
struct Stub {
  Target target;
  float start_seconds = 0;
  float end_seconds = 0;
};

/// The target that the stub of an animation moves: the first of the set's targets that the animation has too, with node
/// transforms before morph weights. Animations of one set thus mostly agree and share accessors. `taken` is not empty.
Target choose_stub_target(const Json& root, const std::vector<Target>& set_targets, const std::vector<Target>& taken);

/// The sampler of a stub: two keys (one where start and end are the same time). Equal stubs share accessors.
Json make_stub_sampler(const Json& root, const Stub& stub, FloatBlock& block);

}  // namespace nmc::gltf
