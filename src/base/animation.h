// The vocabulary of glTF animation (glTF 2.0, section 3.11) that the reader, the motion code and the codec share. Plain
// data.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace nmc {

/// Which property of a node a channel moves (animation.channel.target.path).
enum class Path : std::uint8_t { translation = 0, rotation = 1, scale = 2, weights = 3 };

/// animation.sampler.interpolation.
enum class Interpolation : std::uint8_t { linear, step, cubic_spline };

/// One channel with its sampler's data.
struct Curve {
  int node = -1;  ///< index into the file's nodes
  Path path = Path::translation;
  Interpolation interpolation = Interpolation::linear;
  int width = 3;              ///< numbers per value: 3, 4 (quaternion x, y, z, w), or the morph target count
  std::vector<float> times;   ///< seconds, strictly increasing
  std::vector<float> values;  ///< times.size() * width; times 3 for cubic_spline (in-tangent, value, out-tangent)

  bool operator==(const Curve&) const = default;
};

/// One animation: curves in the order of the file's channels.
struct Animation {
  std::string name;
  std::vector<Curve> curves;
};

}  // namespace nmc
