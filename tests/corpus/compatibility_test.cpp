// Every feature of animations in a made file: compressed within the tolerance or left alone, valid, the same on any
// number of threads, and as docs/compatibility.md says.
#include "corpus/compatibility.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>

#include "base/error.h"
#include "codec/compress.h"
#include "corpus/shared_corpus.h"
#include "gltf/document.h"
#include "support/sanitized.h"

namespace nmc::test {
namespace {

using Json = nlohmann::ordered_json;

codec::CompressOptions quick(int threads = 0) {
  codec::CompressOptions options;
  options.effort = 1;
  options.threads = threads;
  return options;
}

gltf::Document document_of(const Feature& feature) { return gltf::parse_document(feature.make(), "file.glb", {}); }

bool is_refused(const Feature& feature) { return treatment(feature).starts_with("refused"); }

/// The page is the truth of an optimised build: where rounding decides what is smaller, it may differ in others.
TEST(Compatibility, ThePageSaysWhatHappens) {
  if (sanitized) GTEST_SKIP() << "the page is of optimised builds";
  const Bytes page = read_bytes(std::string(NMC_SOURCE_DIR) + "/docs/compatibility.md");
  EXPECT_EQ(std::string(page.begin(), page.end()), compatibility_page())
      << "build/make_compatibility > docs/compatibility.md";
}

TEST(Compatibility, EveryFeatureKeepsTheTolerance) {
  for (const Feature& feature : features()) {
    SCOPED_TRACE(feature.name);
    if (is_refused(feature)) continue;
    const gltf::Document document = document_of(feature);
    const codec::CompressResult result = codec::compress(document, quick());
    const gltf::Document packed = gltf::parse_document(gltf::to_glb(result.document), "packed.glb", {});
    const codec::Verification verified = codec::verify(document, codec::expand(packed));
    for (const codec::VerifiedClip& clip : verified.clips) EXPECT_LE(clip.error.max, result.tolerance) << clip.name;
  }
}

TEST(Compatibility, TheBytesAreTheSameOnAnyNumberOfThreadsAndAgain) {
  for (const Feature& feature : features()) {
    SCOPED_TRACE(feature.name);
    if (is_refused(feature)) continue;
    const gltf::Document document = document_of(feature);
    const gltf::Bytes once = gltf::to_glb(codec::compress(document, quick(1)).document);
    for (const int threads : {1, 2, 8})
      EXPECT_EQ(gltf::to_glb(codec::compress(document, quick(threads)).document), once) << threads << " threads";
  }
}

class CompatibilityFiles : public testing::Test {
 protected:
  /// The features' files, compressed and decoded again: {original, packed, plain}.
  std::vector<std::array<std::string, 3>> write_all() {
    std::vector<std::array<std::string, 3>> groups;
    for (const Feature& feature : features()) {
      if (is_refused(feature)) continue;
      const std::string number = std::to_string(groups.size());
      std::array<std::string, 3> group{folder_.file(number + ".glb"), folder_.file(number + "-packed.glb"),
                                       folder_.file(number + "-plain.glb")};
      const gltf::Document document = document_of(feature);
      const codec::CompressResult result = codec::compress(document, quick());
      write_bytes(group[0], feature.make());
      gltf::write_document(result.document, group[1]);
      gltf::write_document(codec::expand(result.document), group[2]);
      groups.push_back(group);
      results_.push_back(result);
      names_.push_back(feature.name);
    }
    return groups;
  }

  ScratchFolder folder_;
  std::vector<codec::CompressResult> results_;
  std::vector<std::string> names_;
};

TEST_F(CompatibilityFiles, AreNotWorseInTheEyesOfTheValidator) {
  if (!has_validator()) GTEST_SKIP() << "needs gltf-validator: run npm ci in tests/";
  const auto groups = write_all();
  std::vector<std::string> files;
  for (const auto& group : groups) files.insert(files.end(), group.begin(), group.end());
  const Json verdict = validate(files);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const auto& [in, packed, plain] = groups[i];
    SCOPED_TRACE(names_[i]);
    for (const std::string& file : {packed, plain}) {
      EXPECT_LE(verdict[file]["numErrors"], verdict[in]["numErrors"]) << verdict[file].dump(1);
      EXPECT_LE(verdict[file]["numWarnings"], verdict[in]["numWarnings"]) << verdict[file].dump(1);
    }
  }
}

TEST_F(CompatibilityFiles, KeepTheToleranceInTheEyesOfTheReferee) {
  if (!has_referee()) GTEST_SKIP() << "needs " << referee() << " and numpy";
  if (sanitized) GTEST_SKIP() << "what it measures does not depend on the build";
  const auto groups = write_all();
  int measured = 0;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    SCOPED_TRACE(names_[i]);
    const ProcessResult result = run_process({"/usr/bin/python3", referee(), groups[i][0], groups[i][2], "--json"});
    if (result.exit_code == 2) continue;  // such as meshopt, which it does not read
    ASSERT_EQ(result.exit_code, 0) << result.out << result.err;
    ++measured;
    for (const Json& animation : Json::parse(result.out)["animations"]) {
      for (const char* kind : {"joint", "vertex", "rigid", "node"}) {
        if (!animation["errors"].contains(kind) || animation["errors"][kind].is_null()) continue;
        EXPECT_LE(animation["errors"][kind]["max"].get<double>(), 1.001 * results_[i].tolerance) << kind;
      }
    }
  }
  EXPECT_GT(measured, 30);
}

}  // namespace
}  // namespace nmc::test
