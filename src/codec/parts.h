// The parts of the default profile that a measurement can leave out, to see what each of them brings. Plain data.
#pragma once

namespace nmc::codec {

struct Parts {
  bool kinematics = true;          ///< the loss is what points see; without: the parameters' own errors
  bool rising_norm = true;         ///< p-norms up to 6; without: the squared error
  bool quantisation_aware = true;  ///< rounding and the rate in training; without: the transform, rounded
  bool refinement = true;          ///< single levels are repaired and pruned after training
  bool corrections = true;         ///< atoms
  bool fitted_windows = true;      ///< windows follow the motion; without: even ones, of long clips alone
};

}  // namespace nmc::codec
