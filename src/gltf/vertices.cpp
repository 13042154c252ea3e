// Reads vertices with their joints, and finds those that matter for error.
#include "gltf/vertices.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <tuple>

#include "base/error.h"
#include "gltf/accessor.h"

namespace nmc::gltf {
namespace {

/// Meshes can share accessors, so that a small file could ask for any number of vertices.
constexpr std::size_t most_vertices = std::size_t{1} << 26;

constexpr double notable_weight = 0.25;

std::vector<float> read_attribute(const tinygltf::Model& model, const std::map<std::string, int>& attributes,
                                  const std::string& semantic, const std::string& file_name) {
  const auto found = attributes.find(semantic);
  return found == attributes.end() ? std::vector<float>() : read_floats(model, found->second, file_name);
}

void check_size(const Vertices& vertices, std::size_t more, const std::string& file_name) {
  if (more > most_vertices - std::min(most_vertices, vertices.size())) {
    throw Error(ErrorCode::unsupported,
                fmt::format("{}: the meshes have more than {} vertices.", file_name, most_vertices));
  }
}

/// Adds a weight to the binding of its joint among those from `start` on.
void add_weight(std::vector<Binding>& bindings, std::size_t start, int joint, double weight) {
  for (std::size_t i = start; i < bindings.size(); ++i) {
    if (bindings[i].joint != joint) continue;
    bindings[i].weight += weight;
    return;
  }
  bindings.push_back({joint, weight});
}

/// A set of JOINTS_n and WEIGHTS_n, four of each per vertex.
struct JointSet {
  std::vector<float> joints;
  std::vector<float> weights;
};

std::vector<JointSet> read_joint_sets(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                      const std::string& file_name) {
  std::vector<JointSet> sets;
  for (int n = 0;; ++n) {
    JointSet set{read_attribute(model, primitive.attributes, fmt::format("JOINTS_{}", n), file_name),
                 read_attribute(model, primitive.attributes, fmt::format("WEIGHTS_{}", n), file_name)};
    if (set.joints.empty() || set.weights.empty()) return sets;
    sets.push_back(std::move(set));
  }
}

/// Appends the bindings of one vertex, weights summing to 1; none when all its weights are zero.
void add_bindings(const std::vector<JointSet>& sets, std::size_t vertex, std::size_t joint_count, const Where& where,
                  std::vector<Binding>& bindings) {
  const std::size_t start = bindings.size();
  for (const JointSet& set : sets) {
    for (std::size_t k = 4 * vertex; k < 4 * vertex + 4; ++k) {
      const double weight = static_cast<double>(set.weights[k]);
      if (weight == 0) continue;
      if (weight < 0) where.fail(fmt::format("has a negative joint weight at vertex {}", vertex));
      if (!(static_cast<double>(set.joints[k]) < static_cast<double>(joint_count))) {
        where.fail(fmt::format("binds vertex {} to joint {} of a skin with {}", vertex, set.joints[k], joint_count));
      }
      add_weight(bindings, start, static_cast<int>(set.joints[k]), weight);
    }
  }
  double sum = 0;
  for (std::size_t i = start; i < bindings.size(); ++i) sum += bindings[i].weight;
  for (std::size_t i = start; i < bindings.size(); ++i) bindings[i].weight /= sum;
}

double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The six axes and the eight corners of the cube.
std::vector<std::array<double, 3>> make_directions() {
  std::vector<std::array<double, 3>> directions;
  for (const double sign : {-1.0, 1.0}) {
    directions.push_back({sign, 0, 0});
    directions.push_back({0, sign, 0});
    directions.push_back({0, 0, sign});
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) directions.push_back({sign, y, z});
    }
  }
  return directions;
}

/// The best vertex so far by some score; the first of equals.
struct Best {
  double score = -std::numeric_limits<double>::infinity();
  std::size_t vertex = 0;

  void offer(double new_score, std::size_t new_vertex) {
    if (new_score > score) *this = {new_score, new_vertex};
  }
};

bool is_found(const Best& best) { return std::isfinite(best.score); }

}  // namespace

std::array<double, 3> transform(const std::array<double, 16>& m, const std::array<float, 3>& point) {
  const auto x = static_cast<double>(point[0]);
  const auto y = static_cast<double>(point[1]);
  const auto z = static_cast<double>(point[2]);
  return {m[0] * x + m[4] * y + m[8] * z + m[12], m[1] * x + m[5] * y + m[9] * z + m[13],
          m[2] * x + m[6] * y + m[10] * z + m[14]};
}

