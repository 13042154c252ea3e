// For methods that find their own setting: the coarsest whole setting within the bound, clip by clip.
#pragma once

#include <functional>

namespace nmc::baselines {

/// The smallest setting of [low, high] that `holds`, which a bisection finds where finer settings err less; high where
/// it finds none.
inline int coarsest_setting(int low, int high, const std::function<bool(int)>& holds) {
  while (low < high) {
    const int middle = low + (high - low) / 2;
    if (holds(middle))
      high = middle;
    else
      low = middle + 1;
  }
  return low;
}

}  // namespace nmc::baselines
