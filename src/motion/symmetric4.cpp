// Cyclic Jacobi diagonalisation of a symmetric 4x4 matrix.
#include "motion/symmetric4.h"

#include <cmath>

namespace nmc::motion {
namespace {

/// Jacobi converges quadratically; a 4x4 matrix needs five or six sweeps.
constexpr int max_sweeps = 32;

/// Rotates rows and columns p and q so that a[p][q] becomes zero.
void rotate(glm::dmat4& a, glm::dmat4& vectors, int p, int q) {
  if (a[p][q] == 0.0) return;
  const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
  const double t = (theta >= 0.0 ? 1.0 : -1.0) / (std::abs(theta) + std::hypot(theta, 1.0));
  const double c = 1.0 / std::hypot(t, 1.0);
  const double s = t * c;
  for (int k = 0; k < 4; ++k) {
    const double kp = a[k][p], kq = a[k][q];
    a[k][p] = c * kp - s * kq;
    a[k][q] = s * kp + c * kq;
  }
  for (int k = 0; k < 4; ++k) {
    const double pk = a[p][k], qk = a[q][k];
    a[p][k] = c * pk - s * qk;
    a[q][k] = s * pk + c * qk;
  }
  a[p][q] = a[q][p] = 0.0;
  const glm::dvec4 vp = vectors[p], vq = vectors[q];
  vectors[p] = c * vp - s * vq;
  vectors[q] = s * vp + c * vq;
}

}  // namespace

glm::dvec4 dominant_eigenvector(const glm::dmat4& symmetric) {
  glm::dmat4 a = symmetric;
  glm::dmat4 vectors(1.0);
  for (int sweep = 0; sweep < max_sweeps; ++sweep) {
    double off_diagonal = 0.0;
    for (int p = 0; p < 4; ++p) {
      for (int q = p + 1; q < 4; ++q) off_diagonal += std::abs(a[p][q]);
    }
    if (off_diagonal == 0.0) break;
    for (int p = 0; p < 4; ++p) {
      for (int q = p + 1; q < 4; ++q) rotate(a, vectors, p, q);
    }
  }
  int best = 3;
  for (int i = 2; i >= 0; --i) {
    if (a[i][i] > a[best][best]) best = i;
  }
  const glm::dvec4 v = vectors[best] / glm::length(vectors[best]);
  for (int i = 3; i >= 0; --i) {
    if (v[i] != 0.0) return v[i] < 0.0 ? -v : v;
  }
  return v;
}

}  // namespace nmc::motion
