// When a point of a character stands still.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace nmc::motion {

/// Samples first ... last, both included.
struct Span {
  std::size_t first = 0;
  std::size_t last = 0;
};

/// The longest spans of samples in which a point moves by less than 1 % of `size` per second from each sample to the
/// next and that last 0.1 s or longer. `positions` in world units, one per time; `times` in seconds, increasing.
std::vector<Span> contact_spans(std::span<const glm::dvec3> positions, std::span<const float> times, double size);

}  // namespace nmc::motion
