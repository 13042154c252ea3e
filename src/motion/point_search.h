// Where on a character the difference of two poses is largest, without looking at every point.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "base/points.h"

namespace nmc::motion {

/// The largest error found so far. What is not a number counts as infinite, so that no comparison with a tolerance
/// passes it.
struct WorstPoint {
  double error = 0.0;
  int point = -1;           ///< index into the Points; -1 while no point has an error
  std::size_t cluster = 0;  ///< where to look first: the worst place moves slowly
};

/// Points in small clusters of neighbours, and these in larger ones, each with spheres around its offsets that bound
/// how far any of its points can be moved.
class PointSearch {
 public:
  explicit PointSearch(const Points& points);

  /// Raises `worst` to the largest error of any point. difference[node] is the world matrix of one pose minus that of
  /// the other. The result is that of looking at all points.
  void raise(std::span<const glm::dmat4> difference, WorstPoint& worst) const;

 private:
  struct Influence4 {
    int node = -1;
    glm::dvec4 offset{0.0};  ///< weight * (offset, 1)
  };
  struct Sphere {
    int node = -1;
    double weight = 0.0;  ///< largest of a point of the cluster, absolute
    glm::dvec4 center{0.0};
    double radius = 0.0;
  };
  /// Those within a larger one follow it.
  struct Cluster {
    std::size_t first_point = 0, last_point = 0;    ///< into index_ and first_
    std::size_t first_sphere = 0, last_sphere = 0;  ///< into spheres_
    double weight = 0.0;                            ///< largest sum of absolute weights of a point
    std::size_t next = 0;                           ///< the first cluster after this one and those within it
  };

  void split(const Points& points, const std::vector<int>& leading, std::size_t first, std::size_t last, int depth);
  /// Orders points of index_ along their longest side as far as that halves them; returns where the second half begins.
  std::size_t halve(const Points& points, const std::vector<int>& leading, std::size_t first, std::size_t last);
  void add_cluster(const Points& points, std::size_t first, std::size_t last);
  /// `norms`: of the difference's linear parts.
  double bound(const Cluster& cluster, std::span<const glm::dmat4> difference, std::span<const double> norms) const;
  void raise_in(std::size_t cluster, std::span<const glm::dmat4> difference, WorstPoint& worst) const;

  std::vector<int> index_;          ///< points in the order of the clusters
  std::vector<std::size_t> first_;  ///< of their influences
  std::vector<Influence4> influences_;
  std::vector<Sphere> spheres_;
  std::vector<Cluster> clusters_;
};

/// The first of a point's influences with the largest weight (absolute), as an index into points.influences; -1 where
/// it has none.
int leading_influence(const Points& points, std::size_t point);

/// The error vector of one point.
glm::dvec3 point_error(const Points& points, std::size_t point, std::span<const glm::dmat4> difference);

/// `value`, or infinity where it is not a number.
double number_or_infinity(double value);

}  // namespace nmc::motion
