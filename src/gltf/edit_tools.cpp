// What putting the extension into a document and taking it out have in common.
#include "gltf/edit_tools.h"

#include <array>
#include <limits>

#include "gltf/json_tools.h"

namespace nmc::gltf {
namespace {

constexpr std::array<const char*, 4> path_names = {"translation", "rotation", "scale", "weights"};

std::set<std::size_t> used_samplers(const Json& animation) {
  std::set<std::size_t> used;
  for (const auto& channel : animation["channels"]) {
    if (const auto sampler = index_member(channel, "sampler")) used.insert(*sampler);
  }
  return used;
}

void add_accessors_of(const Json& sampler, std::set<std::size_t>& accessors) {
  for (const auto* key : {"input", "output"}) {
    if (const auto index = index_member(sampler, key)) accessors.insert(*index);
  }
}

void erase_unused_samplers(Json& animation, const std::set<std::size_t>& used) {
  Json left = Json::array();
  std::vector<std::size_t> new_index(animation["samplers"].size(), 0);
  for (std::size_t i = 0; i < new_index.size(); ++i) {
    new_index[i] = left.size();
    if (used.contains(i)) left.push_back(std::move(animation["samplers"][i]));
  }
  animation["samplers"] = std::move(left);
  for (auto& channel : animation["channels"]) {
    const auto sampler = index_member(channel, "sampler");
    if (sampler && *sampler < new_index.size()) channel["sampler"] = new_index[*sampler];
  }
}

}  // namespace

const char* path_name(Path path) { return path_names.at(static_cast<std::size_t>(path)); }

std::optional<Path> path_from_name(std::string_view name) {
  for (std::size_t i = 0; i < path_names.size(); ++i) {
    if (name == path_names[i]) return static_cast<Path>(i);
  }
  return std::nullopt;
}

std::optional<Target> channel_target(const Json& channel) {
  const Json* target = find_member(channel, "target");
  if (!target) return std::nullopt;
  const auto node = index_member(*target, "node");
  const Json* path = find_member(*target, "path");
  if (!node || *node > static_cast<std::size_t>(std::numeric_limits<int>::max()) || !path || !path->is_string()) {
    return std::nullopt;
  }
  const auto known = path_from_name(path->get_ref<const std::string&>());
  if (!known) return std::nullopt;
  return Target{static_cast<int>(*node), *known};
}

void remove_channels(Json& animation, const std::set<std::size_t>& channels, Numbering numbering,
                     Candidates& candidates) {
  Json left = Json::array();
  for (std::size_t i = 0; i < animation["channels"].size(); ++i) {
    if (!channels.contains(i)) left.push_back(std::move(animation["channels"][i]));
  }
  animation["channels"] = std::move(left);
  const auto used = used_samplers(animation);
  Json& samplers = animation["samplers"];
  for (std::size_t i = 0; i < samplers.size(); ++i) {
    if (used.contains(i)) continue;
    add_accessors_of(samplers[i], candidates.accessors);
    samplers[i]["input"] = nullptr;
    samplers[i]["output"] = nullptr;
  }
  if (numbering == Numbering::may_change) erase_unused_samplers(animation, used);
}

void fill_unused_samplers(Json& animation) {
  if (animation["channels"].empty()) return;
  const auto first = index_member(animation["channels"][0], "sampler");
  Json& samplers = animation["samplers"];
  if (!first || *first >= samplers.size()) return;
  for (auto& sampler : samplers) {
    const Json* input = find_member(sampler, "input");
    if (!input || !input->is_null()) continue;
    const Json& example = samplers[*first];
    sampler["input"] = example["input"];
    sampler["output"] = example["output"];
    sampler.erase("interpolation");
    if (const Json* interpolation = find_member(example, "interpolation")) sampler["interpolation"] = *interpolation;
  }
}

void erase_extension(Json& object, const char* key) {
  Json* extensions = find_member(object, "extensions");
  if (!extensions || !extensions->is_object()) return;
  extensions->erase(key);
  if (extensions->empty()) object.erase("extensions");
}

void list_extension(Json& root, const char* list, const char* name) {
  Json& names = array_member(root, list);
  for (const auto& entry : names) {
    if (entry == name) return;
  }
  names.push_back(name);
}

void unlist_extension(Json& root, const char* list, const char* name) {
  const Json* names = find_member(root, list);
  if (!names || !names->is_array()) return;
  Json left = Json::array();
  for (const auto& entry : *names) {
    if (entry != name) left.push_back(entry);
  }
  if (left.empty()) {
    root.erase(list);
  } else {
    root[list] = std::move(left);
  }
}

}  // namespace nmc::gltf
