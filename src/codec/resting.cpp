#include "codec/resting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace nmc::codec {
namespace {

/// Of the tolerance. What files write for one number in two places differs by rounding.
constexpr double rounding_share = 0.01;

/// Whether these numbers differ from `sign` times the others by at most `most`.
bool are_close(std::span<const float> a, std::span<const double> b, double sign, double most) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](float x, double y) { return std::abs(static_cast<double>(x) - sign * y) <= most; });
}

/// Whether a curve has these numbers at every key; of a rotation the opposite ones are the same.
bool holds(const Curve& curve, std::span<const double> rest, double most) {
  for (std::size_t k = 0; k + rest.size() <= curve.values.size(); k += rest.size()) {
    const std::span<const float> key = std::span(curve.values).subspan(k, rest.size());
    if (!are_close(key, rest, 1, most) && !(curve.path == Path::rotation && are_close(key, rest, -1, most)))
      return false;
  }
  return true;
}

/// How long, at most, a unit of each node's own translation is in the world, without animation.
std::vector<double> translation_units(const motion::Skeleton& skeleton) {
  std::vector<glm::dmat4> world(skeleton.size());
  motion::world_matrices(skeleton, skeleton.rest_matrix, world);
  std::vector<double> units;
  for (const int parent : skeleton.parent) {
    const glm::dmat3 above(parent < 0 ? glm::dmat4(1.0) : world[static_cast<std::size_t>(parent)]);
    units.push_back(std::max({glm::length(above[0]), glm::length(above[1]), glm::length(above[2])}));
  }
  return units;
}

/// Cubic splines have tangents, and morph targets no single place where their usual weights are said.
/// `reach`: how far, at most, a unit of the property moves a point.
bool rests(const Curve& curve, const motion::Transform& rest, double tolerance, double reach) {
  if (curve.path == Path::weights || curve.interpolation == Interpolation::cubic_spline) return false;
  const double most = rounding_share * tolerance / std::max(reach, std::numeric_limits<double>::min());
  if (curve.path == Path::rotation)
    return holds(curve, std::array{rest.rotation.x, rest.rotation.y, rest.rotation.z, rest.rotation.w}, most);
  const glm::dvec3& usual = curve.path == Path::translation ? rest.translation : rest.scale;
  return holds(curve, std::array{usual.x, usual.y, usual.z}, most);
}

bool moves_nodes_by_pointer(const gltf::Json& channel) {
  constexpr const char* pointer = "/target/extensions/KHR_animation_pointer/pointer";
  const gltf::Json::json_pointer path(pointer);
  return channel.contains(path) && channel.at(path).is_string() &&
         channel.at(path).get_ref<const std::string&>().starts_with("/nodes/");
}

bool moves_nodes_by_pointer(const gltf::Document& document, const gltf::AnimationSource& animation, std::size_t index) {
  const auto is_pointer = [&](const gltf::UntouchedChannel& channel) {
    return moves_nodes_by_pointer(
        document.json.at("animations").at(index).at("channels").at(static_cast<std::size_t>(channel.channel)));
  };
  return std::any_of(animation.untouched.begin(), animation.untouched.end(), is_pointer);
}

}  // namespace

std::set<NodeProperty> resting_properties(const gltf::Document& document, const gltf::Asset& asset,
                                          const motion::Skeleton& skeleton, double tolerance, double size) {
  const std::vector<double> units = translation_units(skeleton);
  std::set<NodeProperty> resting, moving;
  const auto look = [&](const Curve& curve) {
    if (curve.node < 0) return;
    const auto node = static_cast<std::size_t>(curve.node);
    const double reach = curve.path == Path::translation ? units[node] : size;
    (rests(curve, skeleton.rest[node], tolerance, reach) ? resting : moving).insert({curve.node, curve.path});
  };
  for (std::size_t i = 0; i < asset.animations.size(); ++i) {
    if (moves_nodes_by_pointer(document, asset.animations[i], i)) return {};
    for (const gltf::Channel& channel : asset.animations[i].channels) look(channel.curve);
    for (const gltf::UntouchedChannel& channel : asset.animations[i].untouched) look(channel.curve);
  }
  for (const NodeProperty& property : moving) resting.erase(property);
  return resting;
}

}  // namespace nmc::codec
