// gltf-nmc compare: reports in every form, and decoding in another process than encoded.
#include <cmath>

#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using testing::HasSubstr;

class CompareCommand : public CommandLine {
 protected:
  static std::string text(const std::string& path) {
    const Bytes bytes = read_bytes(path);
    return {bytes.begin(), bytes.end()};
  }
};

const char* const quick = "svd,dct,draco,meshopt";

TEST_F(CompareCommand, AnotherProcessDecodesTheBytes) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  const std::string folder = file("kept");
  const Json made = Json::parse(
      run_well({"compare", in, "--tolerances", "1,5%", "--effort", "1", "--keep-encoded", folder, "--json"}).out);
  const Json again =
      Json::parse(run_well({"compare", in, "--tolerances", "1,5%", "--check-encoded", folder, "--json"}).out);
  ASSERT_EQ(made["methods"].size(), again["methods"].size());
  int compared = 0;
  for (std::size_t m = 0; m < made["methods"].size(); ++m)
    for (std::size_t t = 0; t < 2; ++t) {
      const Json &a = made["methods"][m]["atTolerances"][t], &b = again["methods"][m]["atTolerances"][t];
      ASSERT_EQ(a.is_null(), b.is_null()) << made["methods"][m]["name"];
      if (a.is_null()) continue;
      EXPECT_EQ(a["bytes"], b["bytes"]);
      EXPECT_DOUBLE_EQ(a["maxError"].get<double>(), b["maxError"].get<double>()) << made["methods"][m]["name"];
      EXPECT_LE(b["maxError"].get<double>(), made["tolerances"][t].get<double>());
      EXPECT_EQ(a["bytes"].get<std::uintmax_t>(),
                std::filesystem::file_size(folder + "/" + made["methods"][m]["name"].get<std::string>() +
                                           (t == 0 ? "@1%.bin" : "@5%.bin")));
      ++compared;
    }
  EXPECT_GE(compared, 8);
}

TEST_F(CompareCommand, TheNumberOfThreadsChangesNoByte) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  std::vector<Json> reports;
  for (const char* threads : {"1", "3"}) {
    Json report = Json::parse(
        run_well({"compare", in, "--methods", quick, "--tolerances", "0.5,2%", "--threads", threads, "--json"}).out);
    for (Json& method : report["methods"])
      for (const char* list : {"atTolerances", "curve"})
        for (Json& made : method[list])
          if (!made.is_null()) made["encodeSeconds"] = made["decodeSeconds"] = 0;
    reports.push_back(std::move(report));
  }
  EXPECT_EQ(reports[0], reports[1]);
}

TEST_F(CompareCommand, WritesTableAndPage) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  const ProcessResult table = run_well({"compare", in, "--methods", quick, "--tolerances", "1%", "-o", file("a.html")});
  for (const char* name : {"svd", "dct", "draco", "meshopt"}) EXPECT_THAT(table.out, HasSubstr(name));
  EXPECT_THAT(table.out, HasSubstr("tolerance 1%"));
  const std::string page = text(file("a.html"));
  EXPECT_THAT(page, testing::StartsWith("<!DOCTYPE html>"));
  EXPECT_THAT(page, HasSubstr("<polyline"));
  EXPECT_THAT(page, testing::Not(HasSubstr("src=")));
  EXPECT_THAT(page, testing::Not(HasSubstr("nan")));
}

TEST_F(CompareCommand, CsvHasOneRowPerEncoding) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  run_well({"compare", in, "--methods", "svd", "--tolerances", "0.5,1,5%", "-o", file("a.csv"), "--quiet"});
  const std::string csv = text(file("a.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 4);
  EXPECT_THAT(csv, testing::StartsWith("method,tolerance,knob,bytes,"));
}

TEST_F(CompareCommand, RefusesWhatItCannotDo) {
  const std::string in = input("in.glb", TinyGlb().bytes());
  expect_failure({"compare", in, "--methods", "svd,zip"}, 1, {"zip", "svd", "meshopt"});
  expect_failure({"compare", in, "--tolerances", "1"}, 1, {"unit"});
  expect_failure({"compare", in, "-o", file("a.txt")}, 1, {".html", ".csv"});
  expect_failure({"compare", in, "--check-encoded", file("none")}, 2, {"--check-encoded", "none"});
  expect_failure({"compare", file("no.glb")}, 2, {"no.glb"});
}

}  // namespace
}  // namespace nmc::test
