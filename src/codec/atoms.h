// Atoms: single corrections of one parameter around one sample.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "codec/clip_layout.h"
#include "codec/clip_set.h"
#include "codec/sparse_training.h"

namespace nmc::codec {

/// Adds an atom to a list; to the one of the same sample, parameter and width if there is one.
void put_atom(const LevelAtom& atom, std::vector<LevelAtom>& atoms);

/// Adds atoms to a list, each as put_atom does; for many.
void put_atoms(const std::vector<LevelAtom>& added, std::vector<LevelAtom>& atoms);

/// All atoms of some lists.
std::vector<LevelAtom> joined(const std::vector<std::vector<LevelAtom>>& lists);

/// Puts a list into the order of the stream, without atoms that have become nothing.
void tidy_atoms(std::vector<LevelAtom>& atoms);

/// Adds what one atom of `clip`, whose windows are known, means to the values (all parameters x samples).
void add_atom_values(const LevelAtom& atom, const LevelClip& clip, const ParameterSteps& steps,
                     Eigen::MatrixXd& values);

/// The atoms that bring each moving target from `values` (all parameters x samples) to its true values at `count`
/// samples from `first` on; one list per target that lacks something.
std::vector<std::vector<LevelAtom>> missing_by_target(const ClipLayout& layout, const ParameterSteps& steps,
                                                      Eigen::Index first, Eigen::Index count,
                                                      const Eigen::MatrixXd& values);

/// What atoms leave above a bound; not negative.
using Excess = std::function<double(const std::vector<LevelAtom>&)>;

/// The lists of atoms that lower `excess` most, one after the other, joined; nothing where a few do not bring it to 0,
/// or not within `tries` lists, of which those that were tried are subtracted.
std::optional<std::vector<LevelAtom>> few_atoms(const std::vector<std::vector<LevelAtom>>& lists, const Excess& excess,
                                                int& tries);

/// Of some lists of atoms few that bring `excess` to 0: one after the other as long as each lowers it, or, where a few
/// are not enough, all but those that can be left out, the dearest first, as far as `tries` go (few_atoms). All where
/// all are not enough.
std::vector<LevelAtom> needed_atoms(std::vector<std::vector<LevelAtom>> lists, const Excess& excess, int& tries);

}  // namespace nmc::codec
