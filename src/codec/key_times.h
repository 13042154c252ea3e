// Finds the formula by which a file's key times were made, so that they come back bit for bit at no cost.
#pragma once

#include <cstdint>
#include <span>

#include "codec/reference_codec.h"

namespace nmc::codec {

/// The formulas of nmc_decode.h: 0: (first + n) / rate in double; 1: float(first + n) * step in float;
/// 2: start + n * step in double; 3: previous + step in float.
struct TimeFormula {
  std::uint8_t mode = 2;
  std::int32_t first = 0;
  std::uint32_t rate = 0;
  float start_seconds = 0;
  double step_seconds = 0;
  bool exact = true;  ///< every time comes out bit for bit; otherwise differences are coded
};

/// The formula that gives most of `times` (seconds, strictly increasing, at least one) exactly.
TimeFormula fit_times(std::span<const float> times);

/// Gives a clip of the decoder the formula.
void set_formula(const TimeFormula& formula, nmc_clip& clip);

}  // namespace nmc::codec
