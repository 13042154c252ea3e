#include "rate_reference.h"

#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "codec/compress.h"
#include "motion/clip.h"

namespace nmc::bench {
namespace {

std::map<std::string, std::vector<int>> nodes_by_name(const gltf::Asset& asset) {
  std::map<std::string, std::vector<int>> found;
  for (std::size_t i = 0; i < asset.nodes.size(); ++i)
    if (!asset.nodes[i].name.empty()) found[asset.nodes[i].name].push_back(static_cast<int>(i));
  return found;
}

void match_by_name(const gltf::Asset& original, const gltf::Asset& other, std::vector<int>& match) {
  const auto theirs = nodes_by_name(other);
  for (const auto& [name, ours] : nodes_by_name(original)) {
    const auto found = theirs.find(name);
    if (found == theirs.end() || found->second.size() != ours.size()) continue;
    for (std::size_t i = 0; i < ours.size(); ++i) match[static_cast<std::size_t>(found->second[i])] = ours[i];
  }
}

void match_by_skin(const gltf::Asset& original, const gltf::Asset& other, std::vector<int>& match) {
  for (std::size_t s = 0; s < std::min(original.skins.size(), other.skins.size()); ++s) {
    const std::vector<int>&ours = original.skins[s].joints, &theirs = other.skins[s].joints;
    if (ours.size() != theirs.size()) continue;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      int& matched = match[static_cast<std::size_t>(theirs[i])];
      if (matched < 0) matched = ours[i];
    }
  }
}

/// Per node of the other file the original's node, or -1.
std::vector<int> match_nodes(const gltf::Asset& original, const gltf::Asset& other) {
  std::vector<int> match(other.nodes.size(), -1);
  match_by_name(original, other, match);
  match_by_skin(original, other, match);
  if (other.nodes.size() != original.nodes.size()) return match;
  std::vector<bool> taken(match.size(), false);
  for (const int node : match)
    if (node >= 0) taken[static_cast<std::size_t>(node)] = true;
  for (std::size_t i = 0; i < match.size(); ++i)
    if (match[i] < 0 && !taken[i]) match[i] = static_cast<int>(i);
  return match;
}

const Animation* find_animation(const std::vector<Animation>& all, const std::string& name, std::size_t index) {
  if (index < all.size() && all[index].name == name) return &all[index];
  const auto found = std::find_if(all.begin(), all.end(), [&](const Animation& a) { return a.name == name; });
  if (found != all.end()) return &*found;
  return index < all.size() ? &all[index] : nullptr;
}

Animation renumbered(const Animation& animation, const std::vector<int>& match) {
  Animation moved{animation.name, {}};
  for (const Curve& curve : animation.curves) {
    const int node = match[static_cast<std::size_t>(curve.node)];
    if (node < 0) continue;
    moved.curves.push_back(curve);
    moved.curves.back().node = node;
  }
  return moved;
}

}  // namespace

Reference::Reference(const std::filesystem::path& path)
    : document_(gltf::read_document(path)),
      asset_(gltf::read_asset(document_)),
      skeleton_(codec::make_skeleton(asset_)),
      points_(gltf::skin_points(document_, asset_, true)),
      meter_(skeleton_, points_),
      size_(motion::character_size(skeleton_, points_)),
      animations_(codec::all_animations(document_, asset_)) {}

double Reference::key_rate_hz() const {
  const std::vector<float>* longest = nullptr;
  for (const Animation& animation : animations_)
    for (const Curve& curve : animation.curves)
      if (!longest || curve.times.size() > longest->size()) longest = &curve.times;
  return longest ? motion::sample_rate_hz(*longest) : 0;
}

FileError Reference::error(const gltf::Document& other) const {
  const gltf::Asset asset = gltf::read_asset(other);
  const std::vector<int> match = match_nodes(asset_, asset);
  const std::vector<Animation> made = codec::all_animations(other, asset);
  FileError worst;
  for (std::size_t i = 0; i < animations_.size(); ++i) {
    if (animations_[i].curves.empty()) continue;
    const Animation* found = find_animation(made, animations_[i].name, i);
    constexpr double infinite = std::numeric_limits<double>::infinity();
    if (!found) return {infinite, infinite, infinite, infinite, infinite};
    const motion::ErrorReport report = meter_.report(animations_[i], renumbered(*found, match));
    worst.all = std::max(worst.all, report.max / size_);
    worst.joints = std::max(worst.joints, report.max_joint / size_);
    worst.jitter = std::max(worst.jitter, report.jitter / size_);
    if (report.loop_seam) worst.loop_seam = std::max(worst.loop_seam.value_or(0), *report.loop_seam / size_);
    worst.contact_drift = std::max(worst.contact_drift, report.contact_drift / size_);
  }
  return worst;
}

}  // namespace nmc::bench
