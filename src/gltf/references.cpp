// Where a document's JSON refers to accessors, bufferViews and buffers, in core glTF and in the known extensions.
#include "gltf/references.h"

#include <array>
#include <span>
#include <string_view>

#include "base/error.h"
#include "gltf/edit.h"
#include "gltf/json_tools.h"

namespace nmc::gltf {
namespace {

/// A place of an index: member names separated by '/', '*' for every element of an array or object.
struct Place {
  ObjectKind kind;
  std::string_view path;
};

constexpr auto accessor = ObjectKind::accessor;
constexpr auto buffer_view = ObjectKind::buffer_view;
constexpr auto buffer = ObjectKind::buffer;

constexpr std::array core_places = {
    Place{accessor, "meshes/*/primitives/*/indices"},
    Place{accessor, "meshes/*/primitives/*/attributes/*"},
    Place{accessor, "meshes/*/primitives/*/targets/*/*"},
    Place{accessor, "skins/*/inverseBindMatrices"},
    Place{accessor, "animations/*/samplers/*/input"},
    Place{accessor, "animations/*/samplers/*/output"},
    Place{buffer_view, "images/*/bufferView"},
    Place{buffer_view, "accessors/*/bufferView"},
    Place{buffer_view, "accessors/*/sparse/indices/bufferView"},
    Place{buffer_view, "accessors/*/sparse/values/bufferView"},
    Place{buffer, "bufferViews/*/buffer"},
};

/// A place inside an extension's object, wherever that object stands.
struct ExtensionPlace {
  std::string_view extension;
  Place place;
};

constexpr std::array extension_places = {
    ExtensionPlace{"NMC_animation_compression", {buffer_view, "clipSets/*/bufferView"}},
    ExtensionPlace{"KHR_draco_mesh_compression", {buffer_view, "bufferView"}},
    ExtensionPlace{"EXT_meshopt_compression", {buffer, "buffer"}},
    ExtensionPlace{"KHR_meshopt_compression", {buffer, "buffer"}},
    ExtensionPlace{"EXT_mesh_gpu_instancing", {accessor, "attributes/*"}},
    ExtensionPlace{"EXT_structural_metadata", {buffer_view, "propertyTables/*/properties/*/values"}},
    ExtensionPlace{"EXT_structural_metadata", {buffer_view, "propertyTables/*/properties/*/arrayOffsets"}},
    ExtensionPlace{"EXT_structural_metadata", {buffer_view, "propertyTables/*/properties/*/stringOffsets"}},
    ExtensionPlace{"EXT_feature_metadata", {buffer_view, "featureTables/*/properties/*/bufferView"}},
    ExtensionPlace{"EXT_feature_metadata", {buffer_view, "featureTables/*/properties/*/arrayOffsetBufferView"}},
    ExtensionPlace{"EXT_feature_metadata", {buffer_view, "featureTables/*/properties/*/stringOffsetBufferView"}},
    ExtensionPlace{"KHR_audio", {buffer_view, "audio/*/bufferView"}},
    ExtensionPlace{"KHR_audio_emitter", {buffer_view, "audio/*/bufferView"}},
    ExtensionPlace{"MSFT_audio_emitter", {buffer_view, "clips/*/bufferView"}},
    ExtensionPlace{"KHR_techniques_webgl", {buffer_view, "shaders/*/bufferView"}},
    ExtensionPlace{"CESIUM_primitive_outline", {accessor, "indices"}},
};

/// Extensions that refer to no accessor, bufferView or buffer. A final '*' stands for any ending.
constexpr std::array<std::string_view, 30> extensions_without_places = {
    "KHR_materials_*",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_lights_punctual",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "KHR_node_visibility",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_animation_pointer",
    "KHR_interactivity",
    "EXT_mesh_features",
    "EXT_instance_features",
    "EXT_lights_image_based",
    "EXT_lights_ies",
    "EXT_texture_webp",
    "EXT_texture_avif",
    "EXT_materials_bump",
    "MSFT_lod",
    "MSFT_texture_dds",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
    "ADOBE_materials_clearcoat_specular",
    "ADOBE_materials_clearcoat_tint",
    "ADOBE_materials_thin_transparency",
    "AGI_articulations",
    "AGI_stk_metadata",
    "VRM",
    "VRMC_*",
};

/// Extensions whose JSON pointers (RFC 6901) may name any object.
constexpr std::array<std::string_view, 2> extensions_with_pointers = {"KHR_animation_pointer", "KHR_interactivity"};

bool matches(std::string_view name, std::string_view pattern) {
  if (!pattern.ends_with('*')) return name == pattern;
  pattern.remove_suffix(1);
  return name.starts_with(pattern);
}

bool is_known(std::string_view name) {
  for (const auto& entry : extension_places) {
    if (entry.extension == name) return true;
  }
  for (const auto pattern : extensions_without_places) {
    if (matches(name, pattern)) return true;
  }
  return false;
}

/// Calls visit(name, object) for every extension object of the document; extras are the user's and are left out.
/// Keeps its own stack, so that deep nesting costs no call depth.
template <typename AnyJson, typename Visit>
void for_each_extension(AnyJson& root, const Visit& visit) {
  std::vector<AnyJson*> open{&root};
  while (!open.empty()) {
    AnyJson& value = *open.back();
    open.pop_back();
    if (value.is_array()) {
      for (auto& element : value) open.push_back(&element);
    } else if (value.is_object()) {
      for (auto member = value.begin(); member != value.end(); ++member) {
        if (member.key() == "extras") continue;
        if (member.key() == "extensions" && member.value().is_object()) {
          for (auto part = member.value().begin(); part != member.value().end(); ++part)
            visit(part.key(), part.value());
        }
        open.push_back(&member.value());
      }
    }
  }
}

/// Calls visit(value) for every value at `path` below `value`. As deep as the path is long.
template <typename Visit>
void for_each_at(Json& value, std::string_view path, const Visit& visit) {
  if (path.empty()) return visit(value);
  const auto slash = path.find('/');
  const auto head = path.substr(0, slash);
  const auto rest = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
  if (head == "*") {
    if (!value.is_structured()) return;
    for (auto& element : value) for_each_at(element, rest, visit);
  } else if (Json* member = find_member(value, head)) {
    for_each_at(*member, rest, visit);
  }
}

/// Whether a string below `value` is a JSON pointer to something that renumbering moves.
bool points_at_numbered_object(const Json& value) {
  std::vector<const Json*> open{&value};
  while (!open.empty()) {
    const Json& part = *open.back();
    open.pop_back();
    if (part.is_structured()) {
      for (const auto& element : part) open.push_back(&element);
    } else if (part.is_string()) {
      const auto& text = part.get_ref<const std::string&>();
      for (const auto* prefix : {"/accessors/", "/bufferViews/", "/buffers/"}) {
        if (text.starts_with(prefix)) return true;
      }
      if (text.starts_with("/animations/") && text.find("/samplers") != std::string::npos) return true;
    }
  }
  return false;
}

void add_once(std::vector<std::string>& list, const std::string& entry) {
  for (const auto& present : list) {
    if (present == entry) return;
  }
  list.push_back(entry);
}

}  // namespace

const char* array_name(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::accessor:
      return "accessors";
    case ObjectKind::buffer_view:
      return "bufferViews";
    case ObjectKind::buffer:
      return "buffers";
  }
  return "";
}

