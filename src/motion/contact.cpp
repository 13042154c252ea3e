#include "motion/contact.h"

namespace nmc::motion {
namespace {

constexpr double still_sizes_per_second = 0.01;
constexpr double least_seconds = 0.1;

}  // namespace

std::vector<Span> contact_spans(std::span<const glm::dvec3> positions, std::span<const float> times, double size) {
  std::vector<Span> spans;
  const auto seconds = [&](std::size_t from, std::size_t to) {
    return static_cast<double>(times[to]) - static_cast<double>(times[from]);
  };
  const auto is_still = [&](std::size_t n) {
    return glm::distance(positions[n], positions[n + 1]) < still_sizes_per_second * size * seconds(n, n + 1);
  };
  for (std::size_t first = 0; first + 1 < positions.size();) {
    std::size_t last = first;
    while (last + 1 < positions.size() && is_still(last)) ++last;
    if (last > first && seconds(first, last) >= least_seconds) spans.push_back({first, last});
    first = last > first ? last : first + 1;
  }
  return spans;
}

}  // namespace nmc::motion
