// The HTML report: whatever names a file has, the page carries them unharmed, and it is complete in itself.
#include <gmock/gmock.h>

#include <regex>
#include <string>

#include "base/base64.h"
#include "report/html_report.h"

namespace nmc::report {
namespace {

using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

std::string encoded(std::string_view text) {
  return base64({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

TEST(Base64, VectorsOfRfc4648) {
  EXPECT_EQ(encoded(""), "");
  EXPECT_EQ(encoded("f"), "Zg==");
  EXPECT_EQ(encoded("fo"), "Zm8=");
  EXPECT_EQ(encoded("foo"), "Zm9v");
  EXPECT_EQ(encoded("foobar"), "Zm9vYmFy");
  EXPECT_EQ(encoded("\xff\xfe\xfd"), "//79");
}

/// A character of one node whose names try to leave where they stand.
struct Example {
  std::string name;
  Json report;
  codec::Comparison comparison;

  explicit Example(const std::string& evil) : name(evil) {
    report = {{"command", "compress"},
              {"version", "1"},
              {"input", "folder/" + evil},
              {"output", evil},
              {"tolerance_world_units", 0.001}};
    report["animations"] = Json::array({{{"animation", 0}, {"name", evil}}});
    comparison.skeleton.names = {evil};
    comparison.skeleton.parent = {-1};
    comparison.skeleton.order = {0};
    comparison.skeleton.rest.resize(1);
    comparison.skeleton.rest_matrix = {glm::dmat4(1.0)};
    codec::ComparedClip clip;
    clip.name = evil;
    comparison.clips.push_back(clip);
  }

  std::string page() const { return html_report(report, comparison); }
};

/// What an HTML parser takes for the content of the element that starts with `tag`.
std::string content(const std::string& page, const std::string& tag, const std::string& end) {
  const std::size_t begin = page.find(tag) + tag.size();
  return page.substr(begin, page.find(end, begin) - begin);
}

const std::string data_tag = R"(<script type="application/json" id="data">)";

TEST(HtmlReport, NamesCannotLeaveTheData) {
  for (const std::string name :
       {"</script><script>alert(1)</script>", "<!--<script>", "\"quoted\" 'twice' \\", "%DATA% %IMPORTS% %STYLE%",
        "\u6b69\u304f \u2028 \u2029 \U0001F98A", "a\nb\tc\x01", "&amp;<b>"}) {
    SCOPED_TRACE(name);
    const std::string page = Example(name).page();
    const Json data = Json::parse(content(page, data_tag, "</script>"));
    EXPECT_EQ(data["report"]["animations"][0]["name"], name);
    EXPECT_EQ(data["skeleton"]["names"][0], name);
    EXPECT_EQ(data["clips"][0]["name"], name);
    EXPECT_THAT(content(page, data_tag, "</script>"), Not(HasSubstr("<")));
  }
}

TEST(HtmlReport, TheTitleIsText) {
  const std::string title = content(Example("</title><script>&\"").page(), "<title>", "</title>");
  EXPECT_THAT(title, Not(HasSubstr("<")));
  EXPECT_THAT(title, HasSubstr("&lt;"));
  EXPECT_THAT(title, HasSubstr("&amp;"));
}

TEST(HtmlReport, BytesThatAreNoUtf8AreReplaced) {
  const Json data = Json::parse(content(Example("bad \xff name").page(), data_tag, "</script>"));
  EXPECT_EQ(data["clips"][0]["name"], "bad \ufffd name");
}

TEST(HtmlReport, EveryModuleThatIsImportedIsThere) {
  const std::string page = Example("x").page();
  const Json imports = Json::parse(content(page, R"(<script type="importmap">)", "</script>"))["imports"];
  ASSERT_GT(imports.size(), 10U);
  const std::string prefix = "data:text/javascript;base64,";
  std::size_t found = 0;
  for (const auto& [name, url] : imports.items()) {
    const std::string text = url.get<std::string>();
    ASSERT_TRUE(text.starts_with(prefix)) << name;
    // The decoder of base64 here is a table of its own.
    std::string decoded;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text.substr(prefix.size())) {
      const std::size_t value =
          std::string_view("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/").find(c);
      if (value == std::string_view::npos) break;
      bits = bits << 6 | static_cast<std::uint32_t>(value);
      if ((count += 6) >= 8) decoded += static_cast<char>(bits >> (count -= 8) & 255);
    }
    const std::regex import("from '([^']+)'");
    for (std::sregex_iterator i(decoded.begin(), decoded.end(), import), end; i != end; ++i, ++found)
      EXPECT_TRUE(imports.contains((*i)[1].str())) << name << " imports " << (*i)[1];
  }
  EXPECT_GT(found, 15U);
}

TEST(HtmlReport, NothingComesFromElsewhere) {
  const std::string page = Example("x").page();
  EXPECT_THAT(page, Not(testing::ContainsRegex("(src|href|action)=\"?(https?:|//)")));
  EXPECT_THAT(page, Not(HasSubstr("@import")));
  EXPECT_THAT(page, Not(HasSubstr("url(")));
  EXPECT_THAT(page, Not(HasSubstr("%TITLE%")));
}

}  // namespace
}  // namespace nmc::report
