// The error bound of a clip, with the exceptions that rules make for some of its points.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
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

/// What the bounds of a file are made from; all of it outlives them.
struct BoundSource {
  const motion::Skeleton& skeleton;
  const Points& points;
  const Points& all_points;
  double size = 1;       ///< world units
  double tolerance = 0;  ///< world units
};

/// The bounds of a file's clips; clips that the same rules select share one. Of several rules that name a point the
/// last one counts.
class BoundTable {
 public:
  /// `rules` and what `source` refers to must outlive it.
  BoundTable(const BoundSource& source, std::span<const ToleranceRule> rules) : source_(source), rules_(rules) {}

  /// The index of a clip's bound.
  std::size_t of(const std::string& clip);

  const std::vector<Bound>& bounds() const { return bounds_; }
  std::vector<Bound> take() { return std::move(bounds_); }

 private:
  BoundSource source_;
  std::span<const ToleranceRule> rules_;
  std::vector<Bound> bounds_;
  std::map<std::vector<std::size_t>, std::size_t> made_;  ///< by the rules that select the clip
};

/// In world units, for a character of this size.
double in_world_units(const Tolerance& tolerance, double size);

}  // namespace nmc::codec
