// Checks of a document's structure: everything that the typed view relies on. Bytes are looked at when they are read.
#pragma once

#include "gltf/document.h"

namespace nmc::gltf {

/// Checks buffer views, accessors, nodes, scenes, meshes, skins and animations: types, indices, ranges, sizes, the node
/// hierarchy. What the Khronos validator calls an error there is one here too, except for rules that only graphics
/// hardware needs (alignment, target, bounds). Throws Error (invalid_input) naming the object.
void validate(const Document& document);

/// The parts of it.
void validate_accessors(const Document& document);
void validate_nodes(const Document& document);
void validate_meshes(const Document& document);
void validate_animations(const Document& document);

}  // namespace nmc::gltf
