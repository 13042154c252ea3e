// JSON text to a value within limits, and checked reads of the properties of glTF objects.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "gltf/document.h"

namespace nmc::gltf {

/// Parses glTF JSON. Duplicate keys: the last one counts. Throws Error: invalid_input (a BOM, bad syntax, numbers
/// beyond double range), unsupported (nested deeper than 512, an object of more than 16384 keys).
Json parse_json(std::string_view text, const std::string& file_name);

/// An object of a document and how messages call it, such as "accessors[3]" of "fox.glb".
struct Where {
  const std::string& file_name;
  std::string object;

  /// Throws Error (invalid_input): "<file>: <object> <what>."
  [[noreturn]] void fail(const std::string& what) const;
  Where at(std::string_view property) const;                 ///< "accessors[3].sparse"
  Where at(std::string_view list, std::size_t index) const;  ///< "meshes[0].primitives[2]"
};

/// The member of an object, nullptr when absent.
const Json* find(const Json& object, const char* key);

/// The root list `key` (such as "accessors"), nullptr when absent. Throws when it is not an array of objects.
const Json* find_list(const Json& root, const char* key, const std::string& file_name);

/// The number of elements of a root list, 0 when absent; the elements are not looked at.
std::size_t list_size(const Json& root, const char* key, const std::string& file_name);

/// A non-negative integer at most 2^53 - 1 (also when written as 3.0); empty when absent.
std::optional<std::uint64_t> find_unsigned(const Json& object, const char* key, const Where& where);

/// The same, required.
std::uint64_t get_unsigned(const Json& object, const char* key, const Where& where);

/// An index below `count`; empty when absent.
std::optional<std::size_t> find_index(const Json& object, const char* key, std::size_t count, const Where& where);

/// The same, required.
std::size_t get_index(const Json& object, const char* key, std::size_t count, const Where& where);

/// A value as an index below `count`; `what` names it in the message.
std::size_t as_index(const Json& value, std::uint64_t count, const Where& where, const std::string& what);

/// A member that must be an object or an array; nullptr when absent.
const Json* find_object(const Json& object, const char* key, const Where& where);
const Json* find_array(const Json& object, const char* key, const Where& where);

/// A string member; empty when absent.
std::optional<std::string> find_string(const Json& object, const char* key, const Where& where);

}  // namespace nmc::gltf
