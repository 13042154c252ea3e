// Tolerances and channels as users write them: "0.1%" of the character's size, or a length with its unit, for all or
// for what patterns name.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "codec/rules.h"

namespace nmc::cli {

/// Reads "0.5%" (of the character's size, above 0 to 100), "2mm", "1cm" or "0.01m" (glTF's units are metres).
/// Throws Error (usage) with a sentence that says which units exist and starts with `option`.
codec::Tolerance parse_tolerance(const std::string& text, const std::string& option = "--tolerance");

/// Reads "joint=*Hand*,clip=Run*,channel=rotation": at least one of the three, each at most once; a part without a key
/// is a pattern for joints. Throws Error (usage).
codec::Selector parse_selector(const std::string& text, const std::string& option);

/// "rotation", "translation", "scale" or "weights". Throws Error (usage).
Path parse_channel(const std::string& text, const std::string& option);

/// One tolerance for all and exceptions from it.
struct Tolerances {
  codec::Tolerance all;
  bool has_all = false;  ///< whether the user named it
  std::vector<codec::ToleranceRule> rules;
};

/// Reads the values of --tolerance: "AMOUNT", or "AMOUNT,SELECTOR" for an exception. Throws Error (usage), also where
/// two are for all.
Tolerances parse_tolerances(const std::vector<std::string>& texts);

/// Reads "40KB", "1.5MB", "800B" (1 KB is 1000 bytes). Throws Error (usage).
std::size_t parse_byte_count(const std::string& text, const std::string& option);

}  // namespace nmc::cli
