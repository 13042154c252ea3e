// Compares two documents in everything that taking animations out must not change, by what indices refer to, not by the
// indices.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "gltf/document.h"

namespace nmc::test {

using gltf::Document;
using gltf::Json;

/// Channels of each animation that an edit takes out: {animation: channels}.
using TakenChannels = std::map<std::size_t, std::set<std::size_t>>;

/// FNV-1a, as text.
inline std::string hash_text(std::string_view text) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : text) hash = (hash ^ static_cast<std::uint8_t>(c)) * 1099511628211ULL;
  return std::to_string(hash) + ":" + std::to_string(text.size());
}

/// Replaces indices by the contents they lead to. Written apart from the product's table of references, so that each
/// finds the other's gaps.
class Resolver {
 public:
  explicit Resolver(const Document& document)
      : document_(document), views_(count("bufferViews")), accessors_(count("accessors")) {}

  std::string view(std::size_t index) {
    std::string& known = views_.at(index);
    if (!known.empty()) return known;
    Json json = document_.json["bufferViews"][index];
    const bool packed = json.contains("extensions") && (json["extensions"].contains("EXT_meshopt_compression") ||
                                                        json["extensions"].contains("KHR_meshopt_compression"));
    if (packed) {
      for (auto& extension : json["extensions"]) {
        if (extension.contains("buffer")) take_place(extension);
      }
    }
    if (!packed || document_.has_data.at(json["buffer"])) take_place(json);
    return known = "view " + hash_text(json.dump());
  }

  std::string accessor(std::size_t index) {
    std::string& known = accessors_.at(index);
    if (!known.empty()) return known;
    Json json = document_.json["accessors"][index];
    resolve_view(json, "bufferView");
    if (json.contains("sparse")) {
      resolve_view(json["sparse"]["indices"], "bufferView");
      resolve_view(json["sparse"]["values"], "bufferView");
    }
    return known = "accessor " + hash_text(json.dump());
  }

  void resolve_view(Json& object, const char* key) {
    if (object.contains(key)) object[key] = view(object[key]);
  }
  void resolve_accessor(Json& object, const char* key) {
    if (object.contains(key)) object[key] = accessor(object[key]);
  }
  void resolve_all_accessors(Json& map) {
    for (auto& value : map) value = accessor(value);
  }

  void resolve_primitive(Json& primitive) {
    resolve_accessor(primitive, "indices");
    resolve_all_accessors(primitive["attributes"]);
    if (primitive.contains("targets")) {
      for (auto& target : primitive["targets"]) resolve_all_accessors(target);
    }
    if (!primitive.contains("extensions")) return;
    Json& extensions = primitive["extensions"];
    if (extensions.contains("KHR_draco_mesh_compression")) {
      resolve_view(extensions["KHR_draco_mesh_compression"], "bufferView");
    }
    if (extensions.contains("CESIUM_primitive_outline")) {
      resolve_accessor(extensions["CESIUM_primitive_outline"], "indices");
    }
  }

  void resolve_root_extensions(Json& extensions) {
    if (extensions.contains("EXT_structural_metadata")) {
      for (auto& table : extensions["EXT_structural_metadata"]["propertyTables"]) {
        for (auto& property : table["properties"]) {
          for (const auto* key : {"values", "arrayOffsets", "stringOffsets"}) resolve_view(property, key);
        }
      }
    }
    if (extensions.contains("EXT_feature_metadata")) {
      for (auto& table : extensions["EXT_feature_metadata"]["featureTables"]) {
        for (auto& property : table["properties"]) {
          for (const auto* key : {"bufferView", "arrayOffsetBufferView", "stringOffsetBufferView"})
            resolve_view(property, key);
        }
      }
    }
    for (const auto& [name, list] : std::map<std::string, const char*>{{"KHR_audio", "audio"},
                                                                       {"KHR_audio_emitter", "audio"},
                                                                       {"MSFT_audio_emitter", "clips"},
                                                                       {"KHR_techniques_webgl", "shaders"}}) {
      if (!extensions.contains(name)) continue;
      for (auto& object : extensions[name][list]) resolve_view(object, "bufferView");
    }
  }

  /// The animation with each channel's sampler in the place of its index, without the extension and the sampler list.
  Json animation(std::size_t index, const std::set<std::size_t>& without_channels) {
    Json json = document_.json["animations"][index];
    Json channels = Json::array();
    for (std::size_t i = 0; i < json["channels"].size(); ++i) {
      if (without_channels.contains(i)) continue;
      Json channel = json["channels"][i];
      Json sampler = json["samplers"][channel["sampler"].get<std::size_t>()];
      resolve_accessor(sampler, "input");
      resolve_accessor(sampler, "output");
      channel["sampler"] = sampler;
      channels.push_back(channel);
    }
    json["channels"] = channels;
    json["samplers"] = nullptr;
    drop_extension(json);
    return json;
  }

  static void drop_extension(Json& object) {
    if (!object.contains("extensions")) return;
    object["extensions"].erase("NMC_animation_compression");
    if (object["extensions"].empty()) object.erase("extensions");
  }

 private:
  std::size_t count(const char* key) const { return document_.json.contains(key) ? document_.json[key].size() : 0; }

  /// The bytes in the place of buffer and byteOffset; how they are aligned counts too.
  void take_place(Json& object) const {
    const std::size_t offset = object.value("byteOffset", std::size_t{0});
    const gltf::Bytes& bytes = document_.buffers.at(object["buffer"]);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t length = object["byteLength"];
    if (offset + length > text.size()) throw std::out_of_range("bufferView");
    object.erase("byteOffset");
    object["buffer"] = "bytes " + hash_text(text.substr(offset, length)) + " at " + std::to_string(offset % 4);
  }

