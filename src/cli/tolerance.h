// The tolerance as users write it: "0.1%" of the character's size, or a length with its unit.
#pragma once

#include <string>

#include "codec/compress.h"

namespace nmc::cli {

/// Reads "0.5%" (of the character's size, above 0 to 100), "2mm", "1cm" or "0.01m" (glTF's units are metres).
/// Throws Error (usage) with a sentence that says which units exist.
codec::Tolerance parse_tolerance(const std::string& text);

/// The tolerance in world units for a character of this size.
double in_world_units(const codec::Tolerance& tolerance, double size);

}  // namespace nmc::cli
