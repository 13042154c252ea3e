// When a point of a character stands still, and how far a decoded animation lets it slide meanwhile.
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

/// The drift of one point: the largest change of its error vector since the beginning of the span (as contact_spans
/// finds them) in which the original stands still. Fed with key after key.
class ContactDrift {
 public:
  /// `position`: of the original; `error`: decoded minus original; world units. Seconds increase.
  void add(double seconds, const glm::dvec3& position, const glm::dvec3& error, double size);

  /// World units; 0 where the point never stood still.
  double largest() const { return largest_; }

 private:
  bool started_ = false;
  double start_seconds_ = 0, last_seconds_ = 0;
  glm::dvec3 last_position_{0.0}, start_error_{0.0};
  double in_span_ = 0;
  double largest_ = 0;
};

}  // namespace nmc::motion
