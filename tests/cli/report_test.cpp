// Tables, numbers and names as the reports print them.
#include <gmock/gmock.h>

#include <limits>

#include "report/compress_report.h"
#include "report/format.h"
#include "report/table.h"
#include "report/verify_report.h"

namespace nmc::report {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Format, Numbers) {
  EXPECT_EQ(format_bytes(0), "0");
  EXPECT_EQ(format_bytes(999), "999");
  EXPECT_EQ(format_bytes(1000), "1,000");
  EXPECT_EQ(format_bytes(1234567), "1,234,567");
  EXPECT_EQ(format_percent(0.001), "0.1%");
  EXPECT_EQ(format_percent(0.0012345), "0.123%");
  EXPECT_EQ(format_length(0.0018), "1.8 mm");
  EXPECT_EQ(format_length(1.8), "1.8 m");
  EXPECT_EQ(format_ratio(1000, 100), "10.0x");
  EXPECT_EQ(format_ratio(0, 100), "-");
}

TEST(Format, WidthOfUtf8) {
  EXPECT_EQ(display_width("abc"), 3U);
  EXPECT_EQ(display_width("h\u00fcpfen"), 6U);
  EXPECT_EQ(display_width("\u6b69\u304f"), 4U);  // two wide characters
  EXPECT_EQ(display_width("e\u0301"), 1U);       // a combining accent
  EXPECT_EQ(display_width("\xff\xfe"), 2U);      // no UTF-8: one column per byte
}

TEST(Format, ShortenKeepsWholeCharacters) {
  EXPECT_EQ(shorten("walk", 4), "walk");
  EXPECT_EQ(shorten("walking", 4), "wal\u2026");
  EXPECT_EQ(shorten("\u6b69\u304f\u8d70\u308b", 6), "\u6b69\u304f\u2026");
}

TEST(Format, PrintableLeavesNoControl) {
  EXPECT_EQ(printable("a\x1b[2Jb\nc\x7f"), "a?[2Jb?c?");
  EXPECT_EQ(printable("\u6b69\xc2\x9b"), "\u6b69?");  // a C1 control
  EXPECT_EQ(printable("\xe6\xad"), "??");             // a cut sequence
}

TEST(Tables, AlignColumnsAndDropEmptyOnes) {
  Table table({{"name", Align::left}, {"nothing"}, {"n"}});
  table.add_row({"\u6b69\u304f", "", "1"});
  table.add_row({"a", "", "1,000"});
  table.add_rule();
  table.add_row({"all", "", "1,001"});
  EXPECT_EQ(table.text(),
            "name      n\n"
            "----  -----\n"
            "\u6b69\u304f      1\n"
            "a     1,000\n"
            "----  -----\n"
            "all   1,001\n");
}

codec::CompressResult example() {
  codec::ClipResult walk;
  walk.name = "walk";
  walk.outcome = codec::Outcome::compressed;
  walk.frames = 31;
  walk.keys_before = 9000;
  walk.json_before = 1000;
  walk.keys_after = 300;
  walk.json_after = 200;
  walk.error.max = 0.0015;
  walk.error.max_joint = 0.001;
  walk.error.mean = 0.0002;
  walk.error.max_node = 1;
  codec::ClipResult jump;
  jump.animation = 1;
  jump.name = "jump";
  jump.outcome = codec::Outcome::kept_larger;
  jump.reason = "no smaller than its keys";
  jump.keys_before = jump.keys_after = 80;
  jump.json_before = jump.json_after = 20;
  codec::CompressResult result;
  result.size = 2;
  result.tolerance = 0.002;
  result.clips = {walk, jump};
  result.notes = {"Two things are worth knowing."};
  return result;
}

TEST(CompressReport, TextTellsEveryAnimation) {
  CompressContext context;
  context.node_names = {"hips", "wrist"};
  context.file_bytes_before = 20000;
  context.file_bytes_after = 10600;
  const std::string text = compress_text(example(), context);
  for (const char* part : {"walk", "10,000", "500", "20.0x", "0.075%", "1.5 mm", "wrist",
                           "jump: stays: no smaller than its keys", "10,100", "600", "16.8x", "20,000 -> 10,600",
                           "2 mm = 0.1% of the character's size (2 m)", "note: Two things"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_THAT(text, Not(HasSubstr("max joint error")));
  context.profile = codec::Profile::paper;
  EXPECT_THAT(compress_text(example(), context), HasSubstr("max joint error"));
}

TEST(CompressReport, JsonCountsKeysAndJson) {
  CompressContext context;
  context.node_names = {"hips", "wrist"};
  const nlohmann::ordered_json json = compress_json(example(), context);
  EXPECT_EQ(json["animations"][0]["bytes_before"], 10000);
  EXPECT_EQ(json["animations"][0]["bytes_after"], 500);
  EXPECT_EQ(json["animations"][0]["error"]["worst_name"], "wrist");
  EXPECT_DOUBLE_EQ(json["animations"][0]["error"]["max_fraction_of_size"].get<double>(), 0.00075);
  EXPECT_EQ(json["animations"][1]["outcome"], "kept_larger");
  EXPECT_TRUE(json["animations"][1]["error"]["worst_node"].is_null());
  EXPECT_EQ(json["totals"]["bytes_before"], 10100);
  EXPECT_EQ(json["totals"]["bytes_after"], 600);
  EXPECT_EQ(json["totals"]["compressed"], 1);
  EXPECT_DOUBLE_EQ(json["tolerance_fraction_of_size"].get<double>(), 0.001);
}

TEST(VerifyReport, AnErrorThatIsNoNumberDoesNotHold) {
  VerifyContext context;
  codec::VerifiedClip clip;
  EXPECT_TRUE(holds(clip, context));
  clip.share_of_tolerance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(holds(clip, context));
  clip.share_of_tolerance = 2;
  EXPECT_FALSE(holds(clip, context));
  context.joints_alone = true;
  EXPECT_TRUE(holds(clip, context));
}

}  // namespace
}  // namespace nmc::report
