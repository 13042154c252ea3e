// The node tree that animation moves: parents, rest transforms, world transforms.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <string>
#include <vector>

namespace nmc::motion {

/// A local transform: p -> translation + rotation * (scale * p).
struct Transform {
  glm::dvec3 translation{0.0};
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  ///< w, x, y, z in GLM's constructor; unit length
  glm::dvec3 scale{1.0};
};

/// The 4x4 matrix of a transform.
glm::dmat4 to_matrix(const Transform& transform);

/// The transform of an affine matrix without shear; a mirroring one gets a negative x scale. Of a sheared one the
/// nearest rotation to its columns is taken: to_matrix(decompose(m)) is then not m.
Transform decompose(const glm::dmat4& matrix);

/// Nodes numbered as in the file.
struct Skeleton {
  std::vector<std::string> names;
  std::vector<int> parent;                        ///< -1 for a root
  std::vector<int> order;                         ///< all nodes, parents before children
  std::vector<Transform> rest;                    ///< a matrix node's is its decomposition
  std::vector<glm::dmat4> rest_matrix;            ///< the exact local matrix, also where it has no decomposition
  std::vector<std::vector<double>> rest_weights;  ///< morph weights at rest
  std::vector<int> joints;                        ///< skin joints, ascending, unique; empty without skins

  std::size_t size() const { return parent.size(); }
};

/// World matrices of all nodes from local ones. Both spans have skeleton.size() entries.
void world_matrices(const Skeleton& skeleton, std::span<const glm::dmat4> local, std::span<glm::dmat4> world);

}  // namespace nmc::motion
