#include "cli/tolerance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/decimal.h"
#include "base/error.h"
#include "cli/nearest.h"

namespace nmc::cli {
namespace {

using codec::Selector;
using codec::Tolerance;

[[noreturn]] void refuse(const std::string& option, const std::string& sentence) {
  throw Error(ErrorCode::usage, option + ": " + sentence);
}

/// A number and what stands behind it.
struct Amount {
  double number = 0;
  std::string unit;
};

Amount parse_amount(const std::string& text, const std::string& option, const char* units) {
  Amount amount;
  const auto [end, failure] = read_decimal(text.data(), text.data() + text.size(), amount.number);
  if (failure != std::errc() || !std::isfinite(amount.number))
    refuse(option, fmt::format("'{}' does not start with a number; {}", text, units));
  amount.unit.assign(end, text.data() + text.size());
  amount.unit.erase(0, amount.unit.find_first_not_of(' '));
  if (amount.unit.empty()) refuse(option, fmt::format("'{}' has no unit; {}", text, units));
  if (!(amount.number > 0)) refuse(option, fmt::format("'{}' must be greater than 0.", text));
  return amount;
}

constexpr std::array<std::pair<const char*, Path>, 4> channels{{{"rotation", Path::rotation},
                                                                {"translation", Path::translation},
                                                                {"scale", Path::scale},
                                                                {"weights", Path::weights}}};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::size_t from = 0;
  for (std::size_t comma = text.find(','); comma != std::string::npos; comma = text.find(',', from)) {
    parts.push_back(text.substr(from, comma - from));
    from = comma + 1;
  }
  parts.push_back(text.substr(from));
  return parts;
}

void add_part(const std::string& part, const std::string& option, Selector& selector) {
  const std::size_t equals = part.find('=');
  const std::string key = equals == std::string::npos ? "joint" : part.substr(0, equals);
  const std::string value = equals == std::string::npos ? part : part.substr(equals + 1);
  if (value.empty()) refuse(option, fmt::format("'{}' has an empty pattern; * stands for every name.", part));
  if (key == "channel") {
    if (selector.path) refuse(option, "channel is given twice.");
    selector.path = parse_channel(value, option);
    return;
  }
  const std::array<std::string, 3> keys{"clip", "joint", "channel"};
  if (key != "clip" && key != "joint")
    refuse(option,
           fmt::format("there is no selector '{}'; there are clip, joint and channel{}", key, did_you_mean(key, keys)));
  std::string& pattern = key == "clip" ? selector.clip : selector.joint;
  if (!pattern.empty()) refuse(option, fmt::format("{} is given twice.", key));
  pattern = value;
}

}  // namespace

Tolerance parse_tolerance(const std::string& text, const std::string& option) {
  constexpr const char* units = "write a share of the character's size, such as 0.1%, or a length: 2mm, 1cm or 0.01m.";
  const auto [number, unit] = parse_amount(text, option, units);
  if (unit == "%") {
    if (number > 100) refuse(option, fmt::format("'{}' is more than 100%.", text));
    return {number / 100, Tolerance::Unit::fraction_of_size};
  }
  if (unit == "mm") return {number / 1000, Tolerance::Unit::world_units};
  if (unit == "cm") return {number / 100, Tolerance::Unit::world_units};
  if (unit == "m") return {number, Tolerance::Unit::world_units};
  refuse(option, fmt::format("'{}' has an unknown unit '{}'; {}", text, unit, units));
}

Path parse_channel(const std::string& text, const std::string& option) {
  std::vector<std::string> names;
  for (const auto& [name, path] : channels) {
    if (text == name) return path;
    names.emplace_back(name);
  }
  refuse(option, fmt::format("there is no channel '{}'; there are rotation, translation, scale and weights{}", text,
                             did_you_mean(text, names)));
}

Selector parse_selector(const std::string& text, const std::string& option) {
  Selector selector;
  for (const std::string& part : split(text)) add_part(part, option, selector);
  return selector;
}

Tolerances parse_tolerances(const std::vector<std::string>& texts) {
  Tolerances tolerances;
  for (const std::string& text : texts) {
    const std::size_t comma = text.find(',');
    const Tolerance tolerance = parse_tolerance(text.substr(0, comma));
    if (comma != std::string::npos) {
      tolerances.rules.push_back({parse_selector(text.substr(comma + 1), "--tolerance"), tolerance});
      continue;
    }
    if (tolerances.has_all)
      refuse(
          "--tolerance",
          fmt::format("'{}' is a second one for everything; say what it is for, such as {},joint=*Hand*.", text, text));
    tolerances.all = tolerance;
    tolerances.has_all = true;
  }
  return tolerances;
}

std::size_t parse_byte_count(const std::string& text, const std::string& option) {
  constexpr const char* units = "write a number of bytes such as 800B, 40KB or 1.5MB.";
  constexpr double most = 1e12;
  const auto [number, unit] = parse_amount(text, option, units);
  constexpr std::array<std::pair<const char*, double>, 5> known{
      {{"B", 1}, {"KB", 1e3}, {"kB", 1e3}, {"MB", 1e6}, {"GB", 1e9}}};
  for (const auto& [name, bytes] : known)
    if (unit == name) {
      if (number * bytes < 1 || number * bytes > most)
        refuse(option, fmt::format("'{}' is out of range; {}", text, units));
      return static_cast<std::size_t>(number * bytes);
    }
  refuse(option, fmt::format("'{}' has an unknown unit '{}'; {}", text, unit, units));
}

}  // namespace nmc::cli
