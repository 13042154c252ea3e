// A rigged, skinned, animated character as a GLB file.
#include "samples/export.h"

#include <cmath>

#include "samples/glb.h"

namespace nmc::samples {
namespace {

using Floats = std::vector<float>;

void append(Floats& floats, const glm::dvec3& v) {
  for (int i = 0; i < 3; ++i) floats.push_back(static_cast<float>(v[i]));
}

void append(Floats& floats, const glm::dquat& q) {
  for (const double value : {q.x, q.y, q.z, q.w}) floats.push_back(static_cast<float>(value));
}

/// Collects values as accessors of one shared bufferView: the next one, which is written at the end.
class AnimationData {
 public:
  explicit AnimationData(GlbBuilder& glb) : glb_(glb), view_(glb.json["bufferViews"].size()) {}
  std::size_t add(const Floats& values, AccessorInfo info) {
    const std::size_t offset = floats_.size() * sizeof(float);
    floats_.insert(floats_.end(), values.begin(), values.end());
    return glb_.add_accessor(view_, offset, info);
  }
  void finish() { glb_.add_view(to_bytes(floats_)); }

 private:
  GlbBuilder& glb_;
  std::size_t view_;
  Floats floats_;
};

Json to_json(const glm::dvec3& v) {
  Floats floats;
  append(floats, v);
  return floats;
}

Json to_json(const glm::dquat& q) {
  Floats floats;
  append(floats, q);
  return floats;
}

/// Joints are the nodes 1 ..; node 0 is the armature, the node after the joints carries the mesh.
std::size_t node_of(std::size_t joint) { return joint + 1; }

void add_nodes(GlbBuilder& glb, const Rig& rig, const ExportOptions& options) {
  const Pose rest = rest_pose(rig);
  Json nodes = Json::array({{{"name", options.name}, {"children", Json::array()}}});
  for (std::size_t j = 0; j < rig.joints.size(); ++j) {
    const int index = static_cast<int>(j);
    nodes.push_back({{"name", rig.joints[j].name},
                     {"translation", to_json(local_translation(rig, rest, index))},
                     {"rotation", to_json(local_rotation(rig, rest, index))}});
    nodes[static_cast<std::size_t>(rig.joints[j].parent + 1)]["children"].push_back(node_of(j));
  }
  nodes.push_back({{"name", options.name + "_body"}, {"mesh", 0}, {"skin", 0}});
  glb.json["scene"] = 0;
  glb.json["scenes"] = Json::array({{{"name", "Scene"}, {"nodes", {0, nodes.size() - 1}}}});
  glb.json["nodes"] = std::move(nodes);
}

void add_skin(GlbBuilder& glb, const Rig& rig, const ExportOptions& options) {
  Floats matrices;
  Json joints = Json::array();
  for (std::size_t j = 0; j < rig.joints.size(); ++j) {
    glm::dmat4 bind = glm::mat4_cast(rig.joints[j].rest);
    bind[3] = glm::dvec4(rig.joints[j].head, 1.0);
    const glm::dmat4 inverse = glm::inverse(bind);
    for (int column = 0; column < 4; ++column) {
      append(matrices, glm::dvec3(inverse[column]));
      matrices.push_back(column == 3 ? 1.0f : 0.0f);
    }
    joints.push_back(node_of(j));
  }
  const std::size_t view = glb.add_view(to_bytes(matrices));
  const std::size_t accessor =
      glb.add_accessor(view, 0, {ComponentType::f32, "MAT4", rig.joints.size(), false, {}, {}});
  glb.json["skins"] = Json::array(
      {{{"name", options.name}, {"inverseBindMatrices", accessor}, {"skeleton", node_of(0)}, {"joints", joints}}});
}

template <typename T>
std::size_t add_attribute(GlbBuilder& glb, const std::vector<T>& values, AccessorInfo info) {
  info.count = values.size();
  return glb.add_accessor(glb.add_view(to_bytes(values), ViewTarget::vertices), 0, info);
}

std::size_t add_positions(GlbBuilder& glb, const SkinMesh& mesh) {
  glm::vec3 low = mesh.positions.front(), high = low;
  for (const glm::vec3& p : mesh.positions) low = glm::min(low, p), high = glm::max(high, p);
  return add_attribute(glb, mesh.positions,
                       {ComponentType::f32, "VEC3", 0, false, {low.x, low.y, low.z}, {high.x, high.y, high.z}});
}

/// Weights as bytes that sum to exactly 255 (glTF 2.0, 3.7.3.3).
std::vector<glm::u8vec4> byte_weights(const SkinMesh& mesh) {
  std::vector<glm::u8vec4> result;
  for (const auto& weights : mesh.weights) {
    glm::u8vec4 bytes(0);
    int rest = 255;
    for (int i = 3; i > 0; --i) {
      bytes[i] = static_cast<std::uint8_t>(std::lround(weights[static_cast<std::size_t>(i)] * 255.0f));
      rest -= bytes[i];
    }
    bytes[0] = static_cast<std::uint8_t>(rest);
    result.push_back(bytes);
  }
  return result;
}

void add_skin_attributes(GlbBuilder& glb, const SkinMesh& mesh, const ExportOptions& options, Json& attributes) {
  if (!options.small_weights) {
    std::vector<glm::u8vec4> joints;
    for (const auto& j : mesh.joints) joints.emplace_back(j[0], j[1], j[2], j[3]);
    attributes["JOINTS_0"] = add_attribute(glb, joints, {ComponentType::u8, "VEC4", 0, false, {}, {}});
    attributes["WEIGHTS_0"] = add_attribute(glb, mesh.weights, {ComponentType::f32, "VEC4", 0, false, {}, {}});
    return;
  }
  // A joint whose weight rounds to zero must have index zero.
  std::vector<std::array<std::uint16_t, 4>> joints = mesh.joints;
  const std::vector<glm::u8vec4> weights = byte_weights(mesh);
  for (std::size_t v = 0; v < joints.size(); ++v) {
    for (int i = 0; i < 4; ++i) {
      if (weights[v][i] == 0) joints[v][static_cast<std::size_t>(i)] = 0;
    }
  }
  attributes["JOINTS_0"] = add_attribute(glb, joints, {ComponentType::u16, "VEC4", 0, false, {}, {}});
  attributes["WEIGHTS_0"] = add_attribute(glb, weights, {ComponentType::u8, "VEC4", 0, true, {}, {}});
}

void add_mesh(GlbBuilder& glb, const SkinMesh& mesh, const ExportOptions& options) {
  Json attributes = {{"POSITION", add_positions(glb, mesh)}};
  attributes["NORMAL"] = add_attribute(glb, mesh.normals, {ComponentType::f32, "VEC3", 0, false, {}, {}});
  attributes["COLOR_0"] = add_attribute(glb, mesh.colours, {ComponentType::u8, "VEC4", 0, true, {}, {}});
  add_skin_attributes(glb, mesh, options, attributes);
  const std::vector<std::uint16_t> indices(mesh.indices.begin(), mesh.indices.end());
  const std::size_t index_view = glb.add_view(to_bytes(indices), ViewTarget::indices);
  const std::size_t index_accessor =
      glb.add_accessor(index_view, 0, {ComponentType::u16, "SCALAR", indices.size(), false, {}, {}});
  glb.json["materials"] =
      Json::array({{{"name", "body"}, {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.8}}}}});
  const Json primitive = {{"attributes", attributes}, {"indices", index_accessor}, {"material", 0}};
  glb.json["meshes"] = Json::array({{{"name", options.name}, {"primitives", Json::array({primitive})}}});
}

