// Compressed animations back to curves: for writing core glTF, for comparing, for playing.
#include <algorithm>
#include <map>

#include "base/error.h"
#include "codec/compress.h"
#include "codec/decoded_set.h"
#include "motion/clip.h"

namespace nmc::codec {
namespace {

std::vector<DecodedSet> open_sets(const gltf::Document& document, const gltf::CompressedContent& content) {
  std::vector<DecodedSet> sets;
  for (std::size_t s = 0; s < content.clip_sets.size(); ++s) {
    const std::string name =
        document.name + ": extensions.NMC_animation_compression.clipSets[" + std::to_string(s) + "]";
    sets.emplace_back(content.clip_sets[s].stream, name);
    if (sets.back().target_count() != content.clip_sets[s].targets.size())
      throw Error(ErrorCode::invalid_input, name + " lists " + std::to_string(content.clip_sets[s].targets.size()) +
                                                " targets but its stream has " +
                                                std::to_string(sets.back().target_count()) +
                                                "; compress the original file again");
    for (std::size_t t = 0; t < sets.back().target_count(); ++t)
      if (sets.back().path(t) != content.clip_sets[s].targets[t].path)
        throw Error(ErrorCode::invalid_input, name + ".targets[" + std::to_string(t) +
                                                  "].path is not the stream's; compress the original file again");
  }
  return sets;
}

Animation decode(const gltf::Document& document, const gltf::CompressedContent& content,
                 const std::vector<DecodedSet>& sets, const gltf::CompressedAnimation& which) {
  const DecodedSet& set = sets[static_cast<std::size_t>(which.clip_set)];
  if (static_cast<std::size_t>(which.clip) >= set.clip_count())
    throw Error(ErrorCode::invalid_input, document.name + ": animations[" + std::to_string(which.animation) +
                                              "].extensions.NMC_animation_compression.clip " +
                                              std::to_string(which.clip) + " is out of range; the set has " +
                                              std::to_string(set.clip_count()) + " clips");
  std::vector<int> nodes;
  for (const gltf::Target& target : content.clip_sets[static_cast<std::size_t>(which.clip_set)].targets)
    nodes.push_back(target.node);
  return motion::to_animation(set.clip(static_cast<std::size_t>(which.clip), nodes));
}

bool is_taken(const Animation& decoded, const Curve& curve) {
  return std::any_of(decoded.curves.begin(), decoded.curves.end(),
                     [&](const Curve& c) { return c.node == curve.node && c.path == curve.path; });
}

bool has_stub(const gltf::Document& document, int animation) {
  const gltf::Json& extension =
      document.json.at("animations").at(static_cast<std::size_t>(animation)).at("extensions").at(gltf::extension_name);
  return extension.value("stub", false);
}

}  // namespace

gltf::Document expand(const gltf::Document& document) {
  const gltf::CompressedContent content = gltf::read_compression(document);
  if (content.clip_sets.empty() && content.animations.empty()) return document;
  const std::vector<DecodedSet> sets = open_sets(document, content);
  std::vector<Animation> decoded;
  for (const gltf::CompressedAnimation& animation : content.animations)
    decoded.push_back(decode(document, content, sets, animation));
  gltf::Document result = document;
  gltf::remove_compression(result, content, decoded);
  return result;
}

std::vector<Animation> all_animations(const gltf::Document& document, const gltf::Asset& asset) {
  const gltf::CompressedContent content = gltf::read_compression(document);
  const std::vector<DecodedSet> sets = open_sets(document, content);
  std::map<int, Animation> decoded;
  for (const gltf::CompressedAnimation& animation : content.animations)
    decoded[animation.animation] = decode(document, content, sets, animation);
  std::vector<Animation> animations;
  for (std::size_t i = 0; i < asset.animations.size(); ++i) {
    const auto found = decoded.find(static_cast<int>(i));
    Animation made{asset.animations[i].name, {}};
    const bool stub = found != decoded.end() && has_stub(document, static_cast<int>(i));
    for (const gltf::Channel& channel : asset.animations[i].channels)
      if (!(stub && channel.channel == 0) && !(found != decoded.end() && is_taken(found->second, channel.curve)))
        made.curves.push_back(channel.curve);
    for (const gltf::UntouchedChannel& channel : asset.animations[i].untouched)
      if (channel.curve.node >= 0) made.curves.push_back(channel.curve);
    if (found != decoded.end())
      made.curves.insert(made.curves.end(), found->second.curves.begin(), found->second.curves.end());
    animations.push_back(std::move(made));
  }
  return animations;
}

}  // namespace nmc::codec
