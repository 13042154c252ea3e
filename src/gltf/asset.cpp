// Fills the asset from the typed model: nodes in order, skins, animations.
#include "gltf/asset.h"

#include <algorithm>

#include "gltf/accessor.h"
#include "gltf/animation_reader.h"
#include "gltf/typed_model.h"

namespace nmc::gltf {
namespace {

constexpr std::array<double, 16> identity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

template <std::size_t size>
void copy_numbers(const std::vector<double>& from, std::array<double, size>& to) {
  if (from.size() == size) std::copy(from.begin(), from.end(), to.begin());
}

std::vector<double> rest_weights(const tinygltf::Model& model, const tinygltf::Node& node) {
  if (node.mesh < 0) return {};
  const tinygltf::Mesh& mesh = model.meshes[static_cast<std::size_t>(node.mesh)];
  if (!node.weights.empty()) return node.weights;
  if (!mesh.weights.empty()) return mesh.weights;
  return std::vector<double>(mesh.primitives.front().targets.size(), 0.0);
}

std::vector<Node> read_nodes(const tinygltf::Model& model) {
  std::vector<Node> nodes(model.nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const tinygltf::Node& from = model.nodes[i];
    Node& node = nodes[i];
    node.name = from.name;
    node.children = from.children;
    node.mesh = from.mesh;
    node.skin = from.skin;
    node.has_matrix = !from.matrix.empty();
    copy_numbers(from.matrix, node.matrix);
    copy_numbers(from.translation, node.translation);
    copy_numbers(from.rotation, node.rotation);
    copy_numbers(from.scale, node.scale);
    node.weights = rest_weights(model, from);
    for (const int child : from.children) nodes[static_cast<std::size_t>(child)].parent = static_cast<int>(i);
  }
  return nodes;
}

/// Roots first, then their children, and so on.
std::vector<int> order_nodes(const std::vector<Node>& nodes) {
  std::vector<int> order;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (nodes[i].parent < 0) order.push_back(static_cast<int>(i));
  }
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::vector<int>& children = nodes[static_cast<std::size_t>(order[i])].children;
    order.insert(order.end(), children.begin(), children.end());
  }
  return order;
}

std::vector<Skin> read_skins(const tinygltf::Model& model, const std::string& file_name) {
  std::vector<Skin> skins;
  for (const tinygltf::Skin& from : model.skins) {
    Skin skin;
    skin.joints = from.joints;
    skin.inverse_bind.assign(from.joints.size(), identity);
    if (from.inverseBindMatrices >= 0) {
      const std::vector<float> values = read_floats(model, from.inverseBindMatrices, file_name);
      for (std::size_t i = 0; i < 16 * skin.joints.size(); ++i)
        skin.inverse_bind[i / 16][i % 16] = static_cast<double>(values[i]);
    }
    skins.push_back(std::move(skin));
  }
  return skins;
}

}  // namespace

Asset read_asset(const Document& document) {
  const TypedModel typed = typed_model(document, Contents::animation);
  Asset asset;
  asset.nodes = read_nodes(typed.model);
  asset.order = order_nodes(asset.nodes);
  asset.skins = read_skins(typed.model, document.name);
  asset.animations = read_animations(document, typed, asset.nodes);
  return asset;
}

}  // namespace nmc::gltf
