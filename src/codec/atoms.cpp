#include "codec/atoms.h"

#include <algorithm>
#include <cmath>

#include "codec/features.h"

namespace nmc::codec {

void put_atom(const LevelAtom& atom, std::vector<LevelAtom>& atoms) {
  const auto same = std::find_if(atoms.begin(), atoms.end(), [&](const LevelAtom& other) {
    return other.sample == atom.sample && other.parameter == atom.parameter && other.width == atom.width;
  });
  if (same == atoms.end())
    atoms.push_back(atom);
  else
    same->level += atom.level;
}

void add_atom_values(const LevelAtom& atom, const ParameterSteps& steps, Eigen::MatrixXd& values) {
  const Eigen::Index at = atom.sample, half = Eigen::Index{1} << atom.width;
  const Eigen::Index end = std::min<Eigen::Index>(values.cols(), at + half);
  for (Eigen::Index n = std::max<Eigen::Index>(0, at - half + 1); n < end; ++n)
    values(atom.parameter, n) += atom.level * steps.anchor(atom.parameter) * atom_share(std::abs(n - at), atom.width);
}

std::vector<LevelAtom> missing_atoms(const ClipLayout& layout, const ParameterSteps& steps, const LayoutBlock& block,
                                     Eigen::Index n, const Eigen::MatrixXd& values) {
  std::vector<LevelAtom> atoms;
  for (int a = 0; a < block.block.width; ++a) {
    const int parameter = block.block.first + a;
    const double amount = layout.values(parameter, n) - values(parameter, n);
    if (const auto level = static_cast<std::int32_t>(std::lround(amount / steps.anchor(parameter))); level != 0)
      atoms.push_back({static_cast<std::uint32_t>(n), parameter, 0, level});
  }
  return atoms;
}

}  // namespace nmc::codec
