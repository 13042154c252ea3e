// Motions of the humanoid as functions of time, before they are sampled.
#pragma once

#include <functional>
#include <vector>

#include "samples/humanoid.h"

namespace nmc::samples {

/// A motion as a function of time.
struct Motion {
  double seconds = 0.0;
  bool loops = false;  ///< the state at the end is the state at 0
  std::function<BodyState(double)> state;
};

enum class GaitKind { walk, run };

/// So many cycles (of two steps) of walking or running, along +Z or in place.
Motion gait_motion(const Rig& rig, GaitKind kind, int cycles, bool in_place);

/// When the feet's balls stand in the motion of so many cycles.
std::vector<Contact> gait_contacts(GaitKind kind, int cycles);

}  // namespace nmc::samples
