// Reads the elements of an accessor of a typed model (glTF 2.0, sections 3.6.2 and 3.11).
#pragma once

#include <vector>

#include "gltf/json_text.h"
#include "gltf/typed_model.h"

namespace nmc::gltf {

/// Numbers per element.
int width_of(const tinygltf::Accessor& accessor);

/// All elements as floats, count * width numbers: normalized integers as glTF 2.0, section 3.11 decodes them, other
/// integers as they are (exact up to 24 bits), strides, sparse replacements, zeros where there is no buffer view;
/// matrices column by column without padding. Throws Error (invalid_input): a number that is not finite, sparse indices
/// that do not increase or lie outside.
std::vector<float> read_floats(const tinygltf::Model& model, int accessor, const std::string& file_name);

}  // namespace nmc::gltf
