// The edits over real files: nothing but animation changes, and taking the extension out again leaves none of it.
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "gltf/edit.h"
#include "support/fake_compression.h"
#include "support/passthrough.h"
#include "support/sanitized.h"
#include "support/shared_files.h"

namespace nmc::gltf {
namespace {

namespace fs = std::filesystem;
using test::make_fake_edit;
using test::passthrough_difference;
using test::stub_channels;

/// With sanitizers each byte costs ten times as much, and the small files have every kind of content too.
constexpr std::uintmax_t most_file_bytes = test::sanitized ? 200'000 : std::numeric_limits<std::uintmax_t>::max();

/// A two-key curve for each channel that the fake edit took.
std::vector<Animation> fake_decoded(const Document& original, const CompressionEdit& edit) {
  std::vector<Animation> decoded;
  for (const auto& taken : edit.taken) {
    Animation animation;
    for (const int channel : taken.channels) {
      const Json& target = original.json["animations"][static_cast<std::size_t>(taken.animation)]["channels"]
                                        [static_cast<std::size_t>(channel)]["target"];
      Curve curve;
      curve.node = target["node"];
      for (const auto& known : edit.clip_sets[static_cast<std::size_t>(taken.clip_set)].targets) {
        const std::array<const char*, 4> names = {"translation", "rotation", "scale", "weights"};
        if (known.node == curve.node && names.at(static_cast<std::size_t>(known.path)) == target["path"])
          curve.path = known.path;
      }
      curve.width = curve.path == Path::rotation ? 4 : curve.path == Path::weights ? 1 : 3;
      curve.times = {taken.start_seconds, taken.start_seconds + 1 + static_cast<float>(channel % 2)};
      curve.values.assign(curve.times.size() * static_cast<std::size_t>(curve.width), 0.5F);
      animation.curves.push_back(curve);
    }
    decoded.push_back(animation);
  }
  return decoded;
}

/// Channels at the end of each animation that remove_compression wrote.
test::TakenChannels added_channels(const Document& document, const CompressionEdit& edit) {
  test::TakenChannels added;
  for (const auto& taken : edit.taken) {
    const auto animation = static_cast<std::size_t>(taken.animation);
    const std::size_t count = document.json["animations"][animation]["channels"].size();
    for (std::size_t i = 0; i < taken.channels.size(); ++i) added[animation].insert(count - 1 - i);
  }
  return added;
}

/// The whole JSON and all bytes, but for an empty extensions object and bytes behind the last bufferView.
void expect_as_before(const Document& original, const Document& edited) {
  Json before = original.json, after = edited.json;
  test::Resolver::drop_extension(before);
  for (auto* json : {&before, &after}) {
    for (auto& buffer : (*json)["buffers"]) buffer.erase("byteLength");
  }
  EXPECT_TRUE(before.dump() == after.dump());
  ASSERT_EQ(original.buffers.size(), edited.buffers.size());
  for (std::size_t i = 0; i < original.buffers.size(); ++i) {
    const Bytes& bytes = edited.buffers[i];
    ASSERT_LE(bytes.size(), original.buffers[i].size());
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), original.buffers[i].begin()));
  }
}

class EditCorpus : public testing::TestWithParam<std::tuple<Requirement, double>> {};

TEST_P(EditCorpus, ChangesNothingButAnimation) {
  const auto files = test::shared_files(most_file_bytes);
  if (files.empty()) GTEST_SKIP() << "no shared data";
  const auto [requirement, share] = GetParam();
  unsigned seed = 1;
  for (const auto& file : files) {
    SCOPED_TRACE(file.string());
    const Document original = read_document(file);
    const auto fake = make_fake_edit(original, requirement, share, ++seed);
    Document edited = original;
    apply_compression(edited, fake.edit);
    EXPECT_EQ(passthrough_difference(original, edited, fake.taken, stub_channels(edited)), "");
    if (fake.edit.taken.empty()) {
      EXPECT_EQ(edited.json.dump(), original.json.dump());
      continue;
    }

    const Document reread = parse_document(to_glb(edited), "reread.glb", original.folder);
    const auto content = read_compression(reread);
    EXPECT_EQ(content.requirement, requirement);
    ASSERT_EQ(content.clip_sets.size(), fake.edit.clip_sets.size());
    for (std::size_t i = 0; i < content.clip_sets.size(); ++i) {
      EXPECT_EQ(content.clip_sets[i].stream, fake.edit.clip_sets[i].stream);
      EXPECT_EQ(content.clip_sets[i].targets, fake.edit.clip_sets[i].targets);
    }
    ASSERT_EQ(content.animations.size(), fake.edit.taken.size());
    for (std::size_t i = 0; i < content.animations.size(); ++i) {
      EXPECT_EQ(content.animations[i].animation, fake.edit.taken[i].animation);
      EXPECT_EQ(content.animations[i].clip_set, fake.edit.taken[i].clip_set);
      EXPECT_EQ(content.animations[i].clip, fake.edit.taken[i].clip);
    }

    remove_compression(edited, content, fake_decoded(original, fake.edit));
    EXPECT_EQ(edited.json.dump().find(extension_name), std::string::npos);
    const bool restored = requirement != Requirement::fallback;
    EXPECT_EQ(passthrough_difference(original, edited, fake.taken,
                                     restored ? added_channels(edited, fake.edit) : test::TakenChannels()),
              "");
    if (!restored) expect_as_before(original, edited);
    EXPECT_NO_THROW(to_glb(edited));
  }
}

INSTANTIATE_TEST_SUITE_P(All, EditCorpus,
                         testing::Combine(testing::Values(Requirement::required, Requirement::optional,
                                                          Requirement::fallback),
                                          testing::Values(1.0, 0.5)));

}  // namespace
}  // namespace nmc::gltf
