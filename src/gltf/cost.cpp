// What a document's animations cost in bytes, counted as the referee counts (tools/measure.py, payload).
#include "gltf/cost.h"

#include <array>
#include <charconv>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "base/error.h"
#include "gltf/edit.h"
#include "gltf/json_tools.h"

namespace nmc::gltf {
namespace {

/// What the animations use, each object with the animations that use it in ascending order.
struct Users {
  std::map<std::size_t, std::set<std::size_t>> accessors;
  std::map<std::size_t, std::set<std::size_t>> views;
};

[[noreturn]] void refuse(const Document& document, const std::string& what) {
  throw Error(ErrorCode::invalid_input, document.name + ": " + what + "; repair the file first");
}

const Json& object_at(const Document& document, const char* list, std::size_t index) {
  if (index >= array_size(document.json, list)) {
    refuse(document,
           std::string("an animation refers to ") + list + "[" + std::to_string(index) + "], which does not exist");
  }
  return document.json[list][index];
}

std::size_t number_of(const Document& document, const Json& object, const char* key, const std::string& owner) {
  const auto number = index_member(object, key);
  if (!number) refuse(document, owner + " has no valid " + key);
  return *number;
}

std::size_t component_bytes(std::size_t component_type) {
  switch (component_type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

std::size_t component_count(std::string_view type) {
  static const std::map<std::string_view, std::size_t> counts = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                                 {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
  const auto found = counts.find(type);
  return found == counts.end() ? 0 : found->second;
}

/// The meshopt object of a bufferView, null for an ordinary one.
const Json* packed_form(const Json& view) {
  const Json* extensions = find_member(view, "extensions");
  if (!extensions) return nullptr;
  for (const auto* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    if (const Json* packed = find_member(*extensions, name)) return packed;
  }
  return nullptr;
}

std::size_t stored_length(const Document& document, std::size_t view) {
  const Json& object = object_at(document, "bufferViews", view);
  const Json* packed = packed_form(object);
  return number_of(document, packed ? *packed : object, "byteLength", "bufferViews[" + std::to_string(view) + "]");
}

/// The bufferViews that an accessor reads.
std::vector<std::size_t> views_of(const Json& accessor) {
  std::vector<std::size_t> views;
  const auto add = [&views](const Json& object) {
    if (const auto view = index_member(object, "bufferView")) views.push_back(*view);
  };
  add(accessor);
  if (const Json* sparse = find_member(accessor, "sparse")) {
    for (const auto* key : {"indices", "values"}) {
      if (const Json* part = find_member(*sparse, key)) add(*part);
    }
  }
  return views;
}

bool is_packed(const Document& document, std::size_t view) {
  return packed_form(object_at(document, "bufferViews", view)) != nullptr;
}

/// Bytes of an accessor's own elements; those in compressed bufferViews count with the view.
std::size_t accessor_bytes(const Document& document, std::size_t index) {
  const Json& accessor = object_at(document, "accessors", index);
  const std::string owner = "accessors[" + std::to_string(index) + "]";
  const Json* type = find_member(accessor, "type");
  const std::size_t size = component_bytes(number_of(document, accessor, "componentType", owner)) *
                           component_count(type && type->is_string() ? type->get_ref<const std::string&>() : "");
  if (size == 0) refuse(document, owner + " has no valid componentType and type");
  std::size_t bytes = 0;
  if (const auto view = index_member(accessor, "bufferView"); view && !is_packed(document, *view)) {
    bytes += size * number_of(document, accessor, "count", owner);
  }
  const Json* sparse = find_member(accessor, "sparse");
  const Json* indices = sparse ? find_member(*sparse, "indices") : nullptr;
  if (indices && !is_packed(document, number_of(document, *indices, "bufferView", owner + ".sparse.indices"))) {
    const std::size_t one = component_bytes(number_of(document, *indices, "componentType", owner + ".sparse.indices"));
    bytes += number_of(document, *sparse, "count", owner + ".sparse") * (one + size);
  }
  return bytes;
}

Users find_users(const Document& document) {
  Users users;
  for (std::size_t i = 0; i < array_size(document.json, "animations"); ++i) {
    const Json& animation = document.json["animations"][i];
    for (std::size_t k = 0; k < array_size(animation, "samplers"); ++k) {
      for (const auto* key : {"input", "output"}) {
        const auto accessor = index_member(animation["samplers"][k], key);
        if (accessor) users.accessors[*accessor].insert(i);
      }
    }
  }
  for (const auto& [accessor, animations] : users.accessors) {
    for (const auto view : views_of(object_at(document, "accessors", accessor))) {
      users.views[view].insert(animations.begin(), animations.end());
    }
  }
  return users;
}

/// The bufferViews that `value` names anywhere as "bufferView".
void add_named_views(const Json& value, std::set<std::size_t>& views) {
  std::vector<const Json*> open{&value};
  while (!open.empty()) {
    const Json& part = *open.back();
    open.pop_back();
    if (!part.is_structured()) continue;
    for (auto member = part.begin(); member != part.end(); ++member) {
      if (part.is_object() && member.key() == "bufferView" && member.value().is_number_integer()) {
        if (const auto view = as_index(member.value())) views.insert(*view);
      } else {
        open.push_back(&member.value());
      }
    }
  }
}

/// The length of the shortest decimal that reads back as `value`, with a point or an exponent.
std::size_t shortest_length(double value) {
  std::array<char, 32> text{};
  const char* end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific).ptr;
  const std::string_view all(text.data(), static_cast<std::size_t>(end - text.data()));
  const std::size_t sign = all.front() == '-' ? 1 : 0;
  const auto mantissa = all.substr(sign, all.find('e') - sign);
  const std::size_t digits = mantissa.size() == 1 ? 1 : mantissa.size() - 1;
  int exponent = 0;
  std::from_chars(text.data() + all.find('e') + (all[all.find('e') + 1] == '+' ? 2 : 1), end, exponent);
  if (exponent < -4 || exponent >= 16) return all.size();
  if (exponent < 0) return sign + 1 + static_cast<std::size_t>(-exponent) + digits;
  const auto whole = static_cast<std::size_t>(exponent) + 1;
  return sign + (digits <= whole ? whole + 2 : digits + 1);
}

/// Minified, ASCII only. The JSON library sometimes writes a digit more than a number needs; that is not counted.
std::size_t text_bytes(const Json& value) {
  std::size_t bytes = value.dump(-1, ' ', true).size();
  std::vector<const Json*> open{&value};
  while (!open.empty()) {
    const Json& part = *open.back();
    open.pop_back();
    if (part.is_number_float()) bytes = bytes - part.dump().size() + shortest_length(part.get<double>());
    if (!part.is_structured()) continue;
    for (const auto& element : part) open.push_back(&element);
  }
  return bytes;
}

const Json* root_extension(const Document& document) {
  const Json* extensions = find_member(document.json, "extensions");
  const Json* extension = extensions ? find_member(*extensions, extension_name) : nullptr;
  return extension && !extension->empty() ? extension : nullptr;
}

void divide(std::size_t amount, const std::set<std::size_t>& users, std::vector<AnimationCost>& costs,
            std::size_t AnimationCost::*kind) {
  std::size_t rest = amount % users.size();
  for (const auto user : users) {
    costs[user].*kind += amount / users.size() + (rest > 0 ? 1 : 0);
    if (rest > 0) --rest;
  }
}

}  // namespace

AnimationCost total_cost(const Document& document) {
  const auto users = find_users(document);
  AnimationCost cost;
  std::set<std::size_t> views;
  std::set<std::size_t> streams;
  const Json* animations = find_member(document.json, "animations");
  cost.json_bytes += animations ? text_bytes(*animations) : text_bytes(Json::array());
  if (const Json* extension = root_extension(document)) {
    cost.json_bytes += text_bytes(*extension);
    add_named_views(*extension, streams);
  }
  for (std::size_t i = 0; animations && i < animations->size(); ++i) {
    if (const Json* extensions = find_member((*animations)[i], "extensions")) add_named_views(*extensions, streams);
  }
  for (const auto& [accessor, used_by] : users.accessors) {
    cost.key_bytes += accessor_bytes(document, accessor);
    cost.json_bytes += text_bytes(object_at(document, "accessors", accessor));
  }
  for (const auto& [view, used_by] : users.views) {
    views.insert(view);
    if (is_packed(document, view)) streams.insert(view);
  }
  for (const auto view : streams) cost.key_bytes += stored_length(document, view);
  views.insert(streams.begin(), streams.end());
  for (const auto view : views) cost.json_bytes += text_bytes(object_at(document, "bufferViews", view));
  return cost;
}

std::vector<AnimationCost> animation_costs(const Document& document) {
  const auto users = find_users(document);
  std::vector<AnimationCost> costs(array_size(document.json, "animations"));
  for (std::size_t i = 0; i < costs.size(); ++i) costs[i].json_bytes = text_bytes(document.json["animations"][i]);
  for (const auto& [accessor, used_by] : users.accessors) {
    divide(accessor_bytes(document, accessor), used_by, costs, &AnimationCost::key_bytes);
    divide(text_bytes(object_at(document, "accessors", accessor)), used_by, costs, &AnimationCost::json_bytes);
  }
  for (const auto& [view, used_by] : users.views) {
    if (is_packed(document, view)) divide(stored_length(document, view), used_by, costs, &AnimationCost::key_bytes);
    divide(text_bytes(object_at(document, "bufferViews", view)), used_by, costs, &AnimationCost::json_bytes);
  }
  return costs;
}

}  // namespace nmc::gltf
