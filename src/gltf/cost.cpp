// What a document's animations cost in bytes, counted as the referee counts (tools/measure.py, payload).
#include "gltf/cost.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "base/decimal.h"
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
  const char* end = write_decimal(text.data(), text.data() + text.size(), value);
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

/// The bytes of accessors and packed views that `value` names anywhere; a mesh or a skin has no other numbers under
/// these keys.
class Gathering {
 public:
  explicit Gathering(const Document& document) : document_(document) {}

  void add_accessor(const Json& value) {
    const auto accessor = as_index(value);
    if (!accessor || !accessors_.insert(*accessor).second) return;
    bytes_ += accessor_bytes(document_, *accessor);
    for (const auto view : views_of(object_at(document_, "accessors", *accessor)))
      if (is_packed(document_, view)) add_view(view);
  }

  void add_view(std::size_t view) {
    if (views_.insert(view).second) bytes_ += stored_length(document_, view);
  }

  std::size_t bytes() const { return bytes_; }

 private:
  const Document& document_;
  std::set<std::size_t> accessors_, views_;
  std::size_t bytes_ = 0;
};

void add_members(const Json* attributes, Gathering& gathering) {
  if (attributes && attributes->is_object())
    for (const auto& accessor : *attributes) gathering.add_accessor(accessor);
}

std::size_t mesh_bytes(const Document& document) {
  Gathering gathering(document);
  for (std::size_t m = 0; m < array_size(document.json, "meshes"); ++m) {
    const Json& mesh = document.json["meshes"][m];
    for (std::size_t p = 0; p < array_size(mesh, "primitives"); ++p) {
      const Json& primitive = mesh["primitives"][p];
      add_members(find_member(primitive, "attributes"), gathering);
      if (const Json* indices = find_member(primitive, "indices")) gathering.add_accessor(*indices);
      for (std::size_t t = 0; t < array_size(primitive, "targets"); ++t)
        add_members(&primitive["targets"][t], gathering);
      std::set<std::size_t> packed;  // by Draco
      if (const Json* extensions = find_member(primitive, "extensions")) add_named_views(*extensions, packed);
      for (const auto view : packed) gathering.add_view(view);
    }
  }
  for (std::size_t i = 0; i < array_size(document.json, "skins"); ++i)
    if (const Json* matrices = find_member(document.json["skins"][i], "inverseBindMatrices"))
      gathering.add_accessor(*matrices);
  return gathering.bytes();
}

std::size_t image_bytes(const Document& document) {
  Gathering gathering(document);
  std::size_t in_uris = 0;
  for (std::size_t i = 0; i < array_size(document.json, "images"); ++i) {
    const Json& image = document.json["images"][i];
    if (const auto view = index_member(image, "bufferView")) gathering.add_view(*view);
    const Json* uri = find_member(image, "uri");
    if (uri && uri->is_string() && uri->get_ref<const std::string&>().starts_with("data:"))
      in_uris += uri->get_ref<const std::string&>().size();
  }
  return gathering.bytes() + in_uris;
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

ByteParts byte_parts(const Document& document, std::size_t file_bytes) {
  const AnimationCost animation = total_cost(document);
  ByteParts parts;
  for (const ClipSetBytes& set : read_compression(document).clip_sets) parts.networks += set.stream.size();
  parts.meshes = mesh_bytes(document);
  parts.images = image_bytes(document);
  parts.keys = animation.key_bytes - std::min(animation.key_bytes, parts.networks);
  parts.animation_json = animation.json_bytes;
  const std::size_t known = parts.meshes + parts.images + parts.keys + parts.animation_json + parts.networks;
  parts.other = file_bytes - std::min(file_bytes, known);
  return parts;
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
