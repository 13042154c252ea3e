#include "codec/between.h"

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

/// The values of samples n - 1 and n with one target brought to its true ones.
Eigen::MatrixXd with_true_values(const BetweenInput& input, const LayoutBlock& block, Eigen::Index n,
                                 const Eigen::MatrixXd& values) {
  Eigen::MatrixXd pair = values.middleCols(n - 1, 2);
  for (const Eigen::Index side : {0, 1})
    for (const LevelAtom& atom : missing_atoms(input.layout, input.steps, block, n - 1 + side, values))
      pair(atom.parameter, side) += atom.level * input.steps.anchor(atom.parameter);
  return pair;
}

}  // namespace

void mend_between(const BetweenInput& input, Eigen::Index n, double seconds, double bound, Eigen::MatrixXd& values,
                  LevelClip& levels) {
  std::vector<const LayoutBlock*> left;
  for (const LayoutBlock& block : input.layout.blocks)
    if (block.state != State::fixed) left.push_back(&block);
  double error = error_between(input, n, seconds, values.middleCols(n - 1, 2));
  while (!left.empty() && !(error <= bound)) {
    std::size_t best = 0;
    for (std::size_t k = 0; k < left.size(); ++k) {
      const double then = error_between(input, n, seconds, with_true_values(input, *left[k], n, values));
      if (k == 0 || then < error) {
        best = k;
        error = then;
      }
    }
    for (const Eigen::Index side : {n - 1, n})
      for (const LevelAtom& atom : missing_atoms(input.layout, input.steps, *left[best], side, values)) {
        put_atom(atom, levels.atoms);
        add_atom_values(atom, input.steps, values);
      }
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
}

}  // namespace nmc::codec
