// Local matrices and their products down the node tree.
#include "motion/skeleton.h"

#include "motion/index.h"
#include "motion/symmetric4.h"

namespace nmc::motion {
namespace {

/// The rotation nearest to a 3x3 matrix m[column][row] whose columns have unit length: the dominant eigenvector of the
/// matrix of Bar-Itzhack, "New method for extracting the quaternion from a rotation matrix" (2000).
glm::dquat nearest_rotation(const glm::dmat3& m) {
  glm::dmat4 k(0.0);
  k[0][0] = m[0][0] - m[1][1] - m[2][2];
  k[1][1] = m[1][1] - m[0][0] - m[2][2];
  k[2][2] = m[2][2] - m[0][0] - m[1][1];
  k[3][3] = m[0][0] + m[1][1] + m[2][2];
  k[0][1] = k[1][0] = m[1][0] + m[0][1];
  k[0][2] = k[2][0] = m[2][0] + m[0][2];
  k[1][2] = k[2][1] = m[2][1] + m[1][2];
  k[0][3] = k[3][0] = m[1][2] - m[2][1];
  k[1][3] = k[3][1] = m[2][0] - m[0][2];
  k[2][3] = k[3][2] = m[0][1] - m[1][0];
  const glm::dvec4 q = dominant_eigenvector(k);
  return glm::dquat(q.w, q.x, q.y, q.z);
}

}  // namespace

glm::dmat4 to_matrix(const Transform& transform) {
  const glm::dmat3 rotation = glm::mat3_cast(transform.rotation);
  return glm::dmat4(glm::dvec4(rotation[0] * transform.scale.x, 0.0), glm::dvec4(rotation[1] * transform.scale.y, 0.0),
                    glm::dvec4(rotation[2] * transform.scale.z, 0.0), glm::dvec4(transform.translation, 1.0));
}

Transform decompose(const glm::dmat4& matrix) {
  glm::dmat3 m(matrix);
  Transform result;
  result.translation = glm::dvec3(matrix[3]);
  for (int i = 0; i < 3; ++i) result.scale[i] = glm::length(m[i]);
  if (glm::determinant(m) < 0.0) result.scale.x = -result.scale.x;
  for (int i = 0; i < 3; ++i) m[i] /= result.scale[i] == 0.0 ? 1.0 : result.scale[i];
  result.rotation = nearest_rotation(m);
  return result;
}

void world_matrices(const Skeleton& skeleton, std::span<const glm::dmat4> local, std::span<glm::dmat4> world) {
  for (const int node : skeleton.order) {
    const int parent = skeleton.parent[at(node)];
    world[at(node)] = parent < 0 ? local[at(node)] : world[at(parent)] * local[at(node)];
  }
}

}  // namespace nmc::motion
