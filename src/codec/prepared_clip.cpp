#include "codec/prepared_clip.h"

#include <algorithm>
#include <cmath>

#include "codec/contacts.h"
#include "codec/jumps.h"
#include "codec/set_steps.h"

namespace nmc::codec {
namespace {

/// Whether the last pose is the first one again, as motion::ErrorReport means it.
bool is_loop(const Rows& positions, Eigen::Index points, double size) {
  constexpr Eigen::Index fewest = 8;
  if (positions.cols() < fewest) return false;
  const Rows gap = (positions.rightCols(1) - positions.leftCols(1)).square();
  float most = 0;
  for (Eigen::Index q = 0; q < points; ++q) most = std::max(most, gap.middleRows(3 * q, 3).sum());
  for (Eigen::Index morph = 3 * points; morph < gap.rows(); ++morph) most = std::max(most, gap(morph, 0));
  return std::sqrt(static_cast<double>(most)) <= motion::loop_gap * size;
}

/// How many samples take turns in training: two where half of the samples tell where the others are, as at high rates.
Eigen::Index turns_of(const Rows& positions, Eigen::Index points, double tolerance) {
  constexpr Eigen::Index fewest = 500;
  constexpr double told = 0.5;  // of the tolerance, most often
  const Eigen::Index inner = positions.cols() - 2;
  if (positions.cols() < fewest) return 1;
  SampleRow largest = SampleRow::Zero(inner);
  for (Eigen::Index q = 0; q < points; ++q) {
    const auto point = positions.middleRows(3 * q, 3);
    const Rows bend = point.middleCols(1, inner) - 0.5f * (point.leftCols(inner) + point.rightCols(inner));
    largest = largest.max(bend.square().colwise().sum());
  }
  const auto middle = largest.begin() + inner / 2;
  std::nth_element(largest.begin(), middle, largest.end());
  return std::sqrt(static_cast<double>(*middle)) <= told * tolerance ? 2 : 1;
}

}  // namespace

PreparedClip prepare_clip(const SearchContext& context, std::size_t index, double contact_weight) {
  PreparedClip clip;
  const motion::Clip& motion = context.source.clips[index].clip;
  clip.layout = layout_clip(motion, context.frame);
  clip.steps = steps_for(context.set, clip.layout);
  clip.jumps = find_jumps(clip.layout, clip.steps);
  Eigen::MatrixXd coded = clip.layout.values;
  for (Eigen::Index i = 0; i < coded.rows(); ++i)
    if (!clip.layout.parameters[static_cast<std::size_t>(i)].moves)
      coded.row(i).setConstant(fixed_level(clip.layout, clip.steps, i) * clip.steps.anchor(i));
  const Points& points = points_of(context.source, context.bound);
  const auto positions = [&](const Eigen::MatrixXd& fixed) {
    return MotionMap(context.source.skeleton, context.frame, clip.layout, points, fixed).positions(clip.layout.values);
  };
  clip.wanted = positions(clip.layout.values);
  const Eigen::Index turns = turns_of(clip.wanted, static_cast<Eigen::Index>(points.size()), context.bound.tolerance);
  clip.offset = in_turns(positions(coded) - clip.wanted, turns);
  clip.coded = coded.col(0);
  clip.loops = is_loop(clip.wanted, static_cast<Eigen::Index>(points.size()), context.source.size);
  clip.emphasis =
      in_turns(contact_emphasis(clip.wanted, points.size(), motion.times, context.source.size, contact_weight), turns);
  return clip;
}

}  // namespace nmc::codec
