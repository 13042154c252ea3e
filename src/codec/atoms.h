// Atoms: single corrections of one parameter around one sample.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "codec/clip_layout.h"
#include "codec/clip_set.h"
#include "codec/sparse_training.h"

namespace nmc::codec {

/// Adds an atom to a list; to the one of the same sample, parameter and width if there is one.
void put_atom(const LevelAtom& atom, std::vector<LevelAtom>& atoms);

/// Adds what one atom means to the values (all parameters x samples).
void add_atom_values(const LevelAtom& atom, const ParameterSteps& steps, Eigen::MatrixXd& values);

/// The atoms that bring a target at sample n from `values` (all parameters x samples) to its true values.
std::vector<LevelAtom> missing_atoms(const ClipLayout& layout, const ParameterSteps& steps, const LayoutBlock& block,
                                     Eigen::Index n, const Eigen::MatrixXd& values);

}  // namespace nmc::codec
