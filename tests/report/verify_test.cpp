// The report of verify: what it says of loops and of what is none.
#include <gmock/gmock.h>

#include <string>

#include "report/verify_report.h"

namespace nmc::report {
namespace {

using testing::ContainsRegex;

TEST(VerifyReport, OnlyLoopsHaveASeam) {
  codec::Verification result;
  result.tolerance = 0.01;
  codec::VerifiedClip loop, other;
  loop.name = "walk";
  loop.error.loop_seam = 0.002;
  other.name = "fall";
  result.clips = {loop, other};
  const std::string text = verify_text(result, {});
  EXPECT_THAT(text, ContainsRegex("walk +0 deg +0 mm +2 mm +0 mm"));
  EXPECT_THAT(text, ContainsRegex("fall +0 deg +0 mm +- +0 mm"));
  const nlohmann::ordered_json json = verify_json(result, {});
  EXPECT_EQ(json["animations"][0]["error"]["loop_seam_world_units"], 0.002);
  EXPECT_TRUE(json["animations"][1]["error"]["loop_seam_world_units"].is_null());
}

}  // namespace
}  // namespace nmc::report
