// Node and point numbers (int, -1: none) as positions in containers.
#pragma once

#include <cstddef>

namespace nmc::motion {

/// The position of a number that is not negative.
constexpr std::size_t at(int number) { return static_cast<std::size_t>(number); }

}  // namespace nmc::motion
