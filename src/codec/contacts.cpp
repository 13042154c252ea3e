#include "codec/contacts.h"

#include "motion/contact.h"

namespace nmc::codec {

Rows contact_emphasis(const Rows& positions, std::size_t points, const std::vector<float>& times, double size,
                      double weight) {
  const auto count = static_cast<Eigen::Index>(points);
  Rows emphasis = Rows::Ones(count + positions.rows() - 3 * count, positions.cols());
  if (weight == 1) return emphasis;
  std::vector<glm::dvec3> path(times.size());
  for (Eigen::Index q = 0; q < count; ++q) {
    for (Eigen::Index n = 0; n < positions.cols(); ++n)
      path[static_cast<std::size_t>(n)] = {positions(3 * q, n), positions(3 * q + 1, n), positions(3 * q + 2, n)};
    for (const motion::Span& span : motion::contact_spans(path, times, size))
      emphasis.row(q)
          .segment(static_cast<Eigen::Index>(span.first), static_cast<Eigen::Index>(span.last - span.first + 1))
          .setConstant(static_cast<float>(weight));
  }
  return emphasis;
}

}  // namespace nmc::codec
