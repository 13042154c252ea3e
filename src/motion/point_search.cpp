// Clusters of points with bounding spheres; the bound of a cluster is the largest |D (c, 1)| + ||D|| r over its
// influences.
#include "motion/point_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "motion/index.h"

namespace nmc::motion {
namespace {

constexpr std::size_t cluster_points = 24;

/// Halvings from a cluster of clusters to the next smaller ones.
constexpr int halvings = 3;

/// Covers the rounding of the bound itself.
constexpr double bound_slack = 1.0 + 1e-9;

constexpr double infinity = std::numeric_limits<double>::infinity();

glm::dvec3 offset_of(const Influence& influence) {
  return {influence.offset[0], influence.offset[1], influence.offset[2]};
}

std::vector<int> leading_influences(const Points& points) {
  std::vector<int> leading;
  for (std::size_t p = 0; p < points.size(); ++p) leading.push_back(leading_influence(points, p));
  return leading;
}

/// `sum` plus difference * offset, four lanes wide.
inline void accumulate(glm::dvec4& sum, const glm::dmat4& difference, const glm::dvec4& offset) {
  sum += difference[0] * offset[0] + difference[1] * offset[1] + difference[2] * offset[2] + difference[3] * offset[3];
}

double squared(const glm::dvec4& v) { return v.x * v.x + v.y * v.y + v.z * v.z; }

}  // namespace

double number_or_infinity(double value) { return std::isnan(value) ? infinity : value; }

int leading_influence(const Points& points, std::size_t point) {
  int best = -1;
  for (std::uint32_t i = points.first[point]; i < points.first[point + 1]; ++i)
    if (best < 0 || std::abs(points.influences[i].weight) > std::abs(points.influences[at(best)].weight))
      best = static_cast<int>(i);
  return best;
}

glm::dvec3 point_error(const Points& points, std::size_t point, std::span<const glm::dmat4> difference) {
  glm::dvec4 sum(0.0);
  for (std::uint32_t i = points.first[point]; i < points.first[point + 1]; ++i) {
    const Influence& influence = points.influences[i];
    accumulate(sum, difference[at(influence.node)], influence.weight * glm::dvec4(offset_of(influence), 1.0));
  }
  return glm::dvec3(sum);
}

PointSearch::PointSearch(const Points& points) {
  const std::vector<int> leading = leading_influences(points);
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (leading[p] >= 0) index_.push_back(static_cast<int>(p));
  }
  const auto leading_node = [&](int p) { return points.influences[at(leading[at(p)])].node; };
  std::stable_sort(index_.begin(), index_.end(), [&](int a, int b) { return leading_node(a) < leading_node(b); });
  for (std::size_t first = 0, last = 0; first < index_.size(); first = last) {
    while (last < index_.size() && leading_node(index_[last]) == leading_node(index_[first])) ++last;
    split(points, leading, first, last, 0);
  }
  for (const int p : index_) {
    first_.push_back(influences_.size());
    for (std::uint32_t i = points.first[at(p)]; i < points.first[at(p) + 1]; ++i) {
      const Influence& influence = points.influences[i];
      influences_.push_back({influence.node, influence.weight * glm::dvec4(offset_of(influence), 1.0)});
    }
  }
  first_.push_back(influences_.size());
}

void PointSearch::split(const Points& points, const std::vector<int>& leading, std::size_t first, std::size_t last,
                        int depth) {
  const bool is_leaf = last - first <= cluster_points;
  const bool is_cluster = is_leaf || depth % halvings == 0;
  const std::size_t cluster = clusters_.size();
  if (is_cluster) add_cluster(points, first, last);
  if (!is_leaf) {
    const std::size_t middle = halve(points, leading, first, last);
    split(points, leading, first, middle, depth + 1);
    split(points, leading, middle, last, depth + 1);
  }
  if (is_cluster) clusters_[cluster].next = clusters_.size();
}

std::size_t PointSearch::halve(const Points& points, const std::vector<int>& leading, std::size_t first,
                               std::size_t last) {
  const auto offset = [&](int p) { return offset_of(points.influences[at(leading[at(p)])]); };
  glm::dvec3 low = offset(index_[first]), high = low;
  for (std::size_t i = first; i < last; ++i) {
    low = glm::min(low, offset(index_[i]));
    high = glm::max(high, offset(index_[i]));
  }
  const glm::dvec3 side = high - low;
  const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
  const auto place = [&](std::size_t i) { return index_.begin() + static_cast<std::ptrdiff_t>(i); };
  // What is not a number would break the ordering.
  const auto key = [&](int p) {
    const double x = offset(p)[axis];
    return std::pair(std::isnan(x) ? -infinity : x, p);
  };
  const std::size_t middle = first + (last - first) / 2;
  std::nth_element(place(first), place(middle), place(last), [&](int a, int b) { return key(a) < key(b); });
  return middle;
}

