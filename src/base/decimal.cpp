#include "base/decimal.h"

#include <array>

#ifndef __cpp_lib_to_chars
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#endif

namespace nmc {

#ifdef __cpp_lib_to_chars

std::from_chars_result read_decimal(const char* first, const char* last, double& value) {
  return std::from_chars(first, last, value);
}

char* write_decimal(char* first, char* last, double value) {
  return std::to_chars(first, last, value, std::chars_format::scientific).ptr;
}

double as_decimal(float value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double decimal = 0;
  std::from_chars(text.data(), end, decimal);
  return decimal;
}

#else

namespace {

const char* skip_digits(const char* at, const char* last) {
  return std::find_if(at, last, [](char c) { return c < '0' || c > '9'; });
}

bool begins_with_word(const char* at, const char* last, std::string_view word) {
  const auto same = [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; };
  return static_cast<std::size_t>(last - at) >= word.size() && std::equal(at, at + word.size(), word.begin(), same);
}

/// The end of the digits, with a point among them or not; `at` where there is none.
const char* skip_mantissa(const char* at, const char* last) {
  const char* whole = skip_digits(at, last);
  if (whole == last || *whole != '.') return whole;
  const char* fraction = skip_digits(whole + 1, last);
  return fraction - at > 1 ? fraction : at;
}

const char* skip_exponent(const char* at, const char* last) {
  if (at == last || (*at != 'e' && *at != 'E')) return at;
  const char* digits = at + 1;
  if (digits != last && (*digits == '+' || *digits == '-')) ++digits;
  const char* end = skip_digits(digits, last);
  return end == digits ? at : end;
}

/// The end of the number at `first`, `first` where there is none.
const char* number_end(const char* first, const char* last) {
  const char* at = first != last && *first == '-' ? first + 1 : first;
  for (const std::string_view word : {"infinity", "inf", "nan"})
    if (begins_with_word(at, last, word)) return at + word.size();
  const char* mantissa = skip_mantissa(at, last);
  return mantissa == at ? first : skip_exponent(mantissa, last);
}

}  // namespace

// std::strtod knows more forms and other locales; the program stays in the "C" locale, and only a number of
// std::from_chars gets to it.
std::from_chars_result read_decimal(const char* first, const char* last, double& value) {
  const char* end = number_end(first, last);
  if (end == first) return {first, std::errc::invalid_argument};
  const std::string text(first, end);
  const double number = std::strtod(text.c_str(), nullptr);
  const bool has_word = std::isalpha(static_cast<unsigned char>(text[text[0] == '-' ? 1 : 0])) != 0;
  const bool has_digit = text.substr(0, text.find_first_of("eE")).find_first_of("123456789") != std::string::npos;
  const bool is_beyond = std::isinf(number) || (number == 0 && has_digit);
  if (!has_word && is_beyond) return {end, std::errc::result_out_of_range};
  value = number;
  return {end, std::errc()};
}

char* write_decimal(char* first, char* last, double value) {
  for (int digits = 0;; ++digits) {
    const int length = std::snprintf(first, static_cast<std::size_t>(last - first), "%.*e", digits, value);
    if (digits == std::numeric_limits<double>::max_digits10 - 1 || std::strtod(first, nullptr) == value)
      return first + length;
  }
}

double as_decimal(float value) {
  std::array<char, 32> text{};
  for (int digits = 0;; ++digits) {
    std::snprintf(text.data(), text.size(), "%.*e", digits, static_cast<double>(value));
    if (digits == std::numeric_limits<float>::max_digits10 - 1 || std::strtof(text.data(), nullptr) == value)
      return std::strtod(text.data(), nullptr);
  }
}

#endif

}  // namespace nmc
