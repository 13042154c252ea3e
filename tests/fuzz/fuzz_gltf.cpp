// Any bytes as a glTF file: a sentence, or a document that comes back from its own GLB as it was and whose skins,
// meshes and animations can be read.
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/error.h"
#include "fuzz/require.h"
#include "gltf/asset.h"
#include "gltf/cost.h"
#include "gltf/document.h"
#include "gltf/edit.h"

namespace {

using namespace nmc;

/// Runs what may refuse the input, but not as a defect. Returns whether it went through.
template <typename Work>
bool allowed(const Work& work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    fuzz::require(error.code() != ErrorCode::internal, error.what());
    return false;
  }
}

void check(const gltf::Document& document) {
  gltf::Asset asset;
  if (!allowed([&] { asset = gltf::read_asset(document); })) return;
  if (!allowed([&] { gltf::skin_points(document, asset); })) return;
  allowed([&] { gltf::animation_costs(document); });
  allowed([&] { gltf::read_compression(document); });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  gltf::Document document;
  // The folder does not exist: no URI leads anywhere.
  const std::filesystem::path nowhere = "/nonexistent";
  if (!allowed([&] { document = gltf::parse_document({data, size}, "fuzz.gltf", nowhere); })) return 0;
  check(document);
  gltf::Bytes glb;
  if (!allowed([&] { glb = gltf::to_glb(document); })) return 0;
  gltf::Document again;
  if (!allowed([&] { again = gltf::parse_document(glb, "again.glb", nowhere); })) return 0;
  fuzz::require(gltf::to_glb(again) == glb, "a written file is read and written as it is");
  return 0;
}
