// Any text as motion capture: a sentence, or a clip that makes a document that can be read.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "base/error.h"
#include "codec/import_bvh.h"
#include "fuzz/require.h"
#include "gltf/asset.h"
#include "gltf/document.h"
#include "motion/bvh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace nmc;
  motion::BvhClip bvh;
  try {
    bvh = motion::parse_bvh({reinterpret_cast<const char*>(data), size}, "fuzz.bvh");
  } catch (const Error& error) {
    fuzz::require(error.code() != ErrorCode::internal, error.what());
    return 0;
  }
  if (bvh.clip.times.size() * bvh.skeleton.size() > 100000) return 0;
  gltf::Document document;
  try {
    document = codec::import_bvh(bvh);
  } catch (const Error& error) {
    fuzz::require(error.code() != ErrorCode::internal, error.what());
    return 0;
  }
  const gltf::Asset asset = gltf::read_asset(gltf::parse_document(gltf::to_glb(document), "fuzz.glb", {}));
  fuzz::require(asset.animations.size() == 1, "an imported file has one animation");
  return 0;
}
