// A clip: the curves of one animation on one common time grid, ready for the codec, and back.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/animation.h"

namespace nmc::motion {

/// One node property over the clip's times: times.size() rows of `width` numbers, or a single row when it never
/// changes. Between samples a track means what glTF's LINEAR means. Rotations are unit quaternions x, y, z, w,
/// sign-continuous from row to row.
struct Track {
  int node = -1;
  Path path = Path::translation;
  int width = 3;
  std::vector<float> values;

  bool constant() const { return values.size() == static_cast<std::size_t>(width); }
};

struct Clip {
  std::string name;
  std::vector<float> times;  ///< seconds, strictly increasing
  std::vector<Track> tracks;
};

/// The common times of some curves: the union of their key times, which for the usual exported file is the uniform grid
/// of its frame rate. Keys of different curves closer than a microsecond are one (two such keys of one curve are a jump
/// and stay two); the bits that most curves have are kept, those of the earliest curve in a tie. Key times come back
/// bit for bit. The union loses nothing of LINEAR curves; where it is much larger than the largest curve, the curves
/// are incommensurable and the caller may prefer to leave them alone. Each interval between keys is then divided into
/// `subdivisions` equal parts (1 to 64), for the sake of smooth (cubic) curves.
std::vector<float> common_times(const std::vector<Curve>& curves, int subdivisions = 1);

/// The smallest power of two (64 at most) of subdivisions of common_times with which straight interpolation between
/// samples follows every CUBICSPLINE curve: rotations within max_angle_radians, translations within max_distance,
/// scales and weights (which have no unit, like a rotation) within max_angle_radians. Compared at the quarters between
/// samples. 1 without such curves.
int needed_subdivisions(const std::vector<Curve>& curves, double max_angle_radians, double max_distance);

/// The rate at which times are sampled: one over the mean of the spacings within a tenth of their median; 0 with fewer
/// than two times.
double sample_rate_hz(const std::vector<float>& times);

/// Samples the curves at `times`. A track is constant when all its rows are equal (rotations: up to sign), and only
/// then. Throws Error (internal) for a STEP curve that changes: a clip cannot hold a jump.
Clip sample_clip(const std::string& name, const std::vector<Curve>& curves, const std::vector<float>& times);

/// A clip as LINEAR curves; constant tracks get two keys (start and end; one if the clip has one time, none if
/// it has none).
Animation to_animation(const Clip& clip);

}  // namespace nmc::motion
