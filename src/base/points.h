// The points on a character at which error is seen: joint origins and places on the skin. Plain data.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace nmc {

/// A share of a point's position: `weight` times the world transform of `node` applied to `offset`.
struct Influence {
  int node = -1;
  std::array<double, 3> offset{};  ///< in the node's local space (for a skin: inverse bind matrix times vertex)
  double weight = 1.0;
};

/// How far morph target `target` of `node` moves the farthest vertex per unit of weight, in the node's local units.
struct MorphReach {
  int node = -1;
  int target = 0;
  double reach = 0.0;
};

/// A set of points; point i is the sum of influences[first[i]] .. influences[first[i + 1] - 1].
struct Points {
  std::vector<std::uint32_t> first{0};
  std::vector<Influence> influences;
  std::vector<MorphReach> morphs;

  std::size_t size() const { return first.size() - 1; }
  void add(const Influence* begin, const Influence* end) {
    influences.insert(influences.end(), begin, end);
    first.push_back(static_cast<std::uint32_t>(influences.size()));
  }
};

}  // namespace nmc
