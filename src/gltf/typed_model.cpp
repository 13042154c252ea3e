// Prepares a copy of a document that tinygltf reads right, and lets it.
#include "gltf/typed_model.h"

#include <fmt/format.h>

#include <cstring>
#include <limits>
#include <set>

#include "base/error.h"
#include "gltf/component.h"
#include "gltf/draco_mesh.h"
#include "gltf/glb.h"
#include "gltf/json_text.h"
#include "gltf/meshopt.h"
#include "gltf/validate.h"

namespace nmc::gltf {
namespace {

/// tinygltf keeps some offsets as int.
constexpr std::size_t most_bytes = std::numeric_limits<std::int32_t>::max();

bool is_skinning(const std::string& semantic) {
  return semantic == "POSITION" || semantic.starts_with("JOINTS_") || semantic.starts_with("WEIGHTS_");
}

std::size_t index_of(const Json& value) { return static_cast<std::size_t>(value.get<double>()); }

/// The copy while it is built.
class Preparation {
 public:
  Preparation(const Document& document, Contents contents) : document_(document), contents_(contents) {}

  TypedModel run();

 private:
  void copy_nodes();
  void copy_meshes();
  Json copy_primitive(const Json& primitive, const Where& where);
  Json copy_attributes(const Json& attributes);
  void unpack_draco_into(Json& attributes, const Json& primitive, const Where& where);
  void copy_skins();
  void copy_animations();
  void copy_accessors();
  void copy_views();
  void append(std::span<const std::uint8_t> bytes);
  Json need(const Json& accessor);
  const Json& list(const char* key) const;

