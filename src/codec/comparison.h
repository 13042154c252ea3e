// A file and what was made of it, side by side, as a viewer needs them: skeleton, motions, streams, and error over
// time.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/animation.h"
#include "codec/compress.h"
#include "gltf/cost.h"
#include "gltf/edit.h"
#include "gltf/triangles.h"
#include "motion/error.h"
#include "motion/skeleton.h"

namespace nmc::codec {

/// The error of one point over time.
struct PointTrace {
  int node = -1;              ///< the node with the largest influence on the point
  std::vector<double> error;  ///< world units, one per time of the clip's profile
};

/// One animation of both files.
struct ComparedClip {
  int animation = 0;  ///< index in the original
  std::string name;
  Animation original;
  Animation other;    ///< what a player shows of the other file
  Animation beside;   ///< of these the curves that are core channels there, not decoded ones
  int clip_set = -1;  ///< where the other file has it compressed: its clip set and clip, else -1
  int clip = -1;
  motion::ErrorProfile profile;       ///< at every key and between
  std::vector<Candidate> candidates;  ///< what the encoder tried, where the caller knows
  std::vector<PointTrace> worst;      ///< the points that are worst at some time, of different nodes, worst first
};

struct Comparison {
  motion::Skeleton skeleton;
  double size = 1;                           ///< the character's, in world units
  std::optional<gltf::Triangles> triangles;  ///< of the original, where they are few enough to be drawn in a page
  gltf::ByteParts before, after;
  std::vector<gltf::ClipSetBytes> clip_sets;  ///< of the other file
  std::vector<ComparedClip> clips;            ///< the animations of the original that have curves
};

/// Reads both files and measures how they differ, at every joint and vertex. `bytes_before` and `bytes_after`: the
/// sizes of the whole files. Throws Error (invalid_input) as `verify` does.
Comparison compare(const gltf::Document& original, const gltf::Document& other, std::size_t bytes_before,
                   std::size_t bytes_after, int threads = 0);

}  // namespace nmc::codec
