#include "corpus/compatibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <vector>

#include "base/error.h"
#include "codec/compress.h"

namespace nmc::test {
namespace {

constexpr const char* introduction =
    "# What glTF files may hold, and what becomes of it\n"
    "\n"
    "Each row is a small file that the tests make and compress with the default tolerance. What is compressed keeps "
    "the "
    "tolerance;\nwhat stays as keys plays bit for bit as before. This page is the output of "
    "`build/make_compatibility`, and "
    "a test\ncompares the two.\n"
    "\n"
    "| feature | the test's file | treatment |\n"
    "| --- | --- | --- |\n";

constexpr const char* closing =
    "\n"
    "\"Stays as keys\" means in the file's own accessors, in the same animation. Everything that is not animation "
    "stays as "
    "it is in\nevery row: the same JSON values and the same bytes.\n";

std::size_t stubs(const gltf::Json& animation) {
  const auto extensions = animation.find("extensions");
  if (extensions == animation.end() || !extensions->contains(gltf::extension_name)) return 0;
  return (*extensions)[gltf::extension_name].value("stub", false) ? 1 : 0;
}

/// "a", "a and b", "a, b and c", each once, in order of appearance.
std::string joined(const std::vector<std::string>& clauses) {
  std::vector<std::string> once;
  for (const std::string& clause : clauses) {
    if (std::find(once.begin(), once.end(), clause) == once.end()) once.push_back(clause);
  }
  std::string text;
  for (std::size_t i = 0; i < once.size(); ++i) text += (i == 0 ? "" : i + 1 == once.size() ? " and " : ", ") + once[i];
  return text;
}

std::string describe(const gltf::Document& before, const codec::CompressResult& result) {
  std::size_t all = 0, left = 0;
  std::vector<std::string> reasons;
  const gltf::Asset asset = gltf::read_asset(before);
  for (const codec::ClipResult& clip : result.clips) {
    const auto index = static_cast<std::size_t>(clip.animation);
    const gltf::Json& after = result.document.json["animations"][index];
    all += before.json["animations"][index]["channels"].size();
    left += after["channels"].size() - stubs(after);
    if (clip.outcome != codec::Outcome::compressed) {
      reasons.push_back(clip.reason);
    } else if (after["channels"].size() > stubs(after)) {
      for (const gltf::UntouchedChannel& channel : asset.animations[index].untouched) reasons.push_back(channel.reason);
    }
  }
  std::string text;
  if (all == 0) return "written as it is";
  if (left == 0) {
    text = "compressed";
  } else if (left == all) {
    text = fmt::format("stays as keys: {}", joined(reasons));
  } else {
    text = fmt::format("{} of {} channels compressed; the rest stays as keys: {}", all - left, all, joined(reasons));
  }
  for (const std::string& note : result.notes) text += "; note: " + note;
  return text;
}

}  // namespace

std::string treatment(const Feature& feature) {
  try {
    const gltf::Document document = gltf::parse_document(feature.make(), "file.glb", {});
    codec::CompressOptions options;
    options.effort = 1;
    return describe(document, codec::compress(document, options));
  } catch (const Error& error) {
    return fmt::format("refused: {}", error.what());
  }
}

std::string compatibility_page() {
  std::string page = introduction;
  for (const Feature& feature : features())
    page += fmt::format("| {} | {} | {} |\n", feature.name, feature.example, treatment(feature));
  return page + closing;
}

}  // namespace nmc::test
