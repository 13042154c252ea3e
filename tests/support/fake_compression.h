// A compression edit with made-up streams, for tests of the file without a codec.
#pragma once

#include <algorithm>
#include <cstring>
#include <random>

#include "gltf/edit.h"
#include "support/passthrough.h"

namespace nmc::test {

struct FakeEdit {
  gltf::CompressionEdit edit;
  TakenChannels taken;
};

/// First and last key time by the accessors' min and max, which glTF requires of key times.
inline std::pair<float, float> time_range(const Document& document, const Json& animation) {
  float start = 0, end = 0;
  bool first = true;
  for (const auto& sampler : animation["samplers"]) {
    const Json& input = document.json["accessors"][sampler["input"].get<std::size_t>()];
    if (!input.contains("min") || !input.contains("max")) continue;
    const float low = input["min"][0].get<float>(), high = input["max"][0].get<float>();
    start = first ? low : std::min(start, low);
    end = first ? high : std::max(end, high);
    first = false;
  }
  return {start, end};
}

/// Takes every channel that moves a node property, or (with `share` below 1) a random part of them, into two clip sets.
inline FakeEdit make_fake_edit(const Document& document, gltf::Requirement requirement, double share, unsigned seed) {
  const std::map<std::string, Path> paths = {{"translation", Path::translation},
                                             {"rotation", Path::rotation},
                                             {"scale", Path::scale},
                                             {"weights", Path::weights}};
  std::mt19937 random(seed);
  const auto chance = [&random] { return static_cast<double>(random() % 1000) / 1000.0; };
  FakeEdit fake;
  fake.edit.requirement = requirement;
  std::vector<gltf::ClipSetBytes> sets(2);
  for (std::size_t i = 0; document.json.contains("animations") && i < document.json["animations"].size(); ++i) {
    const Json& animation = document.json["animations"][i];
    gltf::TakenAnimation taken;
    taken.animation = static_cast<int>(i);
    taken.clip_set = static_cast<int>(i % 2);
    taken.clip = static_cast<int>(i / 2);
    std::tie(taken.start_seconds, taken.end_seconds) = time_range(document, animation);
    for (std::size_t k = 0; k < animation["channels"].size(); ++k) {
      const Json& target = animation["channels"][k]["target"];
      if (!target.contains("node") || !paths.contains(target["path"]) || chance() >= share) continue;
      taken.channels.push_back(static_cast<int>(k));
      const gltf::Target entry{target["node"].get<int>(), paths.at(target["path"])};
      auto& targets = sets[i % 2].targets;
      if (std::find(targets.begin(), targets.end(), entry) == targets.end()) targets.push_back(entry);
      if (requirement != gltf::Requirement::fallback) fake.taken[i].insert(k);
    }
    if (!taken.channels.empty()) fake.edit.taken.push_back(taken);
  }
  for (auto& set : sets) {
    for (unsigned k = 0; k < 101 + seed % 7; ++k) set.stream.push_back(static_cast<std::uint8_t>(random() % 256));
  }
  // A file with one animation needs one set only; an empty set is not valid.
  if (sets[1].targets.empty()) sets.pop_back();
  if (sets[0].targets.empty()) {
    for (auto& taken : fake.edit.taken) taken.clip_set = 0;
    sets.erase(sets.begin());
  }
  fake.edit.clip_sets = sets;
  return fake;
}

/// The stub channels of a compressed document.
inline TakenChannels stub_channels(const Document& document) {
  TakenChannels stubs;
  for (std::size_t i = 0; document.json.contains("animations") && i < document.json["animations"].size(); ++i) {
    const Json& animation = document.json["animations"][i];
    if (!animation.contains("extensions") || !animation["extensions"].contains("NMC_animation_compression")) continue;
    if (animation["extensions"]["NMC_animation_compression"].value("stub", false)) stubs[i].insert(0);
  }
  return stubs;
}

/// The floats of an accessor without stride in an ordinary bufferView.
inline std::vector<float> read_floats(const Document& document, std::size_t index) {
  const Json& accessor = document.json["accessors"][index];
  if (accessor["componentType"] != 5126) throw std::invalid_argument("accessor of floats expected");
  const Json& view = document.json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
  const std::map<std::string, std::size_t> widths = {{"SCALAR", 1}, {"VEC3", 3}, {"VEC4", 4}};
  std::vector<float> values(accessor["count"].get<std::size_t>() * widths.at(accessor["type"]));
  const std::size_t offset = accessor.value("byteOffset", std::size_t{0});
  if (offset + values.size() * 4 > view["byteLength"].get<std::size_t>()) throw std::out_of_range("accessor");
  const gltf::Bytes& bytes = document.buffers.at(view["buffer"]);
  std::memcpy(values.data(), bytes.data() + view.value("byteOffset", std::size_t{0}) + offset, values.size() * 4);
  return values;
}

}  // namespace nmc::test
