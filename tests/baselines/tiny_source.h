// A small animated file as the methods see it.
#pragma once

#include "codec/source.h"
#include "gltf/document.h"
#include "support/tiny_glb.h"

namespace nmc::test {

/// `tolerance`: share of size that the clip is sampled for.
inline codec::Source tiny_source(double tolerance = 0.001) {
  codec::CompressOptions options;
  options.tolerance.value = tolerance;
  return codec::read_source(gltf::parse_document(TinyGlb().bytes(), "tiny.glb", "."), options);
}

}  // namespace nmc::test
