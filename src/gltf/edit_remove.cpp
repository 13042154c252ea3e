// Puts decoded curves in the place of the extension.
#include <set>
#include <string>
#include <utility>

#include "base/error.h"
#include "gltf/append.h"
#include "gltf/edit.h"
#include "gltf/edit_tools.h"
#include "gltf/json_tools.h"
#include "gltf/references.h"

namespace nmc::gltf {
namespace {

Json& animation_at(Document& document, int index) {
  return document.json["animations"][static_cast<std::size_t>(index)];
}

std::string name_of(int animation) { return "animations[" + std::to_string(animation) + "]"; }

bool has_stub(const Json& animation) {
  const Json* stub = find_member(animation["extensions"][extension_name], "stub");
  return stub && stub->is_boolean() && stub->get<bool>();
}

void check_curves(const Document& document, int animation, const Animation& decoded) {
  const Json& json = document.json["animations"][static_cast<std::size_t>(animation)];
  const std::size_t first = has_stub(json) ? 1 : 0;
  std::set<Target> targets;
  for (std::size_t i = first; i < array_size(json, "channels"); ++i) {
    if (const auto target = channel_target(json["channels"][i])) targets.insert(*target);
  }
  for (const auto& curve : decoded.curves) {
    if (!targets.insert({curve.node, curve.path}).second) {
      throw Error(ErrorCode::invalid_input, document.name + ": " + name_of(animation) + " moves the " +
                                                path_name(curve.path) + " of node " + std::to_string(curve.node) +
                                                " by a channel and by its compressed clip");
    }
    const std::size_t per_key = curve.interpolation == Interpolation::cubic_spline ? 3 : 1;
    if (curve.times.empty() ||
        curve.values.size() != curve.times.size() * static_cast<std::size_t>(curve.width) * per_key) {
      throw Error(ErrorCode::internal, document.name + ": a decoded curve of " + name_of(animation) + " is incomplete");
    }
  }
}

/// Drops the extension from the JSON, with stub channels; what they referred to is added to `candidates`.
void erase_extension_objects(Document& document, const CompressedContent& content, Numbering numbering,
                             Candidates& candidates) {
  Json& json = document.json;
  for (const auto& clip_set : json["extensions"][extension_name]["clipSets"]) {
    if (const auto view = index_member(clip_set, "bufferView")) candidates.buffer_views.insert(*view);
  }
  for (const auto& compressed : content.animations) {
    Json& animation = animation_at(document, compressed.animation);
    if (content.requirement != Requirement::fallback && has_stub(animation)) {
      remove_channels(animation, {0}, numbering, candidates);
    }
    erase_extension(animation, extension_name);
  }
  erase_extension(json, extension_name);
  unlist_extension(json, "extensionsUsed", extension_name);
  unlist_extension(json, "extensionsRequired", extension_name);
}

Json make_sampler(const Curve& curve, FloatBlock& block) {
  const auto type = curve.path == Path::weights ? "SCALAR" : curve.path == Path::rotation ? "VEC4" : "VEC3";
  const auto input = block.add_times(curve.times);
  Json sampler{{"input", input}, {"output", block.add(type, curve.values)}};
  if (curve.interpolation == Interpolation::step) sampler["interpolation"] = "STEP";
  if (curve.interpolation == Interpolation::cubic_spline) sampler["interpolation"] = "CUBICSPLINE";
  return sampler;
}

void add_curves(Json& animation, const Animation& decoded, FloatBlock& block) {
  for (const auto& curve : decoded.curves) {
    Json& samplers = animation["samplers"];
    Json target{{"node", curve.node}, {"path", path_name(curve.path)}};
    animation["channels"].push_back(Json{{"sampler", samplers.size()}, {"target", std::move(target)}});
    samplers.push_back(make_sampler(curve, block));
  }
}

}  // namespace

void remove_compression(Document& document, const CompressedContent& content, const std::vector<Animation>& decoded) {
  if (content.clip_sets.empty()) return;
  const bool restore = content.requirement != Requirement::fallback;
  if (restore && decoded.size() != content.animations.size()) {
    throw Error(ErrorCode::internal, document.name + ": not every compressed animation is decoded");
  }
  for (std::size_t i = 0; restore && i < decoded.size(); ++i) {
    check_curves(document, content.animations[i].animation, decoded[i]);
  }
  const auto numbering = renumbering_obstacles(document.json).empty() ? Numbering::may_change : Numbering::kept;
  Candidates candidates;
  erase_extension_objects(document, content, numbering, candidates);
  const auto touched = remove_unused(document, candidates, numbering);
  if (restore) {
    FloatBlock block(document);
    for (std::size_t i = 0; i < decoded.size(); ++i) {
      Json& animation = animation_at(document, content.animations[i].animation);
      add_curves(animation, decoded[i], block);
      fill_unused_samplers(animation);
    }
    block.finish();
  }
  drop_empty_buffers(document, touched, numbering);
}

}  // namespace nmc::gltf
