// Several files in one run, the cache of earlier results, and runs that only say what they would do.
#include <algorithm>

#include "cli/command_line.h"
#include "support/tiny_glb.h"

namespace nmc::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int usage = 1;
constexpr int cannot_access = 2;
constexpr int invalid_input = 3;

class Batch : public CommandLine {
 protected:
  std::string folder(const std::string& name) const {
    std::filesystem::create_directories(file(name));
    return file(name);
  }

  std::string character(const std::string& name, std::size_t frames = 31) const {
    std::filesystem::create_directories(std::filesystem::path(file(name)).parent_path());
    write_bytes(file(name), TinyGlb(frames).bytes());
    return file(name);
  }

  /// What `arguments` say as JSON; the exit code is checked.
  Json report(std::vector<std::string> arguments, int exit_code = 0) const {
    arguments.insert(arguments.end(), {"--json", "--tolerance", "1%"});
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    return Json::parse(result.out);
  }

  /// Paths below the folder, files only.
  std::set<std::string> all_files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
      if (entry.is_regular_file()) names.insert(std::filesystem::relative(entry.path(), folder_.path()).string());
    return names;
  }
};

TEST_F(Batch, ManyFilesGoIntoAFolderUnderTheirNames) {
  const std::string a = character("in/a.glb"), b = character("in/b.glb", 61);
  run_well({"decode", a, file("in/c.gltf"), "--quiet"});
  const Json json = report({a, b, file("in/c.gltf"), "-o", file("new/out")});
  EXPECT_EQ(json["exit_code"], 0);
  ASSERT_EQ(json["files"].size(), 3U);
  EXPECT_EQ(json["totals"]["compressed_files"], 3);
  EXPECT_EQ(json["totals"]["animations"], 3);
  std::size_t bytes = 0;
  for (const Json& one : json["files"]) {
    EXPECT_EQ(one["status"], "compressed");
    bytes += one["report"]["totals"]["bytes_after"].get<std::size_t>();
  }
  EXPECT_EQ(json["totals"]["bytes_after"], bytes);
  for (const char* name : {"a.glb", "b.glb", "c.gltf"})
    run_well({"verify", file(std::string("in/") + name), file(std::string("new/out/") + name), "--tolerance", "1%"});
  // The same bytes as one at a time.
  run_well({a, file("alone.glb"), "--tolerance", "1%", "-q"});
  EXPECT_EQ(read_bytes(file("alone.glb")), read_bytes(file("new/out/a.glb")));
}

TEST_F(Batch, OneFileMayBeNamedByTheOption) {
  const std::string in = character("in.glb");
  const Json json = report({in, "--output", file("out.glb")});
  EXPECT_EQ(json["output"], file("out.glb"));
  EXPECT_EQ(json["animations"].size(), 1U);
  run_well({in, "-o", folder("sub.glb"), "-q"});  // a folder is a folder whatever its name
  EXPECT_TRUE(std::filesystem::exists(file("sub.glb/in.glb")));
}

TEST_F(Batch, ABadFileDoesNotStopTheOthers) {
  const std::string a = character("a.glb"), b = character("b.glb");
  write_text(file("broken.glb"), "no GLB");
  const ProcessResult result = run({a, file("broken.glb"), file("absent.glb"), b, "-o", file("out")});
  EXPECT_EQ(result.exit_code, invalid_input);  // worse than the absent file's 2
  EXPECT_THAT(result.err, HasSubstr("broken.glb"));
  EXPECT_THAT(result.err, HasSubstr("absent.glb"));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 2) << result.err;
  EXPECT_THAT(result.out, HasSubstr("4 files: 2 compressed, 2 failed"));
  EXPECT_TRUE(std::filesystem::exists(file("out/a.glb")));
  EXPECT_TRUE(std::filesystem::exists(file("out/b.glb")));
  EXPECT_FALSE(std::filesystem::exists(file("out/broken.glb")));

  const Json json = report({a, file("absent.glb"), "-o", file("out")}, cannot_access);
  EXPECT_EQ(json["exit_code"], cannot_access);
  EXPECT_EQ(json["totals"]["failed"], 1);
  EXPECT_EQ(json["files"][1]["status"], "failed");
  EXPECT_EQ(json["files"][1]["exit_code"], cannot_access);
  EXPECT_THAT(json["files"][1]["error"].get<std::string>(), HasSubstr("absent.glb"));
}

