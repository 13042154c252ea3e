// Evaluation of one animation curve at one time, as glTF 2.0 section 3.11 and appendix C say.
#pragma once

#include <span>

#include "base/animation.h"

namespace nmc::motion {

/// The value of `curve` at `seconds`, clamped to the keyed range; out has curve.width entries. Rotations (x, y, z, w) come out with unit
/// length; LINEAR rotations are slerped on the short arc.
void evaluate(const Curve& curve, double seconds, std::span<double> out);

}  // namespace nmc::motion
