#include "cli/tolerance.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "base/error.h"

namespace nmc::cli {

using codec::Tolerance;

Tolerance parse_tolerance(const std::string& text) {
  constexpr const char* units = "write a share of the character's size, such as 0.1%, or a length: 2mm, 1cm or 0.01m.";
  double number = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc() || !std::isfinite(number)) {
    throw Error(ErrorCode::usage, fmt::format("--tolerance: '{}' does not start with a number; {}", text, units));
  }
  std::string unit(end, text.data() + text.size());
  unit.erase(0, unit.find_first_not_of(' '));
  if (unit.empty()) throw Error(ErrorCode::usage, fmt::format("--tolerance: '{}' has no unit; {}", text, units));
  if (!(number > 0)) throw Error(ErrorCode::usage, fmt::format("--tolerance: '{}' must be greater than 0.", text));
  if (unit == "%") {
    if (number > 100) throw Error(ErrorCode::usage, fmt::format("--tolerance: '{}' is more than 100%.", text));
    return {number / 100, Tolerance::Unit::fraction_of_size};
  }
  if (unit == "mm") return {number / 1000, Tolerance::Unit::world_units};
  if (unit == "cm") return {number / 100, Tolerance::Unit::world_units};
  if (unit == "m") return {number, Tolerance::Unit::world_units};
  throw Error(ErrorCode::usage, fmt::format("--tolerance: '{}' has an unknown unit '{}'; {}", text, unit, units));
}

double in_world_units(const Tolerance& tolerance, double size) {
  return tolerance.unit == Tolerance::Unit::fraction_of_size ? tolerance.value * size : tolerance.value;
}

}  // namespace nmc::cli