TEST_F(Batch, WhatCannotBeIsRefused) {
  const std::string a = input("a.glb", TinyGlb(5).bytes());
  const std::string b = input("b.glb", TinyGlb(5).bytes());
  expect_failure({a, b, file("c.glb")}, usage, {"c.glb", "-o"});
  expect_failure({a, b, "-o", file("c.glb")}, usage, {"c.glb", "2 inputs", "folder"});
  expect_failure({a, a, "-o", file("out")}, usage, {"a.glb", "same name"});
  expect_failure({a, file("deeper/a.glb"), "-o", file("out")}, usage, {"deeper/a.glb", "same name"});
  expect_failure({"-o", file("out")}, usage, {"IN"});
  expect_failure({a, file("b.bvh"), "-o", file("out")}, usage, {"b.bvh", ".glb"});
  expect_failure({a, "-o", file("out"), "--report", file("r.html")}, usage, {"--report", "one file"});
  expect_failure({a, "-o", a + "/out"}, cannot_access, {"out", "folder"});
}

TEST_F(Batch, AnExcludedNameNeedNotBeInEveryFile) {
  const std::string a = character("a.glb");
  TinyGlb other(31);
  other.json["animations"][0]["name"] = "idle";
  write_bytes(file("b.glb"), other.bytes());
  const Json json = report({a, file("b.glb"), "-o", file("out"), "--exclude", "wave"});
  EXPECT_EQ(json["files"][0]["report"]["totals"]["compressed"], 0);
  EXPECT_EQ(json["files"][1]["report"]["totals"]["compressed"], 1);
  EXPECT_THAT(json["files"][1]["report"]["notes"].dump(), HasSubstr("wave"));
}

TEST_F(Batch, TheCacheGivesTheSameBytesWithoutWork) {
  const std::string a = character("a.glb"), b = character("b.glb", 61);
  const std::string cache = file("cache");
  EXPECT_EQ(report({a, b, "-o", file("one"), "--cache", cache})["totals"]["from_cache"], 0);
  const Json again = report({a, b, "-o", file("two"), "--cache", cache, "--threads", "1"});
  EXPECT_EQ(again["totals"]["from_cache"], 2);
  EXPECT_EQ(again["files"][0]["report"]["output"], file("two/a.glb"));
  for (const char* name : {"/a.glb", "/b.glb"})
    EXPECT_EQ(read_bytes(file("one") + name), read_bytes(file("two") + name));
  // One file under another name is the same content.
  const Json single = report({a, file("c.glb"), "--cache", cache});
  EXPECT_EQ(single["from_cache"], true);
  EXPECT_EQ(read_bytes(file("c.glb")), read_bytes(file("one/a.glb")));
  EXPECT_THAT(run_well({a, file("c.glb"), "--cache", cache, "--tolerance", "1%"}).out, HasSubstr("from the cache"));
}

TEST_F(Batch, TheCacheKnowsWhatTheBytesDependOn) {
  const std::string a = character("a.glb");
  const std::string cache = file("cache");
  const auto from_cache = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{a, file("out.glb"), "--cache", cache, "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return Json::parse(run_well(arguments).out)["from_cache"].get<bool>();
  };
  EXPECT_FALSE(from_cache({}));
  EXPECT_TRUE(from_cache({}));
  for (const std::vector<std::string>& options : std::vector<std::vector<std::string>>{{"--tolerance", "1%"},
                                                                                       {"--effort", "1"},
                                                                                       {"--optional"},
                                                                                       {"--fallback"},
                                                                                       {"--explain"},
                                                                                       {"--exclude", "wave"}}) {
    EXPECT_FALSE(from_cache(options)) << options[0];
    EXPECT_TRUE(from_cache(options)) << options[0];
  }
  character("a.glb", 32);  // another content under the same name
  EXPECT_FALSE(from_cache({}));
}

TEST_F(Batch, EveryFileKeepsWhatWasTried) {
  const std::string a = character("in/a.glb"), b = character("in/b.glb", 61);
  const Json made = report({a, b, "-o", file("out"), "--explain", "--cache", file("cache")});
  EXPECT_EQ(made["totals"]["compressed_files"], 2);
  const auto search = [&](const std::string& path) {
    return Json::parse(run_well({"inspect", path, "--json"}).out)["clip_sets"][0]["clips"][0]["search"];
  };
  for (const char* name : {"out/a.glb", "out/b.glb"}) EXPECT_FALSE(search(file(name))["tried"].empty()) << name;
  const Bytes first = read_bytes(file("out/a.glb"));
  std::filesystem::remove(file("out/a.glb"));
  EXPECT_EQ(report({a, b, "-o", file("out"), "--explain", "--cache", file("cache")})["totals"]["from_cache"], 2);
  EXPECT_EQ(read_bytes(file("out/a.glb")), first);
}

