// What a compressed document must share with its original, and what it plays, from the file's side.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "codec/compress.h"
#include "gltf/vertices.h"
#include "support/fake_compression.h"
#include "support/passthrough.h"

namespace nmc::test {

/// The first thing that differs though it should not between a document and what compress() made of it; empty where
/// all is well.
inline std::string untouched_difference(const Document& original, const codec::CompressResult& result,
                                        gltf::Requirement requirement = gltf::Requirement::required) {
  const gltf::Asset asset = gltf::read_asset(original);
  TakenChannels taken;
  bool any = false;
  for (const codec::ClipResult& clip : result.clips) {
    if (clip.outcome != codec::Outcome::compressed) continue;
    any = true;
    const auto animation = static_cast<std::size_t>(clip.animation);
    if (requirement != gltf::Requirement::fallback)
      for (const gltf::Channel& channel : asset.animations[animation].channels)
        taken[animation].insert(static_cast<std::size_t>(channel.channel));
  }
  if (!any)
    return original.json.dump() == result.document.json.dump() && original.buffers == result.document.buffers
               ? ""
               : "nothing was compressed, but the document changed";
  return passthrough_difference(original, result.document, taken, stub_channels(result.document));
}

/// The node curves of each animation as core glTF has them.
inline std::vector<Animation> core_animations(const Document& document) {
  std::vector<Animation> animations;
  for (const gltf::AnimationSource& source : gltf::read_asset(document).animations) {
    animations.push_back({source.name, {}});
    for (const gltf::Channel& channel : source.channels) animations.back().curves.push_back(channel.curve);
  }
  return animations;
}

inline const Curve* find_curve(const Animation& animation, int node, Path path) {
  const auto found = std::find_if(animation.curves.begin(), animation.curves.end(),
                                  [&](const Curve& c) { return c.node == node && c.path == path; });
  return found == animation.curves.end() ? nullptr : &*found;
}

}  // namespace nmc::test
