// Decimals out of text: which beginnings are numbers, to where, and what they are.
#include "base/decimal.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <string_view>

namespace {

struct Read {
  double value;
  std::string_view rest;
  std::errc failure;
};

Read read(std::string_view text) {
  Read result{-7, {}, {}};
  const auto [end, failure] = nmc::read_decimal(text.data(), text.data() + text.size(), result.value);
  result.rest = text.substr(static_cast<std::size_t>(end - text.data()));
  result.failure = failure;
  return result;
}

struct Case {
  std::string_view text;
  double value;
  std::string_view rest;
};

TEST(Decimal, TheLongestBeginningThatIsANumber) {
  for (const Case& wanted :
       {Case{"1", 1, ""}, Case{"-1.5mm", -1.5, "mm"}, Case{".5%", 0.5, "%"}, Case{"5.", 5, ""}, Case{"2e3", 2000, ""},
        Case{"2E+3", 2000, ""}, Case{"2e-3 m", 0.002, " m"}, Case{"2em", 2, "em"}, Case{"2e+", 2, "e+"},
        Case{"0x10", 0, "x10"}, Case{"1.2.3", 1.2, ".3"}, Case{"0e99999", 0, ""}, Case{"0.1", 0.1, ""},
        Case{"9007199254740993", 9007199254740992.0, ""}}) {
    const Read got = read(wanted.text);
    EXPECT_EQ(got.failure, std::errc()) << wanted.text;
    EXPECT_EQ(got.value, wanted.value) << wanted.text;
    EXPECT_EQ(got.rest, wanted.rest) << wanted.text;
  }
  EXPECT_EQ(read("inf").value, INFINITY);
  EXPECT_EQ(read("-INFINITYx").value, -INFINITY);
  EXPECT_EQ(read("-INFINITYx").rest, "x");
  EXPECT_TRUE(std::isnan(read("NaN").value));
}

TEST(Decimal, NoNumber) {
  for (const std::string_view text : {"", "-", ".", "-.", "+1", " 1", "e5", "mm", ",5"}) {
    const Read got = read(text);
    EXPECT_EQ(got.failure, std::errc::invalid_argument) << text;
    EXPECT_EQ(got.rest, text);
    EXPECT_EQ(got.value, -7) << text;
  }
}

TEST(Decimal, BeyondTheRangeIsReadButChangesNothing) {
  for (const std::string_view text : {"1e999m", "-1e999m", "1e-999m"}) {
    const Read got = read(text);
    EXPECT_EQ(got.failure, std::errc::result_out_of_range) << text;
    EXPECT_EQ(got.rest, "m");
    EXPECT_EQ(got.value, -7) << text;
  }
}

std::string written(double value) {
  std::array<char, 32> text{};
  return {text.data(), nmc::write_decimal(text.data(), text.data() + text.size(), value)};
}

TEST(Decimal, TheShortestThatReadsBackIsWritten) {
  EXPECT_EQ(written(0), "0e+00");
  EXPECT_EQ(written(-0.0), "-0e+00");
  EXPECT_EQ(written(-1.5), "-1.5e+00");
  EXPECT_EQ(written(0.1), "1e-01");
  EXPECT_EQ(written(1e300), "1e+300");
  EXPECT_EQ(written(0.1 + 0.2), "3.0000000000000004e-01");
  EXPECT_EQ(written(-2.2250738585072014e-308), "-2.2250738585072014e-308");
}

TEST(Decimal, AFloatIsItsShortestDecimal) {
  EXPECT_EQ(nmc::as_decimal(0.1F), 0.1);
  EXPECT_EQ(nmc::as_decimal(-3.3333333e-7F), -3.3333333e-7);
  EXPECT_EQ(nmc::as_decimal(0.5F), 0.5);
  EXPECT_EQ(nmc::as_decimal(1.17549435e-38F), 1.1754944e-38);
}

}  // namespace