std::vector<Reference> find_references(Document& document) {
  const std::array<std::size_t, 3> counts = {array_size(document.json, "accessors"),
                                             array_size(document.json, "bufferViews"), document.buffers.size()};
  std::vector<Reference> found;
  const auto collect = [&](Json& object, const Place& place, std::string_view owner) {
    for_each_at(object, place.path, [&](Json& value) {
      if (!value.is_number()) return;
      const auto index = as_index(value);
      if (!index || *index >= counts[static_cast<std::size_t>(place.kind)]) {
        throw Error(ErrorCode::invalid_input, document.name + ": " + std::string(owner) + std::string(place.path) +
                                                  " holds " + value.dump() + ", which is no index into " +
                                                  array_name(place.kind) + "; repair the file first");
      }
      found.push_back({place.kind, &value});
    });
  };
  for (const auto& place : core_places) collect(document.json, place, "");
  for_each_extension(document.json, [&](std::string_view name, Json& object) {
    for (const auto& entry : extension_places) {
      if (entry.extension == name) collect(object, entry.place, std::string(name) + ": ");
    }
  });
  return found;
}

std::vector<std::string> renumbering_obstacles(const Json& root) {
  std::vector<std::string> obstacles;
  const auto check_name = [&](const std::string& name) {
    if (!is_known(name)) add_once(obstacles, "extension " + name + " is not known to gltf-nmc");
  };
  if (const Json* used = find_member(root, "extensionsUsed"); used && used->is_array()) {
    for (const auto& name : *used) {
      if (name.is_string()) check_name(name.get<std::string>());
    }
  }
  for_each_extension(root, [&](const std::string& name, const Json& object) {
    check_name(name);
    for (const auto pointing : extensions_with_pointers) {
      if (name == pointing && points_at_numbered_object(object)) {
        add_once(obstacles, "extension " + name + " points at accessors, bufferViews, buffers or samplers");
      }
    }
  });
  return obstacles;
}

}  // namespace nmc::gltf
