// Small helpers on JSON values that the document's editors share.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "gltf/document.h"

namespace nmc::gltf {

/// The member `key` of an object, or null where `value` is no object or has no such member.
const Json* find_member(const Json& value, std::string_view key);
Json* find_member(Json& value, std::string_view key);

/// A glTF index: a number without fraction, not negative, at most 2^53. Nothing for any other value.
std::optional<std::size_t> as_index(const Json& value);

/// The member `key` as an index, nothing where it is missing or no index.
std::optional<std::size_t> index_member(const Json& object, std::string_view key);

/// How many elements the array `key` of an object has; 0 where there is none.
std::size_t array_size(const Json& object, std::string_view key);

/// The member `key`, appended as the empty array (or object) where it is missing.
Json& array_member(Json& object, const char* key);
Json& object_member(Json& object, const char* key);

/// The shortest decimal that reads back as the same float, as a JSON integer where it is one.
Json shortest_number(float value);

}  // namespace nmc::gltf
