// Bodies from rounded cones: a smooth signed distance field around the skeleton, polygonised, with skin weights.
#include "samples/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nmc::samples {
namespace {

/// Position along the blob's axis (0 .. 1) and distance to it, in the space where the blob is round.
struct AxisPoint {
  double along = 0.0;
  double distance = 0.0;
};

AxisPoint project_on_axis(const Blob& blob, const glm::dvec3& point) {
  const glm::dvec3 axis = blob.b - blob.a;
  glm::dvec3 offset = point - blob.a;
  offset += blob.flat * (glm::dot(offset, blob.flat) * (1.0 / blob.flatness - 1.0));
  const double along = std::clamp(glm::dot(offset, axis) / std::max(glm::dot(axis, axis), 1e-12), 0.0, 1.0);
  return {along, glm::length(offset - along * axis)};
}

double radius_at(const Blob& blob, double along) { return blob.radius_a + along * (blob.radius_b - blob.radius_a); }

double distance_to(const Blob& blob, const glm::dvec3& point) {
  const AxisPoint at = project_on_axis(blob, point);
  return (at.distance - radius_at(blob, at.along)) * std::min(1.0, blob.flatness);
}

/// Polynomial smooth minimum: differs from the minimum only where the two are closer than `width`.
double smooth_min(double a, double b, double width) {
  const double h = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - h * h * width * 0.25;
}

glm::dvec3 gradient(const Part& part, const glm::dvec3& point) {
  constexpr double step = 1e-4;
  glm::dvec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 offset(0.0);
    offset[axis] = step;
    result[axis] = (distance_to(part, point + offset) - distance_to(part, point - offset)) / (2.0 * step);
  }
  return result;
}

glm::dvec3 project_on_surface(const Part& part, glm::dvec3 point) {
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 slope = gradient(part, point);
    const double move = distance_to(part, point) / std::max(glm::dot(slope, slope), 0.05);
    point -= std::clamp(move, -0.5 * part.cell, 0.5 * part.cell) * slope;
  }
  return point;
}

/// Weights fall with the distance to the joints' blobs, measured in the blobs' radii, so that they are sharp in the
/// middle of a limb and blend across a joint.
void add_weights(SkinMesh& mesh, const Part& part, const glm::dvec3& point) {
  constexpr double sharpness = 9.0;
  std::vector<std::pair<double, int>> by_joint;
  for (const Blob& blob : part.blobs) {
    if (blob.carve) continue;
    const AxisPoint at = project_on_axis(blob, point);
    const double weight = std::pow(radius_at(blob, at.along) / std::max(at.distance, 1e-4), sharpness);
    const auto found =
        std::find_if(by_joint.begin(), by_joint.end(), [&](const auto& entry) { return entry.second == blob.joint; });
    if (found == by_joint.end()) {
      by_joint.emplace_back(weight, blob.joint);
    } else {
      found->first = std::max(found->first, weight);
    }
  }
  std::stable_sort(by_joint.begin(), by_joint.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  by_joint.resize(std::min<std::size_t>(by_joint.size(), 4));
  const double largest = by_joint.front().first;
  std::erase_if(by_joint, [&](const auto& entry) { return entry.first < 0.02 * largest; });
  double sum = 0.0;
  for (const auto& entry : by_joint) sum += entry.first;

  std::array<std::uint16_t, 4> joints{};
  std::array<float, 4> weights{};
  float rest = 1.0f;
  for (std::size_t i = by_joint.size(); i-- > 0;) {
    joints[i] = static_cast<std::uint16_t>(by_joint[i].second);
    weights[i] = i == 0 ? rest : static_cast<float>(by_joint[i].first / sum);
    rest -= weights[i];
  }
  mesh.joints.push_back(joints);
  mesh.weights.push_back(weights);
}

/// The field sampled at the corners of a grid of cubes.
class Grid {
 public:
  explicit Grid(const Part& part) : cell_(part.cell) {
    glm::dvec3 low(std::numeric_limits<double>::max()), high(-std::numeric_limits<double>::max());
    for (const Blob& blob : part.blobs) {
      const double margin =
          std::max(blob.radius_a, blob.radius_b) * std::max(1.0, blob.flatness) + part.smoothness + 2.0 * cell_;
      low = glm::min(low, glm::min(blob.a, blob.b) - margin);
      high = glm::max(high, glm::max(blob.a, blob.b) + margin);
    }
    // Centred on x = 0, so that a symmetric body gets a symmetric mesh.
    const double reach = std::ceil(std::max(std::abs(low.x), std::abs(high.x)) / cell_);
    if (low.x < 0.0 && high.x > 0.0) low.x = -reach * cell_, high.x = reach * cell_;
    origin_ = low;
    size_ = glm::ivec3(glm::ceil((high - low) / cell_)) + 1;
    values_.resize(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                   static_cast<std::size_t>(size_.z));
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y)
        for (int x = 0; x < size_.x; ++x) values_[index({x, y, z})] = distance_to(part, corner({x, y, z}));
  }

  const glm::ivec3& size() const { return size_; }
  std::size_t count() const { return values_.size(); }
  glm::dvec3 corner(const glm::ivec3& at) const { return origin_ + cell_ * glm::dvec3(at); }
  double value(const glm::ivec3& at) const { return values_[index(at)]; }
  std::size_t index(const glm::ivec3& at) const {
    return (static_cast<std::size_t>(at.z) * static_cast<std::size_t>(size_.y) + static_cast<std::size_t>(at.y)) *
               static_cast<std::size_t>(size_.x) +
           static_cast<std::size_t>(at.x);
  }

 private:
  double cell_;
  glm::dvec3 origin_{0.0};
  glm::ivec3 size_{0};
  std::vector<double> values_;
};