  const Document& document_;
  Contents contents_;
  Json json_ = {{"asset", {{"version", "2.0"}}}};
  Bytes bytes_;
  std::set<std::size_t> accessors_;    ///< that are read
  std::set<std::size_t> views_;        ///< that those need
  std::vector<DracoAttribute> draco_;  ///< become accessors after the file's own
  std::vector<std::vector<int>> channel_numbers_;
};

const Json& Preparation::list(const char* key) const {
  static const Json nothing = Json::array();
  const Json* found = find(document_.json, key);
  return found == nullptr ? nothing : *found;
}

/// Marks an accessor as read and gives its number.
Json Preparation::need(const Json& accessor) {
  const std::size_t index = index_of(accessor);
  accessors_.insert(index);
  return index;
}

void Preparation::copy_nodes() {
  for (const Json& node : list("nodes")) {
    Json copy = Json::object();
    for (const char* key : {"name", "translation", "rotation", "scale", "matrix", "weights"}) {
      if (const Json* value = find(node, key)) copy[key] = *value;
    }
    for (const char* key : {"mesh", "skin"}) {
      if (const Json* value = find(node, key)) copy[key] = index_of(*value);
    }
    if (const Json* children = find(node, "children")) {
      for (const Json& child : *children) copy["children"].push_back(index_of(child));
    }
    json_["nodes"].push_back(std::move(copy));
  }
}

Json Preparation::copy_attributes(const Json& attributes) {
  Json copy = Json::object();
  if (contents_ == Contents::animation) return copy;
  for (const auto& [semantic, accessor] : attributes.items()) {
    if (is_skinning(semantic)) copy[semantic] = need(accessor);
  }
  return copy;
}

void Preparation::unpack_draco_into(Json& attributes, const Json& primitive, const Where& where) {
  for (DracoAttribute& attribute : unpack_draco(document_, primitive, is_skinning, where)) {
    attributes[attribute.semantic] = list("accessors").size() + draco_.size();
    draco_.push_back(std::move(attribute));
  }
}

Json Preparation::copy_primitive(const Json& primitive, const Where& where) {
  Json copy;
  const Json* extensions = find(primitive, "extensions");
  const Json* draco = extensions == nullptr ? nullptr : find(*extensions, "KHR_draco_mesh_compression");
  if (draco == nullptr || contents_ == Contents::animation) {
    copy["attributes"] = copy_attributes(primitive["attributes"]);
    if (contents_ == Contents::drawing) {
      if (const Json* indices = find(primitive, "indices")) copy["indices"] = need(*indices);
      if (const Json* mode = find(primitive, "mode")) copy["mode"] = *mode;
    }
  } else {
    Json attributes = primitive["attributes"];
    for (const auto& [semantic, id] : (*draco)["attributes"].items()) attributes.erase(semantic);
    copy["attributes"] = copy_attributes(attributes);
    unpack_draco_into(copy["attributes"], primitive, where);
  }
  if (const Json* targets = find(primitive, "targets")) {
    for (const Json& target : *targets) copy["targets"].push_back(copy_attributes(target));
  }
  return copy;
}

void Preparation::copy_meshes() {
  for (std::size_t i = 0; i < list("meshes").size(); ++i) {
    const Json& mesh = list("meshes")[i];
    const Where where{document_.name, fmt::format("meshes[{}]", i)};
    Json copy = Json::object();
    for (std::size_t p = 0; p < mesh["primitives"].size(); ++p) {
      copy["primitives"].push_back(copy_primitive(mesh["primitives"][p], where.at("primitives", p)));
    }
    if (const Json* weights = find(mesh, "weights")) copy["weights"] = *weights;
    json_["meshes"].push_back(std::move(copy));
  }
}

void Preparation::copy_skins() {
  for (const Json& skin : list("skins")) {
    Json copy = Json::object();
    for (const Json& joint : skin["joints"]) copy["joints"].push_back(index_of(joint));
    // tinygltf calls it an error when a skin leaves out this optional property.
    const Json* matrices = find(skin, "inverseBindMatrices");
    copy["inverseBindMatrices"] = matrices == nullptr ? Json(-1) : need(*matrices);
    json_["skins"].push_back(std::move(copy));
  }
}

void Preparation::copy_animations() {
  for (const Json& animation : list("animations")) {
    Json copy = Json::object();
    if (const Json* name = find(animation, "name")) copy["name"] = *name;
    std::vector<int> numbers;
    std::set<std::size_t> samplers;
    const Json& channels = animation["channels"];
    for (std::size_t c = 0; c < channels.size() && contents_ == Contents::animation; ++c) {
      const Json& target = channels[c]["target"];
      const Json* node = find(target, "node");
      if (node == nullptr) continue;
      const std::size_t sampler = index_of(channels[c]["sampler"]);
      samplers.insert(sampler);
      copy["channels"].push_back(
          {{"sampler", sampler}, {"target", {{"node", index_of(*node)}, {"path", target["path"]}}}});
      numbers.push_back(static_cast<int>(c));
    }
    for (std::size_t s = 0; s < animation["samplers"].size(); ++s) {
      const Json& sampler = animation["samplers"][s];
      const bool is_read = samplers.contains(s);
      Json sampler_copy = {{"input", is_read ? need(sampler["input"]) : Json(0)},
                           {"output", is_read ? need(sampler["output"]) : Json(0)}};
      if (const Json* interpolation = find(sampler, "interpolation")) sampler_copy["interpolation"] = *interpolation;
      copy["samplers"].push_back(std::move(sampler_copy));
    }
    json_["animations"].push_back(std::move(copy));
    channel_numbers_.push_back(std::move(numbers));
  }
}

void Preparation::copy_accessors() {
  const Json placeholder = {{"componentType", 5126}, {"count", 1}, {"type", "SCALAR"}};
  const Json& accessors = list("accessors");
  for (std::size_t i = 0; i < accessors.size(); ++i) {
    if (!accessors_.contains(i)) {
      json_["accessors"].push_back(placeholder);
      continue;
    }
    const Json& accessor = accessors[i];
    Json copy = {{"componentType", index_of(accessor["componentType"])},
                 {"count", index_of(accessor["count"])},
                 {"type", accessor["type"]}};
    if (element_bytes(accessor["type"].get_ref<const std::string&>(), copy["componentType"].get<std::uint64_t>()) ==
        0) {
      Where{document_.name, fmt::format("accessors[{}]", i)}.fail("has a type that glTF 2.0 does not know");
    }
    const auto need_view = [this](Json& to, const Json& from) {
      const std::size_t view = index_of(from["bufferView"]);
      views_.insert(view);
      to["bufferView"] = view;
      if (const Json* offset = find(from, "byteOffset")) to["byteOffset"] = index_of(*offset);
    };
    if (find(accessor, "bufferView") != nullptr) need_view(copy, accessor);
    if (const Json* normalized = find(accessor, "normalized")) copy["normalized"] = *normalized;
    if (const Json* sparse = find(accessor, "sparse")) {
      Json indices = {{"componentType", index_of((*sparse)["indices"]["componentType"])}};
      Json values = Json::object();
      need_view(indices, (*sparse)["indices"]);
      need_view(values, (*sparse)["values"]);
      copy["sparse"] = {
          {"count", index_of((*sparse)["count"])}, {"indices", std::move(indices)}, {"values", std::move(values)}};
    }
    json_["accessors"].push_back(std::move(copy));
  }
}

void Preparation::append(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > most_bytes - bytes_.size()) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{} holds more than 2 GiB of animation or mesh data.", document_.name));
  }
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

void Preparation::copy_views() {
  const Json& views = list("bufferViews");
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!views_.contains(i)) {
      json_["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 4}});
      continue;
    }
    const std::size_t start = bytes_.size();
    const std::optional<Bytes> unpacked = unpack_meshopt(document_, i);
    append(unpacked ? std::span<const std::uint8_t>(*unpacked) : stored_view(document_, i));
    Json copy = {{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes_.size() - start}};
    if (const Json* stride = find(views[i], "byteStride")) copy["byteStride"] = index_of(*stride);
    json_["bufferViews"].push_back(std::move(copy));
  }
  for (const DracoAttribute& attribute : draco_) {
    const std::size_t start = bytes_.size();
    append({reinterpret_cast<const std::uint8_t*>(attribute.values.data()), attribute.values.size() * sizeof(float)});
    json_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes_.size() - start}});
    json_["accessors"].push_back({{"bufferView", json_["bufferViews"].size() - 1},
                                  {"componentType", 5126},
                                  {"count", attribute.values.size() / static_cast<std::size_t>(attribute.width)},
                                  {"type", attribute.width == 3 ? "VEC3" : "VEC4"}});
  }
}

TypedModel Preparation::run() {
  copy_nodes();
  copy_meshes();
  copy_skins();
  copy_animations();
  copy_accessors();
  bytes_.resize(4);  // what placeholders point at; it also makes the buffer non-empty
  copy_views();
  json_["buffers"].push_back({{"byteLength", bytes_.size()}});
  const Bytes glb = join_glb(json_.dump(), std::span<const std::uint8_t>(bytes_), {}, document_.name);

  TypedModel typed;
  typed.channel_numbers = std::move(channel_numbers_);
  tinygltf::TinyGLTF loader;
  std::string error;
  std::string warning;
  const bool loaded =
      loader.LoadBinaryFromMemory(&typed.model, &error, &warning, glb.data(), static_cast<unsigned>(glb.size()));
  if (!loaded || !error.empty()) {
    throw Error(ErrorCode::internal,
                fmt::format("{}: tinygltf refuses the prepared copy of this file: {}", document_.name, error));
  }
  return typed;
}

}  // namespace

TypedModel typed_model(const Document& document, Contents contents) {
  validate(document);
  return Preparation(document, contents).run();
}

}  // namespace nmc::gltf
