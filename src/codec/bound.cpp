#include "codec/bound.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nmc::codec {
namespace {

bool names_everything(const Selector& where) { return where.joint.empty() && !where.path; }

/// Where on the character a point is, as the rules see it.
struct Place {
  int node = -1;           ///< with the largest influence
  bool is_origin = false;  ///< the node's origin; else a place on its skin
};

Place place_of(std::span<const Influence> influences) {
  const auto leading =
      std::max_element(influences.begin(), influences.end(),
                       [](const Influence& a, const Influence& b) { return std::abs(a.weight) < std::abs(b.weight); });
  const bool origin = influences.size() == 1 && leading->offset == std::array<double, 3>{};
  return {leading->node, origin};
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
      const std::span<Influence> influences(result.influences.data() + points.first[p],
                                            points.first[p + 1] - points.first[p]);
      if (influences.empty()) continue;
      const Place place = place_of(influences);
      const double scale = scale_of([&](const Selector& where) { return names_point(where, source_.skeleton, place); });
      if (scale == 1) continue;
      for (Influence& influence : influences) influence.weight *= scale;
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

}  // namespace

double in_world_units(const Tolerance& tolerance, double size) {
  return tolerance.unit == Tolerance::Unit::fraction_of_size ? tolerance.value * size : tolerance.value;
}

std::vector<ToleranceRule> rules_for(std::span<const ToleranceRule> rules, const std::string& clip) {
  std::vector<ToleranceRule> selected;
  for (const ToleranceRule& rule : rules)
    if (selects_clip(rule.where, clip)) selected.push_back(rule);
  return selected;
}

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

}  // namespace nmc::codec
