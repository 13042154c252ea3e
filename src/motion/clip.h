// A clip: the curves of one animation on one common time grid, ready for the codec, and back.
#pragma once

#include <string>
#include <vector>

#include "base/animation.h"

namespace nmc::motion {

/// One node property over the clip's times: times.size() rows of `width` numbers, or a single row when it never changes.
/// Between samples a track means what glTF's LINEAR means. Rotations are unit quaternions x, y, z, w, sign-continuous from row to row.
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

/// The common times of some curves: the union of their key times (keys closer than a microsecond are one), which for the usual exported
/// file is the uniform grid of its frame rate. Key times come back bit for bit. When curves with smooth (cubic) or incommensurable keys make the
/// union useless, each interval between keys is divided into `subdivisions` equal parts.
std::vector<float> common_times(const std::vector<Curve>& curves, int subdivisions = 1);

/// Samples the curves at `times`. A curve whose value never changes becomes a constant track.
Clip sample_clip(const std::string& name, const std::vector<Curve>& curves, const std::vector<float>& times);

/// A clip as LINEAR curves; constant tracks get two keys (start and end; one if the clip has one time).
Animation to_animation(const Clip& clip);

}  // namespace nmc::motion