TEST_F(Batch, TheCacheKnowsBuffersInOtherFiles) {
  run_well({"decode", character("a.glb"), file("a.gltf"), "-q"});
  const std::string cache = file("cache");
  EXPECT_EQ(report({file("a.gltf"), file("out.gltf"), "--cache", cache})["from_cache"], false);
  EXPECT_EQ(report({file("a.gltf"), file("out.gltf"), "--cache", cache})["from_cache"], true);
  Bytes bin = read_bytes(file("a.bin"));
  bin[bin.size() - 9] ^= 1;  // in a key of the animation
  write_bytes(file("a.bin"), bin);
  EXPECT_EQ(report({file("a.gltf"), file("out.gltf"), "--cache", cache})["from_cache"], false);
}

TEST_F(Batch, ADamagedEntryIsNoticedAndMadeAgain) {
  const std::string a = character("a.glb");
  report({a, "-o", folder("out"), "--cache", file("cache")});
  const Bytes good = read_bytes(file("out/a.glb"));
  std::string entry;
  for (const std::string& name : all_files())
    if (name.starts_with("cache/")) entry = file(name);
  ASSERT_NE(entry, "");
  const Bytes whole = read_bytes(entry);
  for (const std::size_t at : {std::size_t{0}, std::size_t{12}, whole.size() / 2, whole.size() - 1}) {
    Bytes damaged = whole;
    damaged[at] ^= 0x40;
    write_bytes(entry, damaged);
    const Json json = report({a, "-o", file("out"), "--cache", file("cache")});
    EXPECT_EQ(json["files"][0]["status"], "compressed");
    EXPECT_EQ(json["files"][0]["cache_entry_damaged"], true);
    EXPECT_EQ(read_bytes(file("out/a.glb")), good);
    EXPECT_EQ(report({a, "-o", file("out"), "--cache", file("cache")})["totals"]["from_cache"], 1);
  }
  for (const std::size_t length : {std::size_t{0}, std::size_t{5}, whole.size() - 1}) {
    write_bytes(entry, Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)));
    const ProcessResult told = run_well({a, "-o", file("out"), "--cache", file("cache"), "--tolerance", "1%"});
    EXPECT_THAT(told.out, HasSubstr("1 damaged"));
  }
}

TEST_F(Batch, APageOfACachedResultTellsTheSame) {
  const std::string a = character("a.glb");
  report({a, file("b.glb"), "--cache", file("cache"), "--report", file("first.html")});
  EXPECT_EQ(report({a, file("b.glb"), "--cache", file("cache"), "--report", file("second.html")})["from_cache"], true);
  // Only the time differs.
  EXPECT_NEAR(static_cast<double>(read_bytes(file("first.html")).size()),
              static_cast<double>(read_bytes(file("second.html")).size()), 100);
}

TEST_F(Batch, ACacheThatIsNoFolderIsRefused) {
  const std::string in = input("in.glb", TinyGlb(5).bytes());
  expect_failure({in, file("out.glb"), "--cache", in}, cannot_access, {"in.glb", "folder"});
}

TEST_F(Batch, ADryRunWritesNothing) {
  const std::string a = character("a.glb"), b = character("b.glb", 32);
  report({a, "-o", file("out"), "--cache", file("cache")});
  write_text(file("broken.glb"), "no GLB");
  const std::set<std::string> before = all_files();
  const Json json =
      report({a, b, file("broken.glb"), "-o", file("new"), "--cache", file("cache"), "--dry-run"}, invalid_input);
  EXPECT_EQ(json["dry_run"], true);
  EXPECT_EQ(json["files"][0]["status"], "would_take_cache");
  EXPECT_EQ(json["files"][1]["status"], "would_compress");
  EXPECT_EQ(json["files"][1]["animations"], 1);
  EXPECT_EQ(json["files"][2]["status"], "failed");
  const ProcessResult told = run_well({a, b, "-o", file("new"), "--dry-run", "--cache", file("no-cache")});
  EXPECT_THAT(told.out, HasSubstr("would compress 1 animations: " + b + " -> " + file("new/b.glb")));
  EXPECT_THAT(told.out, HasSubstr("nothing was written"));
  EXPECT_THAT(run_well({a, file("one.glb"), "--dry-run"}).out, HasSubstr("would compress"));
  EXPECT_EQ(all_files(), before);
  EXPECT_FALSE(std::filesystem::exists(file("new")));
  EXPECT_FALSE(std::filesystem::exists(file("no-cache")));
}

TEST_F(Batch, QuietSaysNothing) {
  EXPECT_EQ(run_well({character("a.glb"), "-o", file("out"), "-q", "--tolerance", "1%"}).out, "");
}

}  // namespace
}  // namespace nmc::test
