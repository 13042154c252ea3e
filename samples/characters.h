// The sample characters: rigged, skinned, animated glTF files made from nothing, for tests, demos and benchmarks.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace nmc::samples {

/// What a sample file is called and what is in it.
struct CharacterInfo {
  std::string file_name;    ///< e.g. "humanoid_30hz.glb"
  std::string description;  ///< one line
};

/// All sample files, in the order in which `make_characters` writes them.
std::vector<CharacterInfo> list_characters();

/// The GLB bytes of one sample file; the same bytes on every call. Throws std::invalid_argument for a name that is not
/// listed.
std::vector<std::uint8_t> make_character(std::string_view file_name);

}  // namespace nmc::samples
