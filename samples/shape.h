// Bodies from rounded cones: a smooth signed distance field around the skeleton, polygonised, with skin weights.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace nmc::samples {

/// A rounded cone between two points, with its own radius at each.
struct Blob {
  int joint = 0;              ///< the joint that moves it
  glm::dvec3 a{0.0}, b{0.0};  ///< ends in the rest pose, metres
  double radius_a = 0.0, radius_b = 0.0;
  glm::dvec3 flat{0.0, 0.0, 1.0};  ///< unit direction of the flattening
  double flatness = 1.0;           ///< thickness along `flat` relative to the width; 1 is round
  bool carve = false;              ///< takes away instead of adding
  double smoothness = 0.0;         ///< of its own blend with the blobs before it; 0 is the part's
};

/// A closed surface of one colour: the smooth union of its blobs.
struct Part {
  std::string name;
  glm::dvec3 colour{1.0};    ///< linear RGB, 0 .. 1
  double cell = 0.02;        ///< side of the polygonisation grid's cells, metres
  double smoothness = 0.02;  ///< width of the blend between neighbouring blobs, metres
  std::vector<Blob> blobs;
};

/// A skinned triangle mesh in the rest pose.
struct SkinMesh {
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::u8vec4> colours;
  std::vector<std::array<std::uint16_t, 4>> joints;
  std::vector<std::array<float, 4>> weights;  ///< sum to 1, largest first
  std::vector<std::uint32_t> indices;
};

/// Signed distance (approximate where a blob is flattened) of a point to a part's surface, metres, negative inside.
double distance_to(const Part& part, const glm::dvec3& point);

/// Polygonises all parts with surface nets (Gibson 1998); vertices are projected to the surface, normals are the
/// field's gradient.
SkinMesh polygonise(const std::vector<Part>& parts);

}  // namespace nmc::samples
