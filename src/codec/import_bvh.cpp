#include "codec/import_bvh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/glm.hpp>

#include "base/error.h"

namespace nmc::codec {
namespace {

using gltf::Bytes;
using gltf::Document;
using gltf::Json;
using motion::BvhClip;
using motion::Skeleton;
using motion::Track;

// glTF 2.0, section 5.1.3 (componentType) and 5.11.5 (bufferView.target)
constexpr int type_u8 = 5121;
constexpr int type_u16 = 5123;
constexpr int type_u32 = 5125;
constexpr int type_f32 = 5126;
constexpr int array_buffer = 34962;
constexpr int element_array_buffer = 34963;
constexpr int no_target = 0;

/// Collects the BIN chunk with its bufferViews and accessors.
class Binary {
 public:
  template <typename Number>
  std::size_t add(const std::vector<Number>& numbers, int component_type, const char* type, std::size_t width,
                  int target) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    const std::size_t offset = bytes_.size();
    const std::size_t length = numbers.size() * sizeof(Number);
    bytes_.resize(offset + length);
    std::memcpy(bytes_.data() + offset, numbers.data(), length);
    Json view{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", length}};
    if (target != no_target) view["target"] = target;
    views_.push_back(std::move(view));
    accessors_.push_back({{"bufferView", views_.size() - 1},
                          {"componentType", component_type},
                          {"count", numbers.size() / width},
                          {"type", type}});
    return accessors_.size() - 1;
  }

  /// Adds min and max, which glTF asks for on positions and key times.
  void add_bounds(std::size_t accessor, const std::vector<float>& numbers, std::size_t width) {
    Json low = Json::array();
    Json high = Json::array();
    for (std::size_t k = 0; k < width; ++k) {
      float least = numbers[k];
      float most = numbers[k];
      for (std::size_t i = k; i < numbers.size(); i += width) {
        least = std::min(least, numbers[i]);
        most = std::max(most, numbers[i]);
      }
      low.push_back(least);
      high.push_back(most);
    }
    accessors_[accessor]["min"] = std::move(low);
    accessors_[accessor]["max"] = std::move(high);
  }

  void move_into(Document& document) {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    document.json["accessors"] = std::move(accessors_);
    document.json["bufferViews"] = std::move(views_);
    document.json["buffers"] = Json::array({{{"byteLength", bytes_.size()}}});
    document.buffers = {std::move(bytes_)};
    document.has_data = {true};
  }

 private:
  Bytes bytes_;
  Json views_ = Json::array();
  Json accessors_ = Json::array();
};

/// Bones as octahedra, each moved by one joint.
struct BoneMesh {
  std::vector<float> positions;
  std::vector<std::uint16_t> joints;  ///< per vertex: index into skin.joints
  std::vector<std::uint32_t> indices;
};

/// An octahedron from `from` to `to`, four corners around the axis at a fifth of its length.
void add_bone(BoneMesh& mesh, std::size_t joint, const glm::dvec3& from, const glm::dvec3& to) {
  constexpr double waist_at = 0.2;
  constexpr double thickness = 0.08;
  const glm::dvec3 axis = to - from;
  const double length = glm::length(axis);
  const glm::dvec3 other = std::abs(axis.y) < 0.9 * length ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 side = glm::normalize(glm::cross(axis, other)) * (thickness * length);
  const glm::dvec3 up = glm::normalize(glm::cross(side, axis)) * (thickness * length);
  const glm::dvec3 waist = from + waist_at * axis;
  const std::array<glm::dvec3, 6> corners{from, waist + side, waist + up, waist - side, waist - up, to};
  const auto base = static_cast<std::uint32_t>(mesh.joints.size());
  for (const glm::dvec3& corner : corners) {
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(static_cast<float>(corner[k]));
    mesh.joints.push_back(static_cast<std::uint16_t>(joint));
  }
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t here = base + 1 + k;
    const std::uint32_t next = base + 1 + (k + 1) % 4;
    for (const std::uint32_t i : {base, here, next, base + 5, next, here}) mesh.indices.push_back(i);
  }
}

std::vector<glm::dvec3> rest_positions(const Skeleton& skeleton) {
  std::vector<glm::dvec3> world(skeleton.size());
  for (const int node : skeleton.order) {
    const auto i = static_cast<std::size_t>(node);
    const int parent = skeleton.parent[i];
    world[i] = skeleton.rest[i].translation + (parent < 0 ? glm::dvec3(0) : world[static_cast<std::size_t>(parent)]);
  }
  return world;
}

BoneMesh make_bones(const Skeleton& skeleton, const std::vector<glm::dvec3>& world) {
  std::vector<std::size_t> joint_of_node(skeleton.size(), skeleton.joints.size());
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j)
    joint_of_node[static_cast<std::size_t>(skeleton.joints[j])] = j;
  BoneMesh mesh;
  std::vector<bool> has_bone(skeleton.joints.size(), false);
  double mean_length = 0;
  std::size_t bones = 0;
  for (std::size_t i = 0; i < skeleton.size(); ++i) {
    if (skeleton.parent[i] < 0) continue;
    const auto parent = static_cast<std::size_t>(skeleton.parent[i]);
    const double length = glm::length(skeleton.rest[i].translation);
    if (!(static_cast<float>(length) > 0)) continue;
    add_bone(mesh, joint_of_node[parent], world[parent], world[i]);
    has_bone[joint_of_node[parent]] = true;
    mean_length += length;
    ++bones;
  }
  const double stub = bones > 0 ? 0.3 * mean_length / static_cast<double>(bones) : 0.1;
  for (std::size_t j = 0; j < has_bone.size(); ++j) {
    const glm::dvec3& origin = world[static_cast<std::size_t>(skeleton.joints[j])];
    if (!has_bone[j]) add_bone(mesh, j, origin, origin + glm::dvec3(0, stub, 0));
  }
  return mesh;
}

