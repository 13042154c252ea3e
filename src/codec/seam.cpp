#include "codec/seam.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "codec/atoms.h"
#include "codec/features.h"

namespace nmc::codec {
namespace {

/// An atom that only overlaps an end adds a part of a step there, which no atom of the other end's own could: it gets
/// its mirror image. Of two that are each other's place but not image the smaller one becomes it.
void mirror_atoms(LevelClip& clip, Eigen::Index last, const Eigen::VectorXd& signs) {
  std::vector<LevelAtom> changes;
  for (const LevelAtom& atom : clip.atoms) {
    if (atom.width == LevelAtom::jump_width) continue;
    const auto at = static_cast<Eigen::Index>(atom.sample);
    const auto overlaps = [&](Eigen::Index away) { return away > 0 && away < Eigen::Index{1} << atom.width; };
    if (!overlaps(at) && !overlaps(last - at)) continue;
    LevelAtom image = atom;
    image.sample = static_cast<std::uint32_t>(last - at);
    if (signs(atom.parameter) < 0) image.level = -image.level;
    const auto there = std::find_if(clip.atoms.begin(), clip.atoms.end(), [&](const LevelAtom& other) {
      return other.sample == image.sample && other.parameter == image.parameter && other.width == image.width;
    });
    if (image.sample == atom.sample) {  // in the middle: at the ends of a spin it would be wrong by opposite errors
      if (image.level == atom.level) continue;
    } else if (there != clip.atoms.end()) {
      const std::int32_t own = std::abs(atom.level), other = std::abs(there->level);
      if (own < other || (own == other && atom.sample > image.sample)) continue;
      image.level -= there->level;
    }
    changes.push_back(image);
  }
  put_atoms(changes, clip.atoms);
}

/// What atoms add to each parameter at a sample, in their steps.
Eigen::VectorXd atom_levels(const LevelClip& clip, Eigen::Index parameters, Eigen::Index sample) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(parameters);
  for (const LevelAtom& atom : clip.atoms)
    if (atom.width != LevelAtom::jump_width)
      sum(atom.parameter) +=
          atom.level * atom_share(std::abs(sample - static_cast<Eigen::Index>(atom.sample)), atom.width);
  return sum;
}

}  // namespace

void close_seam(LevelClip& clip, const Eigen::VectorXd& signs, Eigen::Index samples) {
  const Eigen::Index last = samples - 1;
  mirror_atoms(clip, last, signs);
  const Eigen::VectorXd at_first = atom_levels(clip, signs.size(), 0), at_last = atom_levels(clip, signs.size(), last);
  const bool first_leads = at_first.cwiseAbs().sum() > at_last.cwiseAbs().sum();
  const Eigen::VectorXd change =
      first_leads ? signs.cwiseProduct(at_first) - at_last : signs.cwiseProduct(at_last) - at_first;
  const auto follower = static_cast<std::uint32_t>(first_leads ? last : 0);
  std::vector<LevelAtom> closing;
  for (Eigen::Index i = 0; i < change.size(); ++i)
    if (const auto level = static_cast<std::int32_t>(std::lround(change(i))); level != 0)
      closing.push_back({follower, static_cast<int>(i), 0, level});
  put_atoms(closing, clip.atoms);
  tidy_atoms(clip.atoms);
}

}  // namespace nmc::codec
