// Small files with the less usual things that glTF animations may hold, for tests.
#pragma once

#include <cstdint>
#include <vector>

namespace nmc::samples {

/// Nodes without skin (a fan in full turns, a ball that bounces and squashes), morph weights, CUBICSPLINE and STEP
/// samplers, constants of two keys, a clip that starts after 0 s, extras, an embedded image, names beyond ASCII.
std::vector<std::uint8_t> make_props();

/// A fan and an extension that no tool knows, on the root, on a node and on the animation.
std::vector<std::uint8_t> make_unknown_extension();

}  // namespace nmc::samples
