#include "codec/key_times.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace nmc::codec {
namespace {

std::size_t misses(const TimeFormula& formula, std::span<const float> times) {
  nmc_clip clip{};
  set_formula(formula, clip);
  std::size_t count = 0;
  float previous = 0;
  for (std::size_t n = 0; n < times.size(); ++n) {
    if (nmc_formula_time(&clip, static_cast<std::uint32_t>(n), previous) != times[n]) ++count;
    previous = times[n];
  }
  return count;
}

/// A float step may be off by a unit in the last place from what two times show: its neighbours are tried as well.
void add_float_steps(std::vector<TimeFormula>& candidates, TimeFormula formula, float step) {
  for (const float s : {step, std::nextafter(step, 0.0f), std::nextafter(step, 1e30f)}) {
    formula.step_seconds = s;
    candidates.push_back(formula);
  }
}

std::vector<TimeFormula> candidates_for(std::span<const float> times) {
  std::vector<TimeFormula> candidates;
  const double start = times.front();
  const double step =
      times.size() > 1 ? (static_cast<double>(times.back()) - start) / static_cast<double>(times.size() - 1) : 1.0;
  const double rate = 1.0 / step;
  const double whole = std::round(rate);
  if (whole >= 1 && whole <= 1e6 && std::abs(whole - rate) <= 1e-3 * rate && std::abs(start * whole) < 1e9)
    candidates.push_back(
        {0, static_cast<std::int32_t>(std::round(start * whole)), static_cast<std::uint32_t>(whole), 0, 0, true});
  const double first = std::round(start / step);
  if (std::abs(first) < 1e6) {
    const TimeFormula product{1, static_cast<std::int32_t>(first), 0, 0, 0, true};
    add_float_steps(candidates, product, static_cast<float>(step));
    if (times.size() > 1) add_float_steps(candidates, product, times[1] - times[0]);
  }
  candidates.push_back({2, 0, 0, times.front(), step, true});
  candidates.push_back({2, 0, 0, times.front(), static_cast<double>(static_cast<float>(step)), true});
  for (double scale = 1e4; scale < 1e10; scale *= 10)  // a frame time written with few decimals, as in BVH files
    candidates.push_back({2, 0, 0, times.front(), std::round(step * scale) / scale, true});
  const TimeFormula sum{3, 0, 0, times.front(), 0, true};
  add_float_steps(candidates, sum, static_cast<float>(step));
  if (times.size() > 1) add_float_steps(candidates, sum, times[1] - times[0]);
  return candidates;
}

}  // namespace

void set_formula(const TimeFormula& formula, nmc_clip& clip) {
  clip.time_mode = formula.mode;
  clip.time_first = formula.first;
  clip.time_rate = formula.rate;
  clip.time_start = formula.start_seconds;
  clip.time_step = formula.step_seconds;
  clip.time_exact = formula.exact ? 1 : 0;
}

TimeFormula fit_times(std::span<const float> times) {
  TimeFormula best;
  std::size_t fewest = times.size() + 1;
  for (const TimeFormula& candidate : candidates_for(times)) {
    const std::size_t count = misses(candidate, times);
    if (count < fewest) {
      fewest = count;
      best = candidate;
    }
    if (fewest == 0) break;
  }
  best.exact = fewest == 0;
  return best;
}

}  // namespace nmc::codec