void add_channel(Json& animation, std::size_t node, const char* path, std::size_t input, std::size_t output) {
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  animation["samplers"].push_back({{"input", input}, {"interpolation", "LINEAR"}, {"output", output}});
}

std::size_t add_times(AnimationData& data, const PoseClip& clip) {
  Floats times;
  for (std::size_t i = 0; i < clip.poses.size(); ++i) {
    times.push_back(static_cast<float>((clip.first_frame + static_cast<double>(i)) / clip.frames_per_second));
  }
  return data.add(times, {ComponentType::f32, "SCALAR", times.size(), false, {times.front()}, {times.back()}});
}

Floats translations_of(const Rig& rig, const PoseClip& clip, int joint) {
  Floats values;
  for (const Pose& pose : clip.poses) append(values, local_translation(rig, pose, joint));
  return values;
}

/// Signs are chosen so that neighbouring keys lie on the same half of the quaternion sphere.
Floats rotations_of(const Rig& rig, const PoseClip& clip, int joint) {
  Floats values;
  glm::dquat last = local_rotation(rig, rest_pose(rig), joint);
  for (const Pose& pose : clip.poses) {
    glm::dquat rotation = local_rotation(rig, pose, joint);
    if (glm::dot(rotation, last) < 0.0) rotation = -rotation;
    append(values, rotation);
    last = rotation;
  }
  return values;
}

void add_animation(GlbBuilder& glb, AnimationData& data, const Rig& rig, const PoseClip& clip,
                   const ExportOptions& options) {
  Json animation = {{"name", clip.name}, {"channels", Json::array()}, {"samplers", Json::array()}};
  const std::size_t count = clip.poses.size();
  const std::size_t input = add_times(data, clip);
  const auto add = [&](std::size_t joint, const char* path, const char* type, const Floats& values) {
    add_channel(animation, node_of(joint), path, input,
                data.add(values, {ComponentType::f32, type, count, false, {}, {}}));
  };
  for (std::size_t j = 0; j < rig.joints.size(); ++j) {
    const int index = static_cast<int>(j);
    if (j == 0 || options.all_channels) add(j, "translation", "VEC3", translations_of(rig, clip, index));
    add(j, "rotation", "VEC4", rotations_of(rig, clip, index));
    if (options.all_channels) add(j, "scale", "VEC3", Floats(3 * count, 1.0f));
  }
  glb.json["animations"].push_back(std::move(animation));
}

}  // namespace

std::vector<std::uint8_t> export_character(const Rig& rig, const SkinMesh& mesh, const std::vector<PoseClip>& clips,
                                           const ExportOptions& options) {
  GlbBuilder glb;
  add_nodes(glb, rig, options);
  add_mesh(glb, mesh, options);
  add_skin(glb, rig, options);
  AnimationData data(glb);
  for (const PoseClip& clip : clips) add_animation(glb, data, rig, clip, options);
  data.finish();
  return glb.finish();
}

}  // namespace nmc::samples
