// Tolerances as users write them.
#include "cli/tolerance.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "codec/bound.h"

namespace nmc::cli {
namespace {

using Unit = codec::Tolerance::Unit;

TEST(ParseTolerance, SharesAndLengths) {
  const struct {
    const char* text;
    double value;
    Unit unit;
  } cases[]{{"0.5%", 0.005, Unit::fraction_of_size},
            {"100%", 1, Unit::fraction_of_size},
            {"1e-2 %", 1e-4, Unit::fraction_of_size},
            {"2mm", 0.002, Unit::world_units},
            {"1cm", 0.01, Unit::world_units},
            {"0.01m", 0.01, Unit::world_units},
            {"3 m", 3, Unit::world_units}};
  for (const auto& c : cases) {
    const codec::Tolerance parsed = parse_tolerance(c.text);
    EXPECT_DOUBLE_EQ(parsed.value, c.value) << c.text;
    EXPECT_EQ(parsed.unit, c.unit) << c.text;
  }
}

TEST(ParseTolerance, RefusesTheRest) {
  for (const char* text : {"", "%", "mm", "0.5", "5 ", "0%", "-1%", "-2mm", "101%", "nan%", "inf m", "1e999m",
                           "2 miles", "2mmm", "1,5mm", "0x10mm"}) {
    try {
      parse_tolerance(text);
      ADD_FAILURE() << "'" << text << "' was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage) << text;
    }
  }
}

TEST(ParseTolerance, InWorldUnits) {
  EXPECT_DOUBLE_EQ(codec::in_world_units(parse_tolerance("0.1%"), 180), 0.18);
  EXPECT_DOUBLE_EQ(codec::in_world_units(parse_tolerance("2mm"), 180), 0.002);
}

}  // namespace
}  // namespace nmc::cli
