// The error that users see: how far a decoded animation moves the points of a character from where they should be
// (DESIGN: error).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/animation.h"
#include "base/points.h"
#include "motion/point_search.h"
#include "motion/skeleton.h"

namespace nmc::motion {

/// The character's size: the largest side of the box of the skin joints in the rest pose; without skins of the points
/// at rest; 1 when that is 0.
double character_size(const Skeleton& skeleton, const Points& points);

/// An animation is a loop where, at its last key, no point is farther than this from its place at the first key, as a
/// share of the size: real loops often close only nearly.
inline constexpr double loop_gap = 0.01;

/// Distances in world units, over all sampled times: the key times of the original and the midpoints between them.
/// What is not a number, in either animation, makes the measures that see it infinite: no comparison with a tolerance
/// passes it. `mean`, `percentile_99` and `jitter` are over at most 300 points picked evenly from all (fewer, 16 at
/// least, in clips of more than 26,000 samples); the maxima and `loop_seam` are over all points.
struct ErrorReport {
  double max = 0;  ///< over all points, and over the morph errors of the nodes (below)
  double mean = 0;
  double percentile_99 = 0;         ///< nearest rank
  double max_joint = 0;             ///< the same maximum over skin joints' origins alone (the paper's measure)
  double max_rotation_degrees = 0;  ///< largest angle between local rotations of nodes that have a rotation curve
  double max_morph_weight = 0;      ///< largest difference of a morph weight
  double jitter = 0;                ///< root mean square of the second difference over key times of the error vector
  std::optional<double> loop_seam;  ///< largest change of the error vector between last and first key time; empty where
                                    ///< the original is no loop (loop_gap): nobody sees these poses one after the other
  double contact_drift = 0;         ///< largest ContactDrift of a skin joint's origin, over key times
  double max_seconds = 0;           ///< when the maximum occurs
  int max_node =
      -1;  ///< the node with the largest influence on the worst point, or whose morphs are worst; -1 without an error
};

/// The largest error at each sampled time, in increasing order: key, midpoint, key, ..., key.
struct ErrorProfile {
  std::vector<double> seconds;
  std::vector<double> max_error;  ///< as ErrorReport.max at that time
  std::vector<int> worst_point;   ///< index into the points; -1 where nothing differs or a morph error is the largest
};

/// Compares animations of one character. Prepares the points once; to be kept for many comparisons. Several threads may
/// use one.
///
/// The error of a point is the length of the difference of its two positions. The morph error of a node is the sum over
/// its MorphReach entries of |difference of weight| * reach, times the largest axis scale of the node's world matrix in
/// the original: an upper bound, counted as one more point. Curves are matched by node and path; a missing curve means
/// the rest value.
class ErrorMeter {
 public:
  /// Skeleton and points must outlive it.
  ErrorMeter(const Skeleton& skeleton, const Points& points);

  ErrorReport report(const Animation& original, const Animation& decoded) const;
  /// As ErrorReport.max at these times, or at one time, in seconds.
  double error_at(const Animation& original, const Animation& decoded, std::span<const double> seconds) const;
  double error_at(const Animation& original, const Animation& decoded, double seconds) const {
    return error_at(original, decoded, std::span(&seconds, 1));
  }
  ErrorProfile profile(const Animation& original, const Animation& decoded, int threads = 1) const;
  /// Measures a profile's stale times (one flag per time) anew, after `decoded` has changed there.
  void renew(ErrorProfile& profile, const std::vector<bool>& stale, const Animation& original, const Animation& decoded,
             int threads = 1) const;

 private:
  /// Whether the pose at the last key is the first one again (loop_gap).
  bool is_loop(const Animation& animation, double first_seconds, double last_seconds) const;

  const Skeleton* skeleton_;
  const Points* points_;
  PointSearch search_;
  double size_ = 1;
};

/// Compares two animations of one character at all key times of `original` and the midpoints between them. Curves are
/// matched by node and path; a missing curve means the rest value.
ErrorReport measure_error(const Skeleton& skeleton, const Points& points, const Animation& original,
                          const Animation& decoded);

/// The largest error over time of the same comparison.
ErrorProfile error_profile(const Skeleton& skeleton, const Points& points, const Animation& original,
                           const Animation& decoded);

}  // namespace nmc::motion
