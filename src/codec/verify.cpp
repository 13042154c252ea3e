// Compares the animations of two files.
#include <optional>
#include <utility>

#include "base/error.h"
#include "codec/bound.h"
#include "codec/compress.h"
#include "codec/matching.h"

namespace nmc::codec {

void check_nodes(const gltf::Document& a, const gltf::Asset& original, const gltf::Document& b,
                 const gltf::Asset& other) {
  if (original.nodes.size() != other.nodes.size())
    throw Error(ErrorCode::invalid_input, b.name + " has " + std::to_string(other.nodes.size()) + " nodes but " +
                                              a.name + " has " + std::to_string(original.nodes.size()) +
                                              "; verify compares a file with what was made from it");
  for (std::size_t i = 0; i < original.nodes.size(); ++i)
    if (original.nodes[i].parent != other.nodes[i].parent || original.nodes[i].name != other.nodes[i].name)
      throw Error(ErrorCode::invalid_input, b.name + ": nodes[" + std::to_string(i) + "] is not the node of " + a.name +
                                                "; verify compares a file with what was made from it");
}

std::size_t find_match(const gltf::Document& a, const std::vector<Animation>& original, const gltf::Document& b,
                       const std::vector<Animation>& other, std::size_t index) {
  if (index < other.size() && other[index].name == original[index].name) return index;
  for (std::size_t i = 0; i < other.size(); ++i)
    if (other[i].name == original[index].name) return i;
  if (original.size() == other.size()) return index;
  throw Error(ErrorCode::invalid_input,
              b.name + ": animation \"" + original[index].name + "\" of " + a.name + " is missing");
}

Verification verify(const gltf::Document& original, const gltf::Document& other, const Tolerance& tolerance,
                    std::span<const ToleranceRule> rules) {
  const gltf::Asset a = gltf::read_asset(original), b = gltf::read_asset(other);
  check_nodes(original, a, other, b);
  const motion::Skeleton skeleton = make_skeleton(a);
  const Points points = gltf::skin_points(original, a, true);
  const motion::ErrorMeter meter(skeleton, points);
  const std::vector<Animation> wanted = all_animations(original, a), got = all_animations(other, b);
  Verification result;
  result.size = motion::character_size(skeleton, points);
  result.tolerance = in_world_units(tolerance, result.size);
  const Points none;
  BoundTable table({skeleton, none, points, result.size, result.tolerance}, rules);
  std::vector<std::size_t> bound_of;
  for (const Animation& animation : wanted) bound_of.push_back(table.of(animation.name));
  std::vector<std::optional<motion::ErrorMeter>> scaled(table.bounds().size());
  for (std::size_t k = 0; k < scaled.size(); ++k)
    if (const auto& own = table.bounds()[k].all_points) scaled[k].emplace(skeleton, *own);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const std::size_t found = find_match(original, wanted, other, got, i);
    if (wanted[i].curves.empty()) continue;
    const Animation& shown = got[found];
    const Bound& bound = table.bounds()[bound_of[i]];
    const auto& own = scaled[bound_of[i]];
    VerifiedClip clip{wanted[i].name, meter.report(wanted[i], shown), bound.tolerance, bound.finest, 0, 0};
    clip.joint_share_of_tolerance = clip.error.max_joint / bound.tolerance;
    clip.share_of_tolerance = (own ? own->report(wanted[i], shown).max : clip.error.max) / bound.tolerance;
    result.clips.push_back(std::move(clip));
  }
  return result;
}

}  // namespace nmc::codec
