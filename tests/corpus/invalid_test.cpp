// The validator's own test files: each is refused with a sentence that names the object, or passes with what is wrong
// in it untouched; none crashes or hangs.
#include <gmock/gmock.h>

#include <cstring>
#include <fstream>
#include <set>

#include "corpus/shared_corpus.h"

namespace nmc::test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What the validator calls errors and does not concern animation: such files pass.
const std::set<std::string> elsewhere{
    "BUFFER_DATA_URI_MIME_TYPE_INVALID",
    "BUFFER_VIEW_TARGET_OVERRIDE",
    "DUPLICATE_ELEMENTS",
    "MESH_PRIMITIVE_ACCESSOR_UNALIGNED",
    "MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE",
    "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_UNSIGNED_INT",
    "MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT",
    "MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE",
    "MESH_PRIMITIVE_INVALID_ATTRIBUTE",
    "MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS",
    "MESH_PRIMITIVE_TOO_FEW_TEXCOORDS",
    "TYPE_MISMATCH",
    "UNDECLARED_EXTENSION",
    "UNRESOLVED_REFERENCE",
    "UNSATISFIED_DEPENDENCY",
    "UNUSED_EXTENSION_REQUIRED",
};

/// What the last three of those are about when the file passes.
const std::set<std::string> places_elsewhere{
    "materials",          "textures",   "images", "samplers", "cameras", "extensionsUsed",
    "extensionsRequired", "extensions", "meshes", "nodes",    "buffers"};

struct Verdict {
  int errors = 0;
  std::set<std::string> codes;
  std::set<std::string> places;  ///< first segments of the JSON pointers
};

Verdict verdict_of(const std::string& file) {
  Verdict verdict;
  const Json report = Json::parse(std::ifstream(file + ".report.json"));
  verdict.errors = report["issues"]["numErrors"];
  for (const Json& message : report["issues"]["messages"]) {
    if (message["severity"] != 0) continue;
    verdict.codes.insert(message["code"]);
    const std::string pointer = message.value("pointer", std::string());
    if (pointer.size() > 1) verdict.places.insert(pointer.substr(1, pointer.find('/', 1) - 1));
  }
  return verdict;
}

/// The JSON of a file of either container, without what a new place of the same buffers changes.
Json json_of(const std::string& file) {
  Bytes bytes = read_bytes(file);
  if (file.ends_with(".glb")) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, sizeof length);
    bytes = Bytes(bytes.begin() + 20, bytes.begin() + 20 + length);
  }
  Json json = Json::parse(bytes);
  if (json.contains("buffers")) {
    for (Json& buffer : json["buffers"]) buffer.erase("uri");
  }
  return json;
}

class InvalidFiles : public testing::Test {
 protected:
  void SetUp() override {
    files_ = corpus_files("invalid");
    if (files_.empty()) GTEST_SKIP() << "needs " << NMC_SHARED_DIR << "/data/invalid";
  }

  ProcessResult compress(const std::string& in, const std::string& out) const {
    const ProcessResult result =
        run_process({std::string(NMC_BUILD_DIR) + "/gltf-nmc", in, out, "--quiet"}, std::chrono::seconds(10));
    EXPECT_FALSE(result.timed_out);
    return result;
  }

  void expect_refusal(const std::string& in, const ProcessResult& result, const Verdict& verdict) const {
    EXPECT_THAT(result.exit_code, testing::AnyOf(2, 3, 4)) << result.err;
    EXPECT_THAT(result.err, testing::StartsWith("gltf-nmc: "));
    EXPECT_THAT(result.err, testing::HasSubstr(fs::path(in).stem().string()));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    if (result.exit_code == 3 && verdict.errors == 0) ADD_FAILURE() << "the validator finds it valid: " << result.err;
    // What is refused for other reasons, and text that is no JSON of numbers that exist, has no object to be named.
    if (result.exit_code != 3 || verdict.places.empty() || result.err.find("the JSON holds") != std::string::npos)
      return;
    const bool names_one = std::any_of(verdict.places.begin(), verdict.places.end(), [&](const std::string& place) {
      return result.err.find(place) != std::string::npos;
    });
    EXPECT_TRUE(names_one) << result.err << testing::PrintToString(verdict.places);
  }

  std::vector<std::string> files_;
  ScratchFolder folder_;
};

TEST_F(InvalidFiles, AreRefusedWithTheObjectOrPassUntouched) {
  int refused = 0, passed = 0;
  for (const std::string& in : files_) {
    if (!fs::exists(in + ".report.json")) continue;
    SCOPED_TRACE(in);
    const Verdict verdict = verdict_of(in);
    const std::string out = folder_.file("out" + fs::path(in).extension().string());
    const ProcessResult result = compress(in, out);
    if (result.exit_code != 0) {
      ++refused;
      expect_refusal(in, result, verdict);
      EXPECT_TRUE(folder_.names().empty());
      continue;
    }
    ++passed;
    for (const std::string& code : verdict.codes) EXPECT_TRUE(elsewhere.contains(code)) << code;
    for (const std::string& place : verdict.places) EXPECT_TRUE(places_elsewhere.contains(place)) << place;
    EXPECT_EQ(json_of(out), json_of(in));
    for (const std::string& name : folder_.names()) fs::remove(folder_.file(name));
  }
  EXPECT_GT(refused, 50);
  EXPECT_GT(passed, 40);
}

}  // namespace
}  // namespace nmc::test
