// Puts clip sets into a document and takes out what they replace.
#include <set>
#include <string>

#include "base/error.h"
#include "gltf/append.h"
#include "gltf/edit.h"
#include "gltf/edit_tools.h"
#include "gltf/json_tools.h"
#include "gltf/references.h"
#include "gltf/stub.h"

namespace nmc::gltf {
namespace {

[[noreturn]] void refuse(const Document& document, const std::string& what) {
  throw Error(ErrorCode::internal, document.name + ": the edit does not fit the document: " + what);
}

Json& animation_at(Document& document, int index) {
  return document.json["animations"][static_cast<std::size_t>(index)];
}

std::size_t sized(int index) { return static_cast<std::size_t>(index); }

/// The node properties of the channels to be taken, in their order; checked.
std::vector<Target> taken_targets(const Document& document, const CompressionEdit& edit, const TakenAnimation& taken) {
  const std::string name = "animations[" + std::to_string(taken.animation) + "]";
  const Json& animation = document.json["animations"][sized(taken.animation)];
  if (taken.clip_set < 0 || sized(taken.clip_set) >= edit.clip_sets.size()) refuse(document, name + " has no clip set");
  if (taken.clip < 0) refuse(document, name + " has no clip");
  if (taken.channels.empty()) refuse(document, name + " gives no channel");
  if (!(taken.start_seconds <= taken.end_seconds)) refuse(document, name + " ends before it starts");
  std::set<Target> known(edit.clip_sets[sized(taken.clip_set)].targets.begin(),
                         edit.clip_sets[sized(taken.clip_set)].targets.end());
  std::set<int> seen;
  std::vector<Target> targets;
  const auto claim = [&](int channel) {
    if (channel < 0 || sized(channel) >= array_size(animation, "channels") || !seen.insert(channel).second)
      refuse(document, name + " has no channel " + std::to_string(channel) + " left to take");
  };
  for (const int channel : taken.channels) {
    claim(channel);
    const auto target = channel_target(animation["channels"][sized(channel)]);
    if (!target || !known.contains(*target)) {
      refuse(document, name + ".channels[" + std::to_string(channel) + "] moves no target of its clip set");
    }
    targets.push_back(*target);
  }
  for (const int channel : taken.resting) claim(channel);
  return targets;
}

std::vector<std::vector<Target>> check_edit(const Document& document, const CompressionEdit& edit) {
  if (const Json* extensions = find_member(document.json, "extensions");
      extensions && extensions->contains(extension_name)) {
    throw Error(ErrorCode::invalid_input, document.name + " is compressed already; decompress it first");
  }
  for (const auto& clip_set : edit.clip_sets) {
    if (clip_set.stream.empty() || clip_set.targets.empty()) refuse(document, "a clip set is empty");
  }
  std::set<int> seen;
  std::vector<std::vector<Target>> targets;
  for (const auto& taken : edit.taken) {
    if (taken.animation < 0 || sized(taken.animation) >= array_size(document.json, "animations") ||
        !seen.insert(taken.animation).second) {
      refuse(document, "there is no animation " + std::to_string(taken.animation) + " left to take");
    }
    targets.push_back(taken_targets(document, edit, taken));
  }
  return targets;
}

/// Takes the replaced channels and all that only they used; returns the buffers that lost bytes.
std::set<std::size_t> take_channels(Document& document, const CompressionEdit& edit, Numbering numbering) {
  Candidates candidates;
  for (const auto& taken : edit.taken) {
    std::set<std::size_t> channels;
    for (const int channel : taken.channels) channels.insert(sized(channel));
    for (const int channel : taken.resting) channels.insert(sized(channel));
    remove_channels(animation_at(document, taken.animation), channels, numbering, candidates);
  }
  return remove_unused(document, candidates, numbering);
}

void put_stub(Json& animation, const Target& target, const Json& sampler) {
  Json& samplers = animation["samplers"];
  if (samplers.empty()) {
    samplers.push_back(sampler);
  } else {
    samplers[0]["input"] = sampler["input"];
    samplers[0]["output"] = sampler["output"];
    samplers[0].erase("interpolation");
  }
  animation["channels"].push_back(
      Json{{"sampler", 0}, {"target", Json{{"node", target.node}, {"path", path_name(target.path)}}}});
}

/// Gives every animation without channels its stub; returns the animations that have one.
std::set<int> put_stubs(Document& document, const CompressionEdit& edit,
                        const std::vector<std::vector<Target>>& targets) {
  std::set<int> stubs;
  FloatBlock block(document);
  for (std::size_t i = 0; i < edit.taken.size(); ++i) {
    const auto& taken = edit.taken[i];
    Json& animation = animation_at(document, taken.animation);
    if (animation["channels"].empty()) {
      const auto target = choose_stub_target(document.json, edit.clip_sets[sized(taken.clip_set)].targets, targets[i]);
      const auto sampler = make_stub_sampler(document.json, {target, taken.start_seconds, taken.end_seconds}, block);
      put_stub(animation_at(document, taken.animation), target, sampler);
      stubs.insert(taken.animation);
    }
    fill_unused_samplers(animation_at(document, taken.animation));
  }
  block.finish();
  return stubs;
}

/// Targets in their order; those of one path that follow each other are one group: {"path": "rotation", "nodes": [0, 1,
/// 4]}.
Json target_groups(const std::vector<Target>& targets) {
  Json groups = Json::array();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (i == 0 || targets[i].path != targets[i - 1].path)
      groups.push_back(Json{{"path", path_name(targets[i].path)}, {"nodes", Json::array()}});
    groups.back()["nodes"].push_back(targets[i].node);
  }
  return groups;
}

void put_extras(Json& object, const Json& extras) {
  if (!extras.is_null()) object["extras"] = extras;
}

void put_clip_sets(Document& document, const CompressionEdit& edit) {
  Json clip_sets = Json::array();
  for (const auto& clip_set : edit.clip_sets) {
    const auto view = append_view(document, clip_set.stream);
    clip_sets.push_back(Json{{"bufferView", view}, {"targets", target_groups(clip_set.targets)}});
    put_extras(clip_sets.back(), clip_set.extras);
  }
  Json extension{{"version", 1}, {"clipSets", std::move(clip_sets)}};
  if (edit.requirement == Requirement::fallback) extension["fallback"] = true;
  put_extras(extension, edit.extras);
  object_member(document.json, "extensions")[extension_name] = std::move(extension);
  list_extension(document.json, "extensionsUsed", extension_name);
  if (edit.requirement == Requirement::required) list_extension(document.json, "extensionsRequired", extension_name);
}

void put_clips(Document& document, const CompressionEdit& edit, const std::set<int>& stubs) {
  for (const auto& taken : edit.taken) {
    Json clip{{"clipSet", taken.clip_set}, {"clip", taken.clip}};
    if (stubs.contains(taken.animation)) clip["stub"] = true;
    put_extras(clip, taken.extras);
    object_member(animation_at(document, taken.animation), "extensions")[extension_name] = std::move(clip);
  }
}

}  // namespace

std::vector<std::string> apply_compression(Document& document, const CompressionEdit& edit) {
  if (edit.taken.empty()) return {};
  const auto targets = check_edit(document, edit);
  std::vector<std::string> notes;
  std::set<std::size_t> touched;
  std::set<int> stubs;
  auto numbering = Numbering::may_change;
  if (edit.requirement != Requirement::fallback) {
    for (const auto& obstacle : renumbering_obstacles(document.json)) {
      numbering = Numbering::kept;
      notes.push_back(obstacle + ": unused accessors, bufferViews and samplers stay as empty entries");
    }
    touched = take_channels(document, edit, numbering);
    stubs = put_stubs(document, edit, targets);
  }
  put_clip_sets(document, edit);
  put_clips(document, edit, stubs);
  drop_empty_buffers(document, touched, numbering);
  return notes;
}

}  // namespace nmc::gltf
