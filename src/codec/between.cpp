#include "codec/between.h"

#include <algorithm>
#include <vector>

#include "codec/atoms.h"

namespace nmc::codec {
namespace {

/// The error at a time between two samples whose values are given (all parameters x 2).
double error_between(const BetweenInput& input, Eigen::Index n, double seconds, const Eigen::MatrixXd& pair) {
  const std::vector<float>& times = input.clip.clip.times;
  const auto at = static_cast<std::size_t>(n);
  const motion::Clip two{input.clip.clip.name, {times[at - 1], times[at]}, {}};
  return input.meter.error_at(input.clip.original,
                              with_kept(input.clip, clip_of_parameters(two, input.frame, input.layout, pair)), seconds);
}

}  // namespace

void mend_between(const BetweenInput& input, Eigen::Index n, double seconds, double bound, Eigen::MatrixXd& values,
                  LevelClip& levels) {
  const auto excess = [&](const std::vector<LevelAtom>& atoms) {
    Eigen::MatrixXd pair = values.middleCols(n - 1, 2);
    for (const LevelAtom& atom : atoms)
      pair(atom.parameter, static_cast<Eigen::Index>(atom.sample) - (n - 1)) +=
          atom.level * input.steps.anchor(atom.parameter);
    return std::max(0.0, error_between(input, n, seconds, pair) - bound);
  };
  for (const LevelAtom& atom : needed_atoms(missing_by_target(input.layout, input.steps, n - 1, 2, values), excess)) {
    put_atom(atom, levels.atoms);
    add_atom_values(atom, levels, input.steps, values);
  }
}

}  // namespace nmc::codec
