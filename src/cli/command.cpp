#include "cli/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <type_traits>

#include "base/decimal.h"
#include "base/error.h"
#include "cli/terminal.h"
#include "report/format.h"

namespace nmc::cli {
namespace {

/// The whole of `text` as a number, or false.
template <typename Number>
bool parse_all(const std::string& text, Number& number) {
  const char* last = text.data() + text.size();
  std::from_chars_result read{};
  if constexpr (std::is_floating_point_v<Number>) {
    read = read_decimal(text.data(), last, number);
  } else {
    read = std::from_chars(text.data(), last, number);
  }
  return read.ec == std::errc() && read.ptr == last;
}

}  // namespace

CLI::Validator whole_number(int low, int high) {
  const auto check = [=](const std::string& text) -> std::string {
    int number = 0;
    if (parse_all(text, number) && number >= low && number <= high) return {};
    return fmt::format("'{}' is no whole number from {} to {}", text, low, high);
  };
  return CLI::Validator(check, "");
}

CLI::Validator number(double low, double high) {
  const auto check = [=](const std::string& text) -> std::string {
    double value = 0;
    if (parse_all(text, value) && value >= low && value <= high) return {};
    return fmt::format("'{}' is no number from {} to {}", text, low, high);
  };
  return CLI::Validator(check, "");
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  const auto check = [=](const std::string& text) -> std::string {
    if (std::find(words.begin(), words.end(), text) != words.end()) return {};
    return fmt::format("'{}' is none of {}", text, fmt::join(words, ", "));
  };
  return CLI::Validator(check, "");
}

CLI::Validator positive_number() {
  const auto check = [](const std::string& text) -> std::string {
    double number = 0;
    if (parse_all(text, number) && std::isfinite(number) && number > 0) return {};
    return fmt::format("'{}' is no number greater than 0", text);
  };
  return CLI::Validator(check, "");
}

void print_failure(const std::string& sentence) {
  const char* stop = sentence.ends_with('.') ? "" : ".";
  const bool red = has_colours(stderr);
  fmt::print(stderr, "{}gltf-nmc:{} {}{}\n", red ? "\033[31m" : "", red ? "\033[0m" : "", report::printable(sentence),
             stop);
}

void print(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written) throw Error(ErrorCode::io, "standard output cannot be written.");
}

}  // namespace nmc::cli
