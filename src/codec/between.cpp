#include "codec/between.h"

#include <algorithm>
#include <array>
#include <vector>

#include "codec/atoms.h"

namespace nmc::codec {
namespace {

/// The largest error at a time between two samples, whose values are given (all parameters x 2), and at these two.
double error_around(const BetweenInput& input, Eigen::Index n, double seconds, const Eigen::MatrixXd& pair) {
  const std::vector<float>& times = input.clip.clip.times;
  const auto at = static_cast<std::size_t>(n);
  const motion::Clip two{input.clip.clip.name, {times[at - 1], times[at]}, {}};
  const Animation made = with_kept(input.clip, clip_of_parameters(two, input.frame, input.layout, pair));
  const std::array<double, 3> looked_at{two.times[0], seconds, two.times[1]};
  return input.meter.error_at(input.clip.original, made, looked_at);
}

/// Steps of single parameters at samples n - 1 and n, of the rotations that turn far between them.
std::vector<std::vector<LevelAtom>> steps_of_turns(const ClipLayout& layout, Eigen::Index n) {
  constexpr double far = 0.5;  // of a quaternion's numbers or of a rotation vector
  std::vector<std::vector<LevelAtom>> steps;
  for (const LayoutBlock& block : layout.blocks) {
    if (block.first_moving < 0) continue;
    const auto turn = layout.values.middleRows(block.block.first, block.block.width);
    if ((turn.col(n) - turn.col(n - 1)).norm() < far) continue;
    for (const Eigen::Index sample : {n - 1, n})
      for (int i = 0; i < block.block.width; ++i)
        for (const std::int32_t level : {1, -1, 2, -2, 4, -4, 8, -8, 16, -16, 32, -32})
          steps.push_back({{static_cast<std::uint32_t>(sample), block.block.first + i, 0, level}});
  }
  return steps;
}

}  // namespace

bool mend_between(const BetweenInput& input, Eigen::Index n, double seconds, double bound, Mending mending,
                  Eigen::MatrixXd& values, std::vector<LevelAtom>& atoms) {
  const auto first = n - 1;
  const auto add = [&](const std::vector<LevelAtom>& added, Eigen::Ref<Eigen::MatrixXd> pair) {
    for (const LevelAtom& atom : added)
      pair(atom.parameter, static_cast<Eigen::Index>(atom.sample) - first) +=
          atom.level * input.steps.anchor(atom.parameter);
  };
  const auto excess = [&](const std::vector<LevelAtom>& added) {
    Eigen::MatrixXd pair = values.middleCols(first, 2);
    add(added, pair);
    return std::max(0.0, error_around(input, n, seconds, pair) - bound);
  };
  const auto put = [&](const std::vector<LevelAtom>& added) {
    for (const LevelAtom& atom : added) put_atom(atom, atoms);
    add(added, values.middleCols(first, 2));
  };
  const auto tip = [&] {
    const std::optional<std::vector<LevelAtom>> steps = few_atoms(steps_of_turns(input.layout, n), excess);
    if (steps) put(*steps);
    return steps.has_value();
  };
  // Most often a turn of about half a circle goes the other way, and little tips it back.
  if (mending == Mending::tips && tip()) return true;
  put(needed_atoms(missing_by_target(input.layout, input.steps, first, 2, values), excess));
  // Within rounding of half a turn even the true values, rounded, may go the other way.
  return excess({}) <= 0 || tip();
}

}  // namespace nmc::codec
