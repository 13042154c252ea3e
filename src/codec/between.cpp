#include "codec/between.h"

#include <algorithm>
#include <array>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "codec/atoms.h"
#include "motion/pose_parameters.h"

namespace nmc::codec {
namespace {

/// What atoms at samples n - 1 and n add to the values there (all parameters x 2).
void add_atoms(const BetweenInput& input, Eigen::Index n, const std::vector<LevelAtom>& atoms,
               Eigen::Ref<Eigen::MatrixXd> pair) {
  for (const LevelAtom& atom : atoms)
    pair(atom.parameter, static_cast<Eigen::Index>(atom.sample) - n + 1) +=
        atom.level * input.steps.anchor(atom.parameter);
}

/// The largest error at a time between two samples, whose values are given (all parameters x 2), and at these two.
double error_around(const BetweenInput& input, Eigen::Index n, double seconds, const Eigen::MatrixXd& pair) {
  const std::vector<float>& times = input.clip.clip.times;
  const auto at = static_cast<std::size_t>(n);
  const motion::Clip two{input.clip.clip.name, {times[at - 1], times[at]}, {}};
  const Animation made = with_kept(input.clip, clip_of_parameters(two, input.frame, input.layout, pair));
  const std::array<double, 3> looked_at{two.times[0], seconds, two.times[1]};
  return input.meter.error_at(input.clip.original, made, looked_at);
}

/// The rotations of a block in a pair of samples (all parameters x 2), with signs that make their arc the short one.
std::array<glm::dquat, 2> rotations(const LayoutBlock& block, const Eigen::MatrixXd& pair) {
  std::vector<double> rows;
  for (Eigen::Index n = 0; n < 2; ++n)
    for (int a = 0; a < block.block.width; ++a) rows.push_back(pair(block.block.first + a, n));
  const std::vector<float> q = motion::from_parameters(rows, block.block, Path::rotation);
  return {glm::dquat(q[3], q[0], q[1], q[2]), glm::dquat(q[7], q[4], q[5], q[6])};
}

/// Whether the short arc between two rotations goes the other way round than that between the true ones, which are
/// close to them: just one of the ends has the true one's sign.
bool goes_other_way(const LayoutBlock& block, const Eigen::MatrixXd& pair, const Eigen::MatrixXd& true_pair) {
  const std::array<glm::dquat, 2> made = rotations(block, pair), meant = rotations(block, true_pair);
  return glm::dot(made[0], meant[0]) * glm::dot(made[1], meant[1]) < 0;
}

bool is_moving_rotation(const BetweenInput& input, const LayoutBlock& block) {
  return block.first_moving >= 0 && input.frame.targets[block.target].path == Path::rotation;
}

/// Single steps of a block's parameters at samples n - 1 and n, the smallest first.
std::vector<LevelAtom> steps_of(const LayoutBlock& block, Eigen::Index n) {
  std::vector<LevelAtom> steps;
  for (std::int32_t size = 1; size <= 32; size *= 2)
    for (const Eigen::Index sample : {n - 1, n})
      for (int i = 0; i < block.block.width; ++i)
        for (const std::int32_t level : {size, -size})
          steps.push_back({static_cast<std::uint32_t>(sample), block.block.first + i, 0, level});
  return steps;
}

/// What may tip back the rotations that go the other way in a pair (all parameters x 2).
struct Tips {
  std::vector<LevelAtom> smallest;            ///< per rotation a step that turns it round, where there is one
  std::vector<std::vector<LevelAtom>> steps;  ///< single ones
};

Tips tips_of(const BetweenInput& input, Eigen::Index n, const Eigen::MatrixXd& pair) {
  const Eigen::MatrixXd true_pair = input.layout.values.middleCols(n - 1, 2);
  Tips tips;
  for (const LayoutBlock& block : input.layout.blocks) {
    if (!is_moving_rotation(input, block) || !goes_other_way(block, pair, true_pair)) continue;
    const std::vector<LevelAtom> steps = steps_of(block, n);
    const auto turns_round = [&](const LevelAtom& step) {
      Eigen::MatrixXd with = pair;
      add_atoms(input, n, {step}, with);
      return !goes_other_way(block, with, true_pair);
    };
    const auto smallest = std::find_if(steps.begin(), steps.end(), turns_round);
    if (smallest != steps.end()) tips.smallest.push_back(*smallest);
    for (const LevelAtom& step : steps) tips.steps.push_back({step});
  }
  return tips;
}

/// How far a rotation, a share of the way between the samples of a pair (all parameters x 2), is from the true one.
double error_between(const LayoutBlock& block, double share, const Eigen::MatrixXd& pair,
                     const Eigen::MatrixXd& true_pair) {
  const std::array<glm::dquat, 2> made = rotations(block, pair), meant = rotations(block, true_pair);
  return 1 - std::abs(glm::dot(glm::slerp(made[0], made[1], share), glm::slerp(meant[0], meant[1], share)));
}

/// What each target lacks at samples n - 1 and n; first the rotations that are furthest off at a time between them.
std::vector<std::vector<LevelAtom>> missing_worst_first(const BetweenInput& input, Eigen::Index n, double seconds,
                                                        const Eigen::MatrixXd& values) {
  const std::vector<float>& times = input.clip.clip.times;
  const auto at = static_cast<std::size_t>(n);
  const double share = (seconds - times[at - 1]) / (times[at] - times[at - 1]);
  const Eigen::MatrixXd pair = values.middleCols(n - 1, 2), true_pair = input.layout.values.middleCols(n - 1, 2);
  std::vector<double> errors(input.layout.parameters.size());
  for (const LayoutBlock& block : input.layout.blocks)
    if (is_moving_rotation(input, block))
      std::fill_n(errors.begin() + block.block.first, block.block.width, error_between(block, share, pair, true_pair));
  const auto error_of = [&](const std::vector<LevelAtom>& atoms) {
    return errors[static_cast<std::size_t>(atoms.front().parameter)];
  };
  std::vector<std::vector<LevelAtom>> missing = missing_by_target(input.layout, input.steps, n - 1, 2, values);
  std::stable_sort(missing.begin(), missing.end(),
                   [&](const auto& a, const auto& b) { return error_of(a) > error_of(b); });
  return missing;
}

}  // namespace

bool mend_between(const BetweenInput& input, Eigen::Index n, double seconds, double bound, Mending mending, int tries,
                  Eigen::MatrixXd& values, std::vector<LevelAtom>& atoms) {
  Eigen::Ref<Eigen::MatrixXd> pair = values.middleCols(n - 1, 2);
  const auto excess = [&](const std::vector<LevelAtom>& added) {
    Eigen::MatrixXd with = pair;
    add_atoms(input, n, added, with);
    return std::max(0.0, error_around(input, n, seconds, with) - bound);
  };
  const auto put = [&](const std::vector<LevelAtom>& added) {
    atoms.insert(atoms.end(), added.begin(), added.end());
    add_atoms(input, n, added, pair);
  };
  const auto tip = [&](int of_steps) {
    const Tips tips = tips_of(input, n, pair);
    std::optional<std::vector<LevelAtom>> enough;
    if (!tips.smallest.empty() && excess(tips.smallest) <= 0)
      enough = tips.smallest;
    else
      enough = few_atoms(tips.steps, excess, of_steps);
    if (enough) put(*enough);
    return enough.has_value();
  };
  // Most often a turn of about half a circle goes the other way, and little tips it back.
  if (mending == Mending::tips && tip(tries)) return true;
  put(needed_atoms(missing_worst_first(input, n, seconds, values), excess, tries));
  // Within rounding of half a turn even the true values, rounded, may go the other way.
  return excess({}) <= 0 || tip(most_tries);
}

}  // namespace nmc::codec
