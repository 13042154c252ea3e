// A document's animations made ready for the codec: skeleton, points, and each animation's channels as a clip.
#pragma once

#include <string>
#include <vector>

#include "base/animation.h"
#include "base/points.h"
#include "codec/bound.h"
#include "codec/compress.h"
#include "gltf/asset.h"
#include "motion/clip.h"
#include "motion/skeleton.h"

namespace nmc::codec {

/// One animation of the file, as far as the codec takes it.
struct ClipSource {
  int animation = 0;
  std::string name;
  std::vector<int> channels;  ///< indices in animation.channels that the clip replaces
  std::vector<int> resting;   ///< indices of those that need no clip (codec/resting.h)
  Animation original;         ///< all readable curves, also those that stay
  Animation kept;             ///< the curves that stay in the file beside the clip
  motion::Clip clip;          ///< the taken curves on a common time grid
  std::size_t bound = 0;      ///< index into Source::bounds
};

struct Source {
  motion::Skeleton skeleton;
  Points points;                    ///< joints and extreme vertices
  Points joint_points;              ///< joints alone (the paper's error); the same as `points` where there is no skin
  Points all_points;                ///< joints and every vertex, for the last check
  double size = 1;                  ///< world units
  double tolerance = 0;             ///< world units, where no rule makes an exception
  std::vector<Bound> bounds;        ///< those that the clips have
  std::vector<ClipSource> clips;    ///< one per animation of the file that has something to take
  std::vector<ClipResult> results;  ///< one per animation of the file, filled as far as known before coding
};

/// Reads and samples. Throws Error as gltf::read_asset does.
Source read_source(const gltf::Document& document, const CompressOptions& options);

/// The same source with one tolerance (world units) for everything.
Source with_tolerance(Source source, double tolerance);

/// The points of a bound, scaled to its tolerance: extreme vertices, and every one.
const Points& points_of(const Source& source, const Bound& bound);
const Points& all_points_of(const Source& source, const Bound& bound);

/// A sentence for each pattern of the options that fits no clip, or no joint, of the source.
std::vector<std::string> unused_patterns(const Source& source, const CompressOptions& options);

/// A decoded clip of `source` with the curves that stay beside it: what a player shows.
Animation with_kept(const ClipSource& source, const motion::Clip& decoded);

/// A target of a clip set with the node it moves.
struct NodeTarget {
  int node = -1;
  Path path = Path::translation;
  int width = 3;
};

/// The targets of some clips: all properties that one of them animates, path by path, parents before children.
std::vector<NodeTarget> common_targets(const motion::Skeleton& skeleton, const std::vector<const motion::Clip*>& clips);

/// The track of a clip for a target, or null.
const motion::Track* find_track(const motion::Clip& clip, const NodeTarget& target);

/// A stream made by a profile: the targets it moves and the clips (indices into Source::clips) it holds.
struct EncodedSet {
  std::vector<NodeTarget> targets;
  std::vector<std::uint8_t> stream;
  std::vector<std::size_t> clips;
  std::vector<int> frequencies;                    ///< per clip: the most that one pose uses
  std::vector<double> seconds;                     ///< per clip: time spent
  std::vector<std::vector<Candidate>> candidates;  ///< per clip: what was tried, as far as recorded
  std::vector<PoseRecord> poses{};                 ///< how coarsely poses were tried to be written
};

/// The nodes of a set's targets.
std::vector<int> nodes_of(const EncodedSet& set);

/// What takes the clips of these sets out of the file's channels and puts the sets in; readers need the extension.
gltf::CompressionEdit compression_edit(const Source& source, const std::vector<EncodedSet>& sets);

}  // namespace nmc::codec