void add_skinned_vertices(const tinygltf::Model& model, int mesh, const Skin& skin, const std::string& file_name,
                          Vertices& vertices) {
  const auto& primitives = model.meshes.at(static_cast<std::size_t>(mesh)).primitives;
  for (std::size_t p = 0; p < primitives.size(); ++p) {
    const Where where{file_name, fmt::format("meshes[{}].primitives[{}]", mesh, p)};
    const std::vector<float> positions = read_attribute(model, primitives[p].attributes, "POSITION", file_name);
    const std::vector<JointSet> sets = read_joint_sets(model, primitives[p], file_name);
    if (sets.empty()) continue;
    check_size(vertices, positions.size() / 3, file_name);
    for (std::size_t v = 0; v < positions.size() / 3; ++v) {
      add_bindings(sets, v, skin.joints.size(), where, vertices.bindings);
      if (vertices.bindings.size() == vertices.first.back()) continue;
      vertices.first.push_back(vertices.bindings.size());
      vertices.positions.push_back({positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]});
    }
  }
}

Vertices rigid_vertices(const tinygltf::Model& model, int mesh, const std::string& file_name) {
  Vertices vertices;
  for (const tinygltf::Primitive& primitive : model.meshes.at(static_cast<std::size_t>(mesh)).primitives) {
    const std::vector<float> positions = read_attribute(model, primitive.attributes, "POSITION", file_name);
    check_size(vertices, positions.size() / 3, file_name);
    for (std::size_t v = 0; v < positions.size() / 3; ++v) {
      vertices.bindings.push_back({0, 1.0});
      vertices.first.push_back(vertices.bindings.size());
      vertices.positions.push_back({positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]});
    }
  }
  return vertices;
}

std::vector<double> longest_deltas(const tinygltf::Model& model, int mesh, const std::string& file_name) {
  const auto& primitives = model.meshes.at(static_cast<std::size_t>(mesh)).primitives;
  std::vector<double> longest(primitives.front().targets.size(), 0.0);
  for (const tinygltf::Primitive& primitive : primitives) {
    for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
      const std::vector<float> deltas = read_attribute(model, primitive.targets[t], "POSITION", file_name);
      for (std::size_t i = 0; i + 2 < deltas.size(); i += 3) {
        longest[t] = std::max(longest[t], std::hypot(static_cast<double>(deltas[i]), static_cast<double>(deltas[i + 1]),
                                                     static_cast<double>(deltas[i + 2])));
      }
    }
  }
  return longest;
}

std::vector<std::size_t> distinct_vertices(const Vertices& vertices) {
  std::vector<std::size_t> order(vertices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto compare = [&vertices](std::size_t a, std::size_t b) {
    if (vertices.positions[a] != vertices.positions[b]) return vertices.positions[a] < vertices.positions[b] ? -1 : 1;
    const auto less = [](const Binding& x, const Binding& y) {
      return std::tie(x.joint, x.weight) < std::tie(y.joint, y.weight);
    };
    const std::span<const Binding> x = vertices.bindings_of(a);
    const std::span<const Binding> y = vertices.bindings_of(b);
    if (std::equal(x.begin(), x.end(), y.begin(), y.end())) return 0;
    return std::lexicographical_compare(x.begin(), x.end(), y.begin(), y.end(), less) ? -1 : 1;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return compare(a, b) < 0; });
  order.erase(std::unique(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return compare(a, b) == 0; }),
              order.end());
  std::sort(order.begin(), order.end());
  return order;
}

std::vector<std::size_t> extreme_vertices(const Vertices& vertices,
                                          std::span<const std::array<double, 16>> inverse_bind) {
  static const std::vector<std::array<double, 3>> directions = make_directions();
  std::vector<double> largest_weight(inverse_bind.size(), 0.0);
  for (const Binding& binding : vertices.bindings) {
    double& largest = largest_weight[static_cast<std::size_t>(binding.joint)];
    largest = std::max(largest, binding.weight);
  }
  std::vector<Best> outermost(inverse_bind.size() * directions.size());
  std::vector<Best> farthest(inverse_bind.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    for (const Binding& binding : vertices.bindings_of(v)) {
      const auto joint = static_cast<std::size_t>(binding.joint);
      const std::array<double, 3> local = transform(inverse_bind[joint], vertices.positions[v]);
      farthest[joint].offer(binding.weight * std::sqrt(dot(local, local)), v);
      if (binding.weight < std::min(notable_weight, largest_weight[joint])) continue;
      for (std::size_t d = 0; d < directions.size(); ++d)
        outermost[joint * directions.size() + d].offer(dot(local, directions[d]), v);
    }
  }
  std::set<std::size_t> chosen;
  for (const std::vector<Best>& bests : {outermost, farthest}) {
    for (const Best& best : bests) {
      if (is_found(best)) chosen.insert(best.vertex);
    }
  }
  return {chosen.begin(), chosen.end()};
}

}  // namespace nmc::gltf
