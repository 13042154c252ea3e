#include "codec/jumps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "codec/atoms.h"

namespace nmc::codec {
namespace {

constexpr double least_steps = 32;  ///< of an anchor; smaller jumps cost about what their atoms would
constexpr double least_ratio = 10;  ///< to the differences around
constexpr Eigen::Index reach = 4;   ///< differences looked at on either side

/// Of the differences around difference n (sample n minus the one before) the third largest: the start of a movement
/// has more large ones than that on one side, another jump near by does not count.
double usual_difference(const Eigen::RowVectorXd& difference, Eigen::Index n) {
  std::array<double, 2 * reach> around{};
  for (Eigen::Index k = 1; k <= reach; ++k) {
    const Eigen::Index before = n - k, after = n + k;
    around[static_cast<std::size_t>(2 * k - 2)] = before >= 1 ? std::abs(difference(before)) : 0;
    around[static_cast<std::size_t>(2 * k - 1)] = after < difference.size() ? std::abs(difference(after)) : 0;
  }
  std::nth_element(around.begin(), around.begin() + 2, around.end(), std::greater<>());
  return around[2];
}

/// What a jump adds to the motion: its difference without the mean of those next to it that are no jumps themselves.
double height(const Eigen::RowVectorXd& difference, Eigen::Index n) {
  double sum = 0;
  int count = 0;
  for (const Eigen::Index k : {n - 1, n + 1}) {
    if (k < 1 || k >= difference.size() || std::abs(difference(k)) * least_ratio > std::abs(difference(n))) continue;
    sum += difference(k);
    ++count;
  }
  return difference(n) - (count > 0 ? sum / count : 0);
}

/// The jumps of one parameter, 0 where there is none.
Eigen::RowVectorXd jumps_of(const Eigen::RowVectorXd& values, double least) {
  Eigen::RowVectorXd difference = Eigen::RowVectorXd::Zero(values.size()), jumps = difference;
  for (Eigen::Index n = 1; n < values.size(); ++n) difference(n) = values(n) - values(n - 1);
  for (Eigen::Index n = 1; n < values.size(); ++n) {
    if (std::abs(difference(n)) < least) continue;
    if (std::abs(difference(n)) > least_ratio * usual_difference(difference, n)) jumps(n) = height(difference, n);
  }
  return jumps;
}

bool is_spike(const Eigen::RowVectorXd& jumps, Eigen::Index n) {
  return n + 1 < jumps.size() && jumps(n) != 0 && std::abs(jumps(n) + jumps(n + 1)) < 0.25 * std::abs(jumps(n));
}

void append(const Eigen::RowVectorXd& jumps, int parameter, double step, std::vector<LevelAtom>& atoms) {
  for (Eigen::Index n = 1; n < jumps.size(); ++n) {
    const bool spike = is_spike(jumps, n);
    const double exact = (spike ? (jumps(n) - jumps(n + 1)) / 2 : jumps(n)) / step;
    if (std::abs(exact) < 1 || std::abs(exact) >= LevelAtom::largest_level) continue;
    atoms.push_back({static_cast<std::uint32_t>(n), parameter, spike ? 0 : LevelAtom::jump_width,
                     static_cast<std::int32_t>(std::lround(exact))});
    if (spike) ++n;
  }
}

}  // namespace

std::vector<LevelAtom> find_jumps(const ClipLayout& layout, const ParameterSteps& steps) {
  constexpr Eigen::Index fewest = 8;  // samples; keys are as small in shorter clips
  std::vector<LevelAtom> atoms;
  if (layout.values.cols() < fewest) return atoms;
  for (const Eigen::Index parameter : layout.moving)
    append(jumps_of(layout.values.row(parameter), least_steps * steps.anchor(parameter)), static_cast<int>(parameter),
           steps.anchor(parameter), atoms);
  tidy_atoms(atoms);
  return atoms;
}

}  // namespace nmc::codec
