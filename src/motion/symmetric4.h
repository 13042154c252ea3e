// The dominant eigenvector of a small symmetric matrix, for means of rotations.
#pragma once

#include <glm/glm.hpp>

namespace nmc::motion {

/// The unit eigenvector of the largest eigenvalue of a symmetric matrix (cyclic Jacobi rotations, to rounding). Its
/// sign is such that the last component that is not zero is positive. Not a number comes back where it is in the
/// matrix.
glm::dvec4 dominant_eigenvector(const glm::dmat4& symmetric);

}  // namespace nmc::motion
