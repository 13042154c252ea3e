// Channels that say nothing: what they move is where it would be without them, in every animation of the file.
#pragma once

#include <set>
#include <utility>

#include "base/animation.h"
#include "gltf/asset.h"
#include "gltf/document.h"
#include "motion/skeleton.h"

namespace nmc::codec {

/// A property of a node.
using NodeProperty = std::pair<int, Path>;

/// The translations, rotations and scales that animations have channels for and that keep their node's own value in all
/// of them, but for differences that take up a small part of `tolerance` (world units) on a character of `size` world
/// units. None where a channel moves nodes by KHR_animation_pointer.
std::set<NodeProperty> resting_properties(const gltf::Document& document, const gltf::Asset& asset,
                                          const motion::Skeleton& skeleton, double tolerance, double size);

}  // namespace nmc::codec