  const Document& document_;
  std::vector<std::string> views_;
  std::vector<std::string> accessors_;
};

/// The document without what an edit may change: {root key: value}, then the contents of objects no animation uses.
inline Json outside_of_animations(const Document& document) {
  Resolver resolver(document);
  Json json = document.json;
  for (const auto* key : {"animations", "accessors", "bufferViews", "buffers"}) json.erase(key);
  for (const auto* key : {"extensionsUsed", "extensionsRequired"}) {
    if (!json.contains(key)) continue;
    Json names = Json::array();
    for (const auto& name : json[key]) {
      if (name != "NMC_animation_compression") names.push_back(name);
    }
    json.erase(key);
    if (!names.empty()) json[key] = names;
  }
  Resolver::drop_extension(json);
  if (json.contains("extensions")) resolver.resolve_root_extensions(json["extensions"]);
  if (json.contains("meshes")) {
    for (auto& mesh : json["meshes"]) {
      for (auto& primitive : mesh["primitives"]) resolver.resolve_primitive(primitive);
    }
  }
  if (json.contains("skins")) {
    for (auto& skin : json["skins"]) resolver.resolve_accessor(skin, "inverseBindMatrices");
  }
  if (json.contains("images")) {
    for (auto& image : json["images"]) resolver.resolve_view(image, "bufferView");
  }
  if (json.contains("nodes")) {
    for (auto& node : json["nodes"]) {
      if (!node.contains("extensions") || !node["extensions"].contains("EXT_mesh_gpu_instancing")) continue;
      resolver.resolve_all_accessors(node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]);
    }
  }
  return json;
}

/// Accessors that animation samplers use, and the bufferViews of those.
inline std::pair<std::set<std::size_t>, std::set<std::size_t>> used_by_animations(const Document& document) {
  std::set<std::size_t> accessors;
  std::set<std::size_t> views;
  if (!document.json.contains("animations")) return {accessors, views};
  for (const auto& animation : document.json["animations"]) {
    for (const auto& sampler : animation["samplers"]) {
      for (const auto* key : {"input", "output"}) accessors.insert(sampler[key].get<std::size_t>());
    }
  }
  for (const auto index : accessors) {
    const Json& accessor = document.json["accessors"][index];
    if (accessor.contains("bufferView")) views.insert(accessor["bufferView"].get<std::size_t>());
    if (!accessor.contains("sparse")) continue;
    for (const auto* key : {"indices", "values"})
      views.insert(accessor["sparse"][key]["bufferView"].get<std::size_t>());
  }
  return {accessors, views};
}

/// Whether `part` is in `whole` in its order.
inline bool is_subsequence(const std::vector<std::string>& part, const std::vector<std::string>& whole) {
  std::size_t at = 0;
  for (const auto& entry : whole) {
    if (at < part.size() && part[at] == entry) ++at;
  }
  return at == part.size();
}

/// The first thing that differs between `original` and `edited` though it should not; empty where all is well.
/// `taken` channels of `original` and `added` channels of `edited` are left out of the comparison.
inline std::string passthrough_difference(const Document& original, const Document& edited, const TakenChannels& taken,
                                          const TakenChannels& added) {
  const Json before = outside_of_animations(original);
  const Json after = outside_of_animations(edited);
  for (auto member = before.begin(); member != before.end(); ++member) {
    if (!after.contains(member.key())) return member.key() + " is gone";
    if (after[member.key()].dump() != member.value().dump()) return member.key() + " changed";
  }
  if (after.size() != before.size()) return "a root member was added";
  const auto channels_of = [](const TakenChannels& map, std::size_t animation) {
    const auto found = map.find(animation);
    return found == map.end() ? std::set<std::size_t>() : found->second;
  };
  Resolver original_resolver(original);
  Resolver edited_resolver(edited);
  const std::size_t animations = original.json.contains("animations") ? original.json["animations"].size() : 0;
  if (animations != (edited.json.contains("animations") ? edited.json["animations"].size() : 0))
    return "animation count";
  for (std::size_t i = 0; i < animations; ++i) {
    if (original_resolver.animation(i, channels_of(taken, i)).dump() !=
        edited_resolver.animation(i, channels_of(added, i)).dump()) {
      return "animations[" + std::to_string(i) + "] changed";
    }
  }
  const auto [used_accessors, used_views] = used_by_animations(original);
  std::vector<std::string> kept, present;
  for (std::size_t i = 0; original.json.contains("accessors") && i < original.json["accessors"].size(); ++i) {
    if (!used_accessors.contains(i)) kept.push_back(original_resolver.accessor(i));
  }
  for (std::size_t i = 0; edited.json.contains("accessors") && i < edited.json["accessors"].size(); ++i) {
    present.push_back(edited_resolver.accessor(i));
  }
  if (!is_subsequence(kept, present)) return "an accessor that no animation uses is gone";
  kept.clear();
  present.clear();
  for (std::size_t i = 0; original.json.contains("bufferViews") && i < original.json["bufferViews"].size(); ++i) {
    if (!used_views.contains(i)) kept.push_back(original_resolver.view(i));
  }
  for (std::size_t i = 0; edited.json.contains("bufferViews") && i < edited.json["bufferViews"].size(); ++i) {
    present.push_back(edited_resolver.view(i));
  }
  if (!is_subsequence(kept, present)) return "a bufferView that no animation uses is gone";
  return "";
}

}  // namespace nmc::test