Json add_mesh(Binary& binary, const BoneMesh& mesh, std::size_t joint_count) {
  const std::size_t vertices = mesh.joints.size();
  std::vector<float> weights(4 * vertices, 0.0F);
  std::vector<std::uint16_t> joints(4 * vertices, 0);
  for (std::size_t v = 0; v < vertices; ++v) {
    weights[4 * v] = 1.0F;
    joints[4 * v] = mesh.joints[v];
  }
  Json attributes;
  const std::size_t position = binary.add(mesh.positions, type_f32, "VEC3", 3, array_buffer);
  binary.add_bounds(position, mesh.positions, 3);
  attributes["POSITION"] = position;
  if (joint_count <= 256) {
    const std::vector<std::uint8_t> narrow(joints.begin(), joints.end());
    attributes["JOINTS_0"] = binary.add(narrow, type_u8, "VEC4", 4, array_buffer);
  } else {
    attributes["JOINTS_0"] = binary.add(joints, type_u16, "VEC4", 4, array_buffer);
  }
  attributes["WEIGHTS_0"] = binary.add(weights, type_f32, "VEC4", 4, array_buffer);
  const std::size_t indices = binary.add(mesh.indices, type_u32, "SCALAR", 1, element_array_buffer);
  Json primitive{{"attributes", std::move(attributes)}, {"indices", indices}};
  return {{"name", "bones"}, {"primitives", Json::array({std::move(primitive)})}};
}

Json add_skin(Binary& binary, const Skeleton& skeleton, const std::vector<glm::dvec3>& world) {
  std::vector<float> inverse_bind;
  for (const int joint : skeleton.joints) {
    const glm::dvec3& p = world[static_cast<std::size_t>(joint)];
    for (const double v : {1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -p.x, -p.y, -p.z, 1.0}) {
      inverse_bind.push_back(static_cast<float>(v));
    }
  }
  return {{"inverseBindMatrices", binary.add(inverse_bind, type_f32, "MAT4", 16, no_target)},
          {"joints", skeleton.joints}};
}

Json add_animation(Binary& binary, const motion::Clip& clip) {
  const std::size_t times = binary.add(clip.times, type_f32, "SCALAR", 1, no_target);
  binary.add_bounds(times, clip.times, 1);
  Json channels = Json::array();
  Json samplers = Json::array();
  for (const Track& track : clip.tracks) {
    const bool rotation = track.path == Path::rotation;
    const std::size_t values =
        binary.add(track.values, type_f32, rotation ? "VEC4" : "VEC3", rotation ? 4 : 3, no_target);
    channels.push_back({{"sampler", samplers.size()},
                        {"target", {{"node", track.node}, {"path", rotation ? "rotation" : "translation"}}}});
    samplers.push_back({{"input", times}, {"interpolation", "LINEAR"}, {"output", values}});
  }
  return {{"name", clip.name}, {"channels", std::move(channels)}, {"samplers", std::move(samplers)}};
}

Json make_nodes(const Skeleton& skeleton) {
  std::vector<std::vector<int>> children(skeleton.size());
  for (std::size_t i = 0; i < skeleton.size(); ++i) {
    if (skeleton.parent[i] >= 0) children[static_cast<std::size_t>(skeleton.parent[i])].push_back(static_cast<int>(i));
  }
  Json nodes = Json::array();
  for (std::size_t i = 0; i < skeleton.size(); ++i) {
    Json node{{"name", skeleton.names[i]}};
    const glm::dvec3& p = skeleton.rest[i].translation;
    node["translation"] = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    if (!children[i].empty()) node["children"] = children[i];
    nodes.push_back(std::move(node));
  }
  return nodes;
}

Json root_nodes(const Skeleton& skeleton) {
  Json roots = Json::array();
  for (std::size_t i = 0; i < skeleton.size(); ++i) {
    if (skeleton.parent[i] < 0) roots.push_back(i);
  }
  return roots;
}

}  // namespace

Document import_bvh(const BvhClip& bvh) {
  const Skeleton& skeleton = bvh.skeleton;
  if (skeleton.joints.size() > 65536) {
    throw Error(ErrorCode::unsupported,
                fmt::format("the motion has {} joints; glTF skins hold up to 65536.", skeleton.joints.size()));
  }
  const std::vector<glm::dvec3> world = rest_positions(skeleton);
  Binary binary;
  Document document;
  document.is_glb = true;
  Json& json = document.json;
  json["asset"] = {{"version", "2.0"}, {"generator", "gltf-nmc"}};
  json["scene"] = 0;
  Json roots = root_nodes(skeleton);
  roots.push_back(skeleton.size());
  json["scenes"] = Json::array({{{"nodes", std::move(roots)}}});
  json["nodes"] = make_nodes(skeleton);
  json["nodes"].push_back({{"name", "bones"}, {"mesh", 0}, {"skin", 0}});
  json["meshes"] = Json::array({add_mesh(binary, make_bones(skeleton, world), skeleton.joints.size())});
  json["skins"] = Json::array({add_skin(binary, skeleton, world)});
  json["animations"] = Json::array({add_animation(binary, bvh.clip)});
  binary.move_into(document);
  return document;
}

}  // namespace nmc::codec
