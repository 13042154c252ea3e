// A small counter-based random generator with the same numbers on every machine, for initial weights.
#pragma once

#include <cstdint>

namespace nmc::network {

/// The SplitMix64 sequence (Steele, Lea, Flood 2014) from a seed.
class Random {
 public:
  explicit Random(std::uint64_t seed) : counter_(seed) {}

  std::uint64_t bits() {
    counter_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = counter_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  /// A multiple of 2^-24 in [-1, 1), exact in float.
  double uniform() { return static_cast<double>(bits() >> 39) * 0x1p-24 - 1.0; }

 private:
  std::uint64_t counter_;
};

}  // namespace nmc::network
