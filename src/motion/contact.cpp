#include "motion/contact.h"

#include <algorithm>

namespace nmc::motion {
namespace {

constexpr double still_sizes_per_second = 0.01;
constexpr double least_seconds = 0.1;

bool is_still(double distance, double seconds, double size) {
  return distance < still_sizes_per_second * size * seconds;
}

}  // namespace

std::vector<Span> contact_spans(std::span<const glm::dvec3> positions, std::span<const float> times, double size) {
  std::vector<Span> spans;
  const auto seconds = [&](std::size_t from, std::size_t to) {
    return static_cast<double>(times[to]) - static_cast<double>(times[from]);
  };
  for (std::size_t first = 0; first + 1 < positions.size();) {
    std::size_t last = first;
    while (last + 1 < positions.size() &&
           is_still(glm::distance(positions[last], positions[last + 1]), seconds(last, last + 1), size))
      ++last;
    if (last > first && seconds(first, last) >= least_seconds) spans.push_back({first, last});
    first = std::max(last, first + 1);
  }
  return spans;
}

void ContactDrift::add(double seconds, const glm::dvec3& position, const glm::dvec3& error, double size) {
  if (started_ && is_still(glm::distance(last_position_, position), seconds - last_seconds_, size)) {
    in_span_ = std::max(in_span_, glm::distance(error, start_error_));
    if (seconds - start_seconds_ >= least_seconds) largest_ = std::max(largest_, in_span_);
  } else {
    start_seconds_ = seconds;
    start_error_ = error;
    in_span_ = 0;
    started_ = true;
  }
  last_seconds_ = seconds;
  last_position_ = position;
}

}  // namespace nmc::motion
