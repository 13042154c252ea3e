#include "codec/bound.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "motion/point_search.h"

namespace nmc::codec {
namespace {

bool names_everything(const Selector& where) { return where.joint.empty() && !where.path; }

/// Where on the character a point is, as the rules see it.
struct Place {
  int node = -1;           ///< with the largest influence
  bool is_origin = false;  ///< the node's origin; else a place on its skin
};

Place place_of(const Points& points, std::size_t point) {
  const int leading = motion::leading_influence(points, point);
  if (leading < 0) return {};
  const Influence& influence = points.influences[static_cast<std::size_t>(leading)];
  const bool alone = points.first[point + 1] - points.first[point] == 1;
  return {influence.node, alone && influence.offset == std::array<double, 3>{}};
}

bool names_point(const Selector& where, const motion::Skeleton& skeleton, const Place& place) {
  if (place.node < 0) return false;
  const auto node = static_cast<std::size_t>(place.node);
  const auto named = [&](std::size_t n) { return where.joint.empty() || matches(where.joint, skeleton.names[n]); };
  if (!where.path) return named(node);
  if (*where.path == Path::weights) return false;
  const bool turns = *where.path != Path::translation;
  if (!place.is_origin) return turns && named(node);
  if (!turns) return named(node);
  const int parent = skeleton.parent[node];
  return parent >= 0 && named(static_cast<std::size_t>(parent));
}

bool names_morphs(const Selector& where, const motion::Skeleton& skeleton, int node) {
  return node >= 0 && selects_channel(where, skeleton.names[static_cast<std::size_t>(node)], Path::weights);
}

/// Scales each point whose tolerance is not the bound's.
class Scaler {
 public:
  Scaler(const BoundSource& source, std::span<const ToleranceRule> rules, Bound& bound)
      : source_(source), rules_(rules), bound_(bound) {}

  Points scaled(const Points& points) {
    Points result = points;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Place place = place_of(points, p);
      const double scale = scale_of([&](const Selector& where) { return names_point(where, source_.skeleton, place); });
      for (std::uint32_t i = points.first[p]; i < points.first[p + 1]; ++i) result.influences[i].weight *= scale;
    }
    for (MorphReach& morph : result.morphs)
      morph.reach *= scale_of([&](const Selector& where) { return names_morphs(where, source_.skeleton, morph.node); });
    return result;
  }

 private:
  template <typename Names>
  double scale_of(const Names& names) {
    double tolerance = bound_.tolerance;
    for (const ToleranceRule& rule : rules_)
      if (names_everything(rule.where) || names(rule.where)) tolerance = in_world_units(rule.tolerance, source_.size);
    bound_.finest = std::min(bound_.finest, tolerance);
    return bound_.tolerance / tolerance;
  }

  const BoundSource& source_;
  std::span<const ToleranceRule> rules_;
  Bound& bound_;
};

Bound make_bound(const BoundSource& source, std::span<const ToleranceRule> rules) {
  Bound bound;
  bound.tolerance = source.tolerance;
  bool exceptions = false;
  for (const ToleranceRule& rule : rules) {
    if (names_everything(rule.where))
      bound.tolerance = in_world_units(rule.tolerance, source.size);
    else
      exceptions = true;
  }
  bound.finest = bound.tolerance;
  if (!exceptions) return bound;
  Scaler scaler(source, rules, bound);
  bound.points = scaler.scaled(source.points);
  bound.all_points = scaler.scaled(source.all_points);
  return bound;
}

}  // namespace

double in_world_units(const Tolerance& tolerance, double size) {
  return tolerance.unit == Tolerance::Unit::fraction_of_size ? tolerance.value * size : tolerance.value;
}

std::size_t BoundTable::of(const std::string& clip) {
  std::vector<std::size_t> numbers;
  std::vector<ToleranceRule> selected;
  for (std::size_t r = 0; r < rules_.size(); ++r) {
    if (!selects_clip(rules_[r].where, clip)) continue;
    numbers.push_back(r);
    selected.push_back(rules_[r]);
  }
  const auto [found, is_new] = made_.try_emplace(std::move(numbers), bounds_.size());
  if (is_new) bounds_.push_back(make_bound(source_, selected));
  return found->second;
}

}  // namespace nmc::codec
