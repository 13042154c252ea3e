// Real files, really compressed: every JSON value outside of animation and every byte of images, meshes and skins
// stays.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "base/error.h"
#include "compressed_document.h"
#include "samples/characters.h"
#include "support/shared_files.h"

namespace nmc::test {
namespace {

namespace fs = std::filesystem;
using codec::CompressOptions;
using codec::Profile;

CompressOptions quick(Profile profile) {
  CompressOptions options;
  options.profile = profile;
  options.effort = 1;
  options.max_frequencies = 1;
  options.tolerance.value = profile == Profile::paper ? 0.5 : 0.02;
  return options;
}

/// Compresses, compares, expands, compares again. Returns how many animations were taken.
int expect_untouched(const Document& original, const CompressOptions& options) {
  SCOPED_TRACE(original.name);
  const codec::CompressResult result = codec::compress(original, options);
  EXPECT_EQ(untouched_difference(original, result, options.requirement), "");
  const Document reread = gltf::parse_document(gltf::to_glb(result.document), "reread.glb", original.folder);
  const Json before = outside_of_animations(original);
  const Json after = outside_of_animations(codec::expand(reread));
  for (auto member = before.begin(); member != before.end(); ++member)
    EXPECT_EQ(after.value(member.key(), Json()).dump(), member.value().dump()) << member.key() << " after expanding";
  return static_cast<int>(std::count_if(result.clips.begin(), result.clips.end(), [](const codec::ClipResult& clip) {
    return clip.outcome == codec::Outcome::compressed;
  }));
}

void expect_all_untouched(std::uintmax_t most_bytes, const CompressOptions& options) {
  const std::vector<fs::path> files = shared_files(most_bytes);
  if (files.empty()) GTEST_SKIP() << "needs " << NMC_SHARED_DIR << "/data";
  int taken = 0;
  for (const fs::path& file : files) taken += expect_untouched(gltf::read_document(file), options);
  EXPECT_GE(taken, 10) << "of " << files.size() << " files";
}

TEST(Passthrough, SmallSharedFiles) { expect_all_untouched(205000, quick(Profile::standard)); }

TEST(Passthrough, SmallSharedFilesByThePaper) { expect_all_untouched(110000, quick(Profile::paper)); }

TEST(Passthrough, SmallSharedFilesWithFallback) {
  CompressOptions options = quick(Profile::paper);
  options.requirement = gltf::Requirement::fallback;
  expect_all_untouched(70000, options);
}

TEST(Passthrough, Samples) {
  for (const samples::CharacterInfo& character : samples::list_characters()) {
    const std::vector<std::uint8_t> bytes = samples::make_character(character.file_name);
    if (bytes.size() > 1000000) continue;
    EXPECT_GE(expect_untouched(gltf::parse_document(bytes, character.file_name, {}), quick(Profile::paper)), 1);
  }
}

}  // namespace
}  // namespace nmc::test
