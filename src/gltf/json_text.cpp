// Parses JSON within limits and reads properties with checks.
#include "gltf/json_text.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "base/error.h"

namespace nmc::gltf {
namespace {

constexpr std::size_t deepest_nesting = 512;
constexpr std::size_t most_keys = 16384;

/// Values are destroyed and printed recursively, and ordered objects search their keys one by one, so both sizes are
/// bounded before anything is built. Wrong syntax is left for the parser to find.
void check_limits(std::string_view text, const std::string& file_name) {
  std::vector<std::size_t> colons;  // per open bracket
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      colons.push_back(0);
      if (colons.size() > deepest_nesting) {
        throw Error(ErrorCode::unsupported,
                    fmt::format("{}: the JSON is nested deeper than {} levels.", file_name, deepest_nesting));
      }
    } else if ((c == '}' || c == ']') && !colons.empty()) {
      colons.pop_back();
    } else if (c == ':' && !colons.empty() && ++colons.back() > most_keys) {
      throw Error(ErrorCode::unsupported,
                  fmt::format("{}: the JSON has an object with more than {} keys.", file_name, most_keys));
    }
  }
}

/// A non-negative integer that double holds exactly; empty for anything else.
std::optional<std::uint64_t> to_unsigned(const Json& value) {
  constexpr double largest = 9007199254740991.0;
  if (!value.is_number()) return std::nullopt;
  const double number = value.get<double>();
  if (!(number >= 0) || number > largest || number != std::floor(number)) return std::nullopt;
  return static_cast<std::uint64_t>(number);
}

}  // namespace

Json parse_json(std::string_view text, const std::string& file_name) {
  if (text.starts_with("\xEF\xBB\xBF")) {
    throw Error(ErrorCode::invalid_input,
                fmt::format("{}: the JSON starts with a byte order mark, which glTF forbids.", file_name));
  }
  check_limits(text, file_name);
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    throw Error(ErrorCode::invalid_input,
                fmt::format("{}: the JSON is broken at byte {} of {}.", file_name, error.byte, text.size()));
  } catch (const Json::exception&) {
    throw Error(ErrorCode::invalid_input, fmt::format("{}: the JSON holds a number that is out of range.", file_name));
  }
}

void Where::fail(const std::string& what) const {
  throw Error(ErrorCode::invalid_input, fmt::format("{}: {} {}.", file_name, object, what));
}

Where Where::at(std::string_view property) const { return {file_name, fmt::format("{}.{}", object, property)}; }

Where Where::at(std::string_view list, std::size_t index) const {
  return {file_name, fmt::format("{}.{}[{}]", object, list, index)};
}

const Json* find(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

const Json* find_list(const Json& root, const char* key, const std::string& file_name) {
  const Json* list = find(root, key);
  if (list == nullptr) return nullptr;
  if (!list->is_array()) throw Error(ErrorCode::invalid_input, fmt::format("{}: {} is not an array.", file_name, key));
  for (std::size_t i = 0; i < list->size(); ++i) {
    if (!(*list)[i].is_object()) {
      throw Error(ErrorCode::invalid_input, fmt::format("{}: {}[{}] is not an object.", file_name, key, i));
    }
  }
  return list;
}

std::size_t list_size(const Json& root, const char* key, const std::string& file_name) {
  const Json* list = find(root, key);
  if (list == nullptr) return 0;
  if (!list->is_array()) throw Error(ErrorCode::invalid_input, fmt::format("{}: {} is not an array.", file_name, key));
  return list->size();
}

std::optional<std::uint64_t> find_unsigned(const Json& object, const char* key, const Where& where) {
  const Json* value = find(object, key);
  if (value == nullptr) return std::nullopt;
  const std::optional<std::uint64_t> number = to_unsigned(*value);
  if (!number) where.fail(fmt::format("has a {} that is not a non-negative integer", key));
  return number;
}

std::uint64_t get_unsigned(const Json& object, const char* key, const Where& where) {
  const std::optional<std::uint64_t> value = find_unsigned(object, key, where);
  if (!value) where.fail(fmt::format("has no {}", key));
  return *value;
}

std::size_t as_index(const Json& value, std::uint64_t count, const Where& where, const std::string& what) {
  const std::optional<std::uint64_t> index = to_unsigned(value);
  if (!index) where.fail(fmt::format("has a {} that is not an index", what));
  if (*index >= count) where.fail(fmt::format("refers to {} {}, but there are only {}", what, *index, count));
  return static_cast<std::size_t>(*index);
}

std::optional<std::size_t> find_index(const Json& object, const char* key, std::size_t count, const Where& where) {
  const Json* value = find(object, key);
  if (value == nullptr) return std::nullopt;
  return as_index(*value, count, where, key);
}

std::size_t get_index(const Json& object, const char* key, std::size_t count, const Where& where) {
  const std::optional<std::size_t> index = find_index(object, key, count, where);
  if (!index) where.fail(fmt::format("has no {}", key));
  return *index;
}

const Json* find_object(const Json& object, const char* key, const Where& where) {
  const Json* value = find(object, key);
  if (value != nullptr && !value->is_object()) where.fail(fmt::format("has {} that is not an object", key));
  return value;
}

const Json* find_array(const Json& object, const char* key, const Where& where) {
  const Json* value = find(object, key);
  if (value != nullptr && !value->is_array()) where.fail(fmt::format("has {} that is not an array", key));
  return value;
}

std::optional<std::string> find_string(const Json& object, const char* key, const Where& where) {
  const Json* value = find(object, key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_string()) where.fail(fmt::format("has {} that is not a string", key));
  return value->get<std::string>();
}

}  // namespace nmc::gltf
