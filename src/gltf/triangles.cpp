// Reads primitives as triangles with at most four influences per corner.
#include "gltf/triangles.h"

#include <algorithm>
#include <string>
#include <utility>

#include "gltf/accessor.h"
#include "gltf/typed_model.h"

namespace nmc::gltf {
namespace {

constexpr std::array<double, 16> identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

class Reader {
 public:
  Reader(const Document& document, const Asset& asset, const tinygltf::Model& model, std::size_t most_vertices,
         std::size_t most_indices)
      : name_(document.name),
        asset_(asset),
        model_(model),
        most_vertices_(most_vertices),
        most_indices_(most_indices) {}

  std::optional<Triangles> run() {
    for (std::size_t n = 0; n < asset_.nodes.size(); ++n) {
      const Node& node = asset_.nodes[n];
      if (node.mesh < 0) continue;
      const std::size_t first_bone = add_bones(node, static_cast<int>(n));
      for (const tinygltf::Primitive& primitive : model_.meshes.at(static_cast<std::size_t>(node.mesh)).primitives)
        if (!add_primitive(primitive, node.skin, first_bone)) return std::nullopt;
    }
    if (made_.indices.empty()) return std::nullopt;
    return std::move(made_);
  }

 private:
  std::size_t add_bones(const Node& node, int index) {
    const std::size_t first = made_.bones.size();
    if (node.skin < 0) {
      made_.bones.push_back({index, identity});
      return first;
    }
    const Skin& skin = asset_.skins[static_cast<std::size_t>(node.skin)];
    for (std::size_t j = 0; j < skin.joints.size(); ++j) made_.bones.push_back({skin.joints[j], skin.inverse_bind[j]});
    return first;
  }

  std::vector<float> attribute(const tinygltf::Primitive& primitive, const std::string& semantic) const {
    const auto found = primitive.attributes.find(semantic);
    return found == primitive.attributes.end() ? std::vector<float>() : read_floats(model_, found->second, name_);
  }

  std::size_t count_of(int accessor) const { return model_.accessors.at(static_cast<std::size_t>(accessor)).count; }

  /// False where there is more than the limits.
  bool add_primitive(const tinygltf::Primitive& primitive, int skin, std::size_t first_bone) {
    const auto position = primitive.attributes.find("POSITION");
    if (primitive.mode > TINYGLTF_MODE_TRIANGLES || primitive.mode < TINYGLTF_MODE_TRIANGLES) return true;
    if (position == primitive.attributes.end()) return true;
    const std::size_t vertices = count_of(position->second);
    const std::size_t corners = primitive.indices < 0 ? vertices : count_of(primitive.indices);
    if (made_.positions.size() + vertices > most_vertices_ || made_.indices.size() + corners > most_indices_ ||
        made_.bones.size() > UINT16_MAX)
      return false;
    const std::size_t joints = skin < 0 ? 0 : asset_.skins[static_cast<std::size_t>(skin)].joints.size();
    if (skin >= 0 && !primitive.attributes.contains("JOINTS_0")) return true;
    const std::vector<float> indices =
        primitive.indices < 0 ? std::vector<float>() : read_floats(model_, primitive.indices, name_);
    for (const float index : indices)
      if (!(static_cast<double>(index) < static_cast<double>(vertices))) return true;
    const auto first = static_cast<std::uint32_t>(made_.positions.size());
    const std::vector<float> positions = attribute(primitive, "POSITION");
    for (std::size_t v = 0; v < vertices; ++v)
      made_.positions.push_back({positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]});
    add_influences(primitive, vertices, joints, first_bone);
    for (std::size_t i = 0; i + 2 < corners; i += 3)
      for (std::size_t k = i; k < i + 3; ++k)
        made_.indices.push_back(first +
                                static_cast<std::uint32_t>(indices.empty() ? static_cast<float>(k) : indices[k]));
    return true;
  }

  void add_influences(const tinygltf::Primitive& primitive, std::size_t vertices, std::size_t joints,
                      std::size_t first_bone) {
    std::vector<std::vector<float>> joint_sets, weight_sets;
    for (const char* set : {"0", "1"}) {
      joint_sets.push_back(attribute(primitive, std::string("JOINTS_") + set));
      weight_sets.push_back(attribute(primitive, std::string("WEIGHTS_") + set));
    }
    for (std::size_t v = 0; v < vertices; ++v) {
      std::vector<std::pair<float, std::uint16_t>> found;
      for (std::size_t s = 0; s < joint_sets.size(); ++s) {
        for (std::size_t k = 4 * v; joints > 0 && k < 4 * v + 4; ++k) {
          if (k >= joint_sets[s].size() || k >= weight_sets[s].size() || !(weight_sets[s][k] > 0)) continue;
          if (!(static_cast<double>(joint_sets[s][k]) < static_cast<double>(joints))) continue;
          found.emplace_back(weight_sets[s][k],
                             static_cast<std::uint16_t>(first_bone + static_cast<std::size_t>(joint_sets[s][k])));
        }
      }
      if (found.empty()) found.emplace_back(1.0F, static_cast<std::uint16_t>(first_bone));
      std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
      found.resize(std::min<std::size_t>(found.size(), 4));
      float sum = 0;
      for (const auto& [weight, bone] : found) sum += weight;
      std::array<std::uint16_t, 4> bones{};
      std::array<float, 4> weights{};
      for (std::size_t i = 0; i < found.size(); ++i) {
        weights[i] = found[i].first / sum;
        bones[i] = found[i].second;
      }
      made_.influences.push_back(bones);
      made_.weights.push_back(weights);
    }
  }

  const std::string& name_;
  const Asset& asset_;
  const tinygltf::Model& model_;
  std::size_t most_vertices_, most_indices_;
  Triangles made_;
};

}  // namespace

std::optional<Triangles> read_triangles(const Document& document, const Asset& asset, std::size_t most_vertices,
                                        std::size_t most_indices) {
  const TypedModel typed = typed_model(document, Contents::drawing);
  return Reader(document, asset, typed.model, most_vertices, most_indices).run();
}

}  // namespace nmc::gltf
