// Checks the samplers and channels of animations.
#include <fmt/format.h>

#include "gltf/json_text.h"
#include "gltf/validate.h"

namespace nmc::gltf {
namespace {

const Json& required_list(const Json& animation, const char* key, const Where& where) {
  const Json* list = find_array(animation, key, where);
  if (list == nullptr || list->empty()) where.fail(fmt::format("has no {}", key));
  for (std::size_t i = 0; i < list->size(); ++i) {
    if (!(*list)[i].is_object()) where.at(key, i).fail("is not an object");
  }
  return *list;
}

void check_sampler(const Document& document, const Json& sampler, const Where& where) {
  const std::size_t accessors = list_size(document.json, "accessors", document.name);
  get_index(sampler, "input", accessors, where);
  get_index(sampler, "output", accessors, where);
  find_string(sampler, "interpolation", where);
}

void check_channel(const Document& document, const Json& channel, std::size_t sampler_count, const Where& where) {
  get_index(channel, "sampler", sampler_count, where);
  const Json* target = find_object(channel, "target", where);
  if (target == nullptr) where.fail("has no target");
  find_index(*target, "node", list_size(document.json, "nodes", document.name), where.at("target"));
  if (!find_string(*target, "path", where.at("target"))) where.at("target").fail("has no path");
}

}  // namespace

void validate_animations(const Document& document) {
  const Json* animations = find_list(document.json, "animations", document.name);
  for (std::size_t i = 0; animations != nullptr && i < animations->size(); ++i) {
    const Json& animation = (*animations)[i];
    const Where where{document.name, fmt::format("animations[{}]", i)};
    find_string(animation, "name", where);
    const Json& samplers = required_list(animation, "samplers", where);
    for (std::size_t s = 0; s < samplers.size(); ++s) check_sampler(document, samplers[s], where.at("samplers", s));
    const Json& channels = required_list(animation, "channels", where);
    for (std::size_t c = 0; c < channels.size(); ++c)
      check_channel(document, channels[c], samplers.size(), where.at("channels", c));
  }
}

}  // namespace nmc::gltf
