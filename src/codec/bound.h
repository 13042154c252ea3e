// The error bound of a clip, with the exceptions that rules make for some of its points.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/points.h"
#include "codec/rules.h"
#include "motion/skeleton.h"

namespace nmc::codec {

/// A point with a tolerance of its own has its influences scaled by `tolerance` over that: positions are linear in
/// them, so that its scaled error is compared with the same `tolerance` as everyone's.
struct Bound {
  double tolerance = 0;              ///< world units; of the points that no rule names
  double finest = 0;                 ///< world units; the smallest of any point
  std::optional<Points> points;      ///< scaled; none: no point has a tolerance of its own
  std::optional<Points> all_points;  ///< the same of every vertex
};

/// What the bounds of a file are made from; all of it outlives the call.
struct BoundSource {
  const motion::Skeleton& skeleton;
  const Points& points;
  const Points& all_points;
  double size = 1;       ///< world units
  double tolerance = 0;  ///< world units
};

/// The bound of clips that these rules select; the last that names a point counts.
Bound make_bound(const BoundSource& source, std::span<const ToleranceRule> rules);

/// The rules that select a clip.
std::vector<ToleranceRule> rules_for(std::span<const ToleranceRule> rules, const std::string& clip);

/// In world units, for a character of this size.
double in_world_units(const Tolerance& tolerance, double size);

}  // namespace nmc::codec
