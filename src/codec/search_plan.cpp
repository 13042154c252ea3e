#include "codec/search_plan.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "codec/windows.h"

namespace nmc::codec {
namespace {

/// Longer clips are smallest with coarser steps and dearer bits.
constexpr Eigen::Index short_samples = 120;

/// Windows, steps and rate are not searched.
bool is_quick(int effort) { return effort <= 1; }

}  // namespace

SearchPlan plan_of(int effort, Eigen::Index samples) {
  const auto plan = [&]() -> SearchPlan {
    // Long clips have more to learn from in each training and get fewer of them, so that time stays linear.
    const int fewer = static_cast<int>(std::clamp<Eigen::Index>(samples / 160, 1, 5));
    if (is_quick(effort))
      return {.first_iterations = 20, .iterations = 30, .trials = 0, .prunes = false, .guesses = true};
    if (effort <= 2) return {60, 40, 3 / fewer, 0};
    if (effort <= 3) return {80, 60, 6 / fewer, 0};
    if (effort <= 5) return {100, 70, std::max(2, 7 / fewer), 100};
    if (effort <= 7) return {250, 200, 16, 400};
    return {500, 400, 24, 1000};
  };
  SearchPlan made = plan();
  if (samples > short_samples) {
    made.first_exponent = -2;
    made.first_rate = 0.45;
  }
  return made;
}

SearchPlan excerpt_plan_of(int effort, Eigen::Index turns) {
  const auto plan = [&]() -> SearchPlan {
    if (effort <= 2) return {60, 40, 3, 50};
    if (effort <= 3) return {80, 60, 4, 80};
    return {150, 70, 4, turns > 1 ? 250 : 200};
  };
  SearchPlan made = plan();
  made.first_rate = 0.24;
  return made;
}

Eigen::Index excerpt_samples(int effort, Eigen::Index samples) {
  constexpr Eigen::Index shortest = 500, most = 800;
  return is_quick(effort) || effort > 5 || samples < shortest ? 0 : std::min(most, samples / 3);
}

std::vector<int> efforts_of(int effort) {
  std::vector<int> efforts;
  for (const int lower : {5, 7})
    if (lower < effort) efforts.push_back(lower);
  efforts.push_back(effort);
  return efforts;
}

std::vector<SparseSettings> cuts_of(const SearchContext& context, const PreparedClip& clip, int effort) {
  std::vector<SparseSettings> cuts;
  const Eigen::Index samples = clip.layout.values.cols();
  const bool loops = clip.loops, jumps = !clip.jumps.empty();
  const auto whole = static_cast<std::uint32_t>(samples);
  if (samples <= 400 && !loops) cuts.push_back({.basis = Basis::cosine, .boundaries = {0, whole}});
  if (samples >= 8 && samples <= 400) {
    // What is periodic would be wrong by opposite errors at the two ends of a spin.
    const bool spins = (end_signs(clip.layout).array() < 0).any();
    const Basis basis = loops && spins ? Basis::sine : Basis::periodic;
    cuts.push_back({.basis = basis, .boundaries = {0, whole - 1}});
  }
  const bool quick = is_quick(effort);
  const auto add_windows = [&](std::vector<std::uint32_t> boundaries) {
    cuts.push_back({.basis = Basis::sine, .boundaries = std::move(boundaries)});
  };
  if (samples >= 8 && context.parts.fitted_windows && !(quick && samples > 200))
    add_windows(fitted_windows(clip.layout, clip.steps, clip.jumps, samples > short_samples ? -6 : 1, context.threads));
  else if (samples > 200)
    for (const std::size_t length : quick ? std::vector<std::size_t>{64, 160} : std::vector<std::size_t>{128})
      add_windows(even_windows(static_cast<std::size_t>(samples), length));
  for (SparseSettings& cut : cuts) {
    cut.loops = loops;
    cut.jumps = jumps;
  }
  if (jumps && effort > 2) {
    const std::vector<SparseSettings> with = cuts;
    for (SparseSettings cut : with) {
      cut.jumps = false;
      cuts.push_back(cut);
    }
  }
  return cuts;
}

}  // namespace nmc::codec
