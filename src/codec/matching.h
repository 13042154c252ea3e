// Which animation of one file is which of another.
#pragma once

#include <vector>

#include "base/animation.h"
#include "gltf/asset.h"
#include "gltf/document.h"

namespace nmc::codec {

/// Throws Error (invalid_input) where the second file does not have the nodes of the first.
void check_nodes(const gltf::Document& a, const gltf::Asset& original, const gltf::Document& b,
                 const gltf::Asset& other);

/// The animation of the other file that animation `index` of the original has become: by index and name, by name, by
/// index. Throws Error (invalid_input) where there is none.
std::size_t find_match(const gltf::Document& a, const std::vector<Animation>& original, const gltf::Document& b,
                       const std::vector<Animation>& other, std::size_t index);

}  // namespace nmc::codec