void PointSearch::add_cluster(const Points& points, std::size_t first, std::size_t last) {
  struct Extent {
    glm::dvec3 low{infinity}, high{-infinity};
    double weight = 0.0, radius = 0.0;
    glm::dvec3 center() const { return 0.5 * (low + high); }
  };
  std::map<int, Extent> extents;
  Cluster cluster{first, last, spheres_.size(), spheres_.size(), 0.0, 0};
  const auto for_each_influence = [&](const auto& visit) {
    for (std::size_t i = first; i < last; ++i) {
      for (std::uint32_t k = points.first[at(index_[i])]; k < points.first[at(index_[i]) + 1]; ++k)
        visit(points.influences[k]);
    }
  };
  for_each_influence([&](const Influence& influence) {
    Extent& extent = extents[influence.node];
    extent.low = glm::min(extent.low, offset_of(influence));
    extent.high = glm::max(extent.high, offset_of(influence));
    extent.weight = std::max(extent.weight, number_or_infinity(std::abs(influence.weight)));
  });
  for_each_influence([&](const Influence& influence) {
    Extent& extent = extents[influence.node];
    extent.radius = std::max(extent.radius, number_or_infinity(glm::length(offset_of(influence) - extent.center())));
  });
  for (std::size_t i = first; i < last; ++i) {
    double sum = 0.0;
    for (std::uint32_t k = points.first[at(index_[i])]; k < points.first[at(index_[i]) + 1]; ++k) {
      sum += std::abs(points.influences[k].weight);
    }
    cluster.weight = std::max(cluster.weight, number_or_infinity(sum));
  }
  for (const auto& [node, extent] : extents) {
    spheres_.push_back({node, extent.weight, glm::dvec4(extent.center(), 1.0), extent.radius});
  }
  cluster.last_sphere = spheres_.size();
  clusters_.push_back(cluster);
}

double PointSearch::bound(const Cluster& cluster, std::span<const glm::dmat4> difference,
                          std::span<const double> norms) const {
  double sum = 0.0, largest = 0.0;
  for (std::size_t i = cluster.first_sphere; i < cluster.last_sphere; ++i) {
    const Sphere& sphere = spheres_[i];
    glm::dvec4 moved(0.0);
    accumulate(moved, difference[at(sphere.node)], sphere.center);
    const double reach = std::sqrt(squared(moved)) + norms[at(sphere.node)] * sphere.radius;
    sum += sphere.weight * reach;
    largest = std::max(largest, reach);
  }
  if (!std::isfinite(sum)) return infinity;
  return std::min(sum, cluster.weight * largest) * bound_slack;
}

void PointSearch::raise_in(std::size_t c, std::span<const glm::dmat4> difference, WorstPoint& worst) const {
  const Cluster& cluster = clusters_[c];
  for (std::size_t p = cluster.first_point; p < cluster.last_point; ++p) {
    glm::dvec4 sum(0.0);
    for (std::size_t i = first_[p]; i < first_[p + 1]; ++i) {
      accumulate(sum, difference[at(influences_[i].node)], influences_[i].offset);
    }
    const double error = number_or_infinity(std::sqrt(squared(sum)));
    if (error > worst.error) worst = {error, index_[p], c};
  }
}

void PointSearch::raise(std::span<const glm::dmat4> difference, WorstPoint& worst) const {
  const std::size_t start = worst.cluster;
  std::vector<double> norms(difference.size());
  std::transform(difference.begin(), difference.end(), norms.begin(),
                 [](const glm::dmat4& d) { return std::sqrt(squared(d[0]) + squared(d[1]) + squared(d[2])); });
  const auto is_leaf = [&](std::size_t c) { return clusters_[c].next == c + 1; };
  const auto may_raise = [&](std::size_t c) { return bound(clusters_[c], difference, norms) > worst.error; };
  const bool has_start = start < clusters_.size() && is_leaf(start);
  if (has_start && may_raise(start)) raise_in(start, difference, worst);
  for (std::size_t c = 0; c < clusters_.size();) {
    if (!may_raise(c)) {
      c = clusters_[c].next;
      continue;
    }
    if (is_leaf(c) && !(has_start && c == start)) raise_in(c, difference, worst);
    ++c;
  }
}

}  // namespace nmc::motion