constexpr std::uint32_t no_vertex = 0xffffffffu;

/// The mean of the points where the surface crosses a cube's edges; false when it does not.
bool surface_point(const Grid& grid, const glm::ivec3& cube, glm::dvec3& point) {
  glm::dvec3 sum(0.0);
  int crossings = 0;
  for (int axis = 0; axis < 3; ++axis) {
    for (int edge = 0; edge < 4; ++edge) {
      glm::ivec3 from = cube;
      from[(axis + 1) % 3] += edge & 1;
      from[(axis + 2) % 3] += edge >> 1;
      glm::ivec3 to = from;
      to[axis] += 1;
      const double a = grid.value(from), b = grid.value(to);
      if ((a < 0.0) == (b < 0.0)) continue;
      sum += glm::mix(grid.corner(from), grid.corner(to), a / (a - b));
      ++crossings;
    }
  }
  if (crossings == 0) return false;
  point = sum / static_cast<double>(crossings);
  return true;
}

void add_vertex(SkinMesh& mesh, const Part& part, const glm::dvec3& rough_point) {
  const glm::dvec3 point = project_on_surface(part, rough_point);
  mesh.positions.emplace_back(point);
  mesh.normals.emplace_back(glm::normalize(gradient(part, point)));
  mesh.colours.emplace_back(glm::round(glm::clamp(part.colour, 0.0, 1.0) * 255.0), 255);
  add_weights(mesh, part, point);
}

void add_quad(SkinMesh& mesh, const std::array<std::uint32_t, 4>& corners, bool flip) {
  const std::array<std::size_t, 6> order =
      flip ? std::array<std::size_t, 6>{0, 2, 1, 0, 3, 2} : std::array<std::size_t, 6>{0, 1, 2, 0, 2, 3};
  for (const std::size_t i : order) mesh.indices.push_back(corners[i]);
}

void polygonise(SkinMesh& mesh, const Part& part) {
  const Grid grid(part);
  std::vector<std::uint32_t> vertex_of(grid.count(), no_vertex);
  const glm::ivec3 cubes = grid.size() - 1;
  for (int z = 0; z < cubes.z; ++z)
    for (int y = 0; y < cubes.y; ++y)
      for (int x = 0; x < cubes.x; ++x) {
        glm::dvec3 point;
        if (!surface_point(grid, {x, y, z}, point)) continue;
        vertex_of[grid.index({x, y, z})] = static_cast<std::uint32_t>(mesh.positions.size());
        add_vertex(mesh, part, point);
      }
  for (int z = 1; z < cubes.z; ++z)
    for (int y = 1; y < cubes.y; ++y)
      for (int x = 1; x < cubes.x; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          const glm::ivec3 at(x, y, z);
          glm::ivec3 next = at, u(0), v(0);
          next[axis] += 1;
          u[(axis + 1) % 3] = 1;
          v[(axis + 2) % 3] = 1;
          const bool inside = grid.value(at) < 0.0;
          if (inside == (grid.value(next) < 0.0)) continue;
          add_quad(mesh,
                   {vertex_of[grid.index(at - u - v)], vertex_of[grid.index(at - v)], vertex_of[grid.index(at)],
                    vertex_of[grid.index(at - u)]},
                   !inside);
        }
}

}  // namespace

double distance_to(const Part& part, const glm::dvec3& point) {
  const auto width = [&](const Blob& blob) { return blob.smoothness > 0.0 ? blob.smoothness : part.smoothness; };
  double distance = 1e3;
  for (const Blob& blob : part.blobs) {
    if (!blob.carve) distance = smooth_min(distance, distance_to(blob, point), width(blob));
  }
  for (const Blob& blob : part.blobs) {
    if (blob.carve) distance = -smooth_min(-distance, distance_to(blob, point), width(blob));
  }
  return distance;
}

SkinMesh polygonise(const std::vector<Part>& parts) {
  SkinMesh mesh;
  for (const Part& part : parts) polygonise(mesh, part);
  return mesh;
}

}  // namespace nmc::samples
