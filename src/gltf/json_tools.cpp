// Small helpers on JSON values that the document's editors share.
#include "gltf/json_tools.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/decimal.h"

namespace nmc::gltf {

const Json* find_member(const Json& value, std::string_view key) {
  if (!value.is_object()) return nullptr;
  for (auto member = value.begin(); member != value.end(); ++member) {
    if (member.key() == key) return &member.value();
  }
  return nullptr;
}

Json* find_member(Json& value, std::string_view key) {
  return const_cast<Json*>(find_member(static_cast<const Json&>(value), key));
}

std::optional<std::size_t> as_index(const Json& value) {
  constexpr double largest = std::min(9007199254740992.0, static_cast<double>(SIZE_MAX));
  if (!value.is_number()) return std::nullopt;
  const auto number = value.get<double>();
  if (!(number >= 0 && number <= largest) || number != std::floor(number)) return std::nullopt;
  return static_cast<std::size_t>(number);
}

std::optional<std::size_t> index_member(const Json& object, std::string_view key) {
  const Json* member = find_member(object, key);
  return member ? as_index(*member) : std::nullopt;
}

std::size_t array_size(const Json& object, std::string_view key) {
  const Json* member = find_member(object, key);
  return member && member->is_array() ? member->size() : 0;
}

Json& array_member(Json& object, const char* key) {
  Json* member = find_member(object, key);
  if (member && member->is_array()) return *member;
  return object[key] = Json::array();
}

Json& object_member(Json& object, const char* key) {
  Json* member = find_member(object, key);
  if (member && member->is_object()) return *member;
  return object[key] = Json::object();
}

Json shortest_number(float value) {
  constexpr float exact_integers = 16777216.0F;
  if (std::abs(value) <= exact_integers && value == std::floor(value)) return static_cast<std::int64_t>(value);
  return as_decimal(value);
}

}  // namespace nmc::gltf
