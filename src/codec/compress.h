// The whole job on a document in memory: animations of glTF into clip sets and back, with the error bound measured on
// the real bytes.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/progress.h"
#include "codec/parts.h"
#include "codec/rules.h"
#include "gltf/asset.h"
#include "gltf/document.h"
#include "gltf/edit.h"
#include "motion/error.h"
#include "motion/skeleton.h"

namespace nmc::codec {

enum class Profile {
  standard,  ///< the smallest bytes that keep the tolerance on joints and skin
  paper,     ///< Tojo, Chen and Umetani 2022 as published: float32 weights, Algorithm 1, the tolerance on joints alone
};

struct CompressOptions {
  Profile profile = Profile::standard;
  Tolerance tolerance;
  std::vector<ToleranceRule> rules;  ///< standard profile: exceptions from it; the last that names a point counts
  std::vector<Selector> keep;        ///< channels that stay as they are
  bool exact_ends = false;           ///< standard profile: first and last pose within a hundredth of the tolerance
  bool keep_resting = false;         ///< standard profile: channels that change nothing in any animation stay in clips
  int max_frequencies = 40;          ///< paper profile: the largest K of Algorithm 1
  double contact_weight = 3;         ///< standard profile: how often the error of points that stand still counts
  int effort = 5;                    ///< standard profile: 1 (fast) to 9 (thorough)
  double time_limit_seconds = 0;     ///< 0: none
  int threads = 0;                   ///< 0: all
  gltf::Requirement requirement = gltf::Requirement::required;
  std::vector<std::string> exclude;  ///< names of animations that stay as they are
  bool record_candidates = false;    ///< measure and tell what was tried; the bytes stay the same
  bool explain = false;              ///< keep a summary of the search in the document; the streams stay the same
  Progress progress;
  Parts parts{};  ///< standard profile: what a measurement leaves out
};

/// What became of one animation.
enum class Outcome {
  compressed,
  kept_over_tolerance,   ///< the profile did not reach the tolerance within its limits
  kept_larger,           ///< it would have become larger than it was
  kept_nothing_to_take,  ///< no channel that the codec takes, or excluded by the user
};

/// Something that the search for a clip's smallest bytes has tried.
struct Candidate {
  std::size_t bytes = 0;  ///< of the clip alone; by an excerpt of a long clip, in proportion
  double error = 0;       ///< the largest, world units, at every key and between, over all points
  bool kept = false;      ///< corrected, and within the tolerance
  bool chosen = false;
  std::string basis{};  ///< "cosine", "periodic" or "sine"; profile paper: "network"
  bool jumps = false;   ///< the clip's jumps were taken out before training
};

struct ClipResult {
  int animation = 0;
  std::string name;
  Outcome outcome = Outcome::kept_nothing_to_take;
  std::string reason;      ///< a clause for the table where the outcome is not `compressed`
  std::size_t frames = 0;  ///< samples of the clip
  std::size_t joints = 0;  ///< nodes that the clip animates
  double duration_seconds = 0;
  std::size_t keys_before = 0;  ///< bytes of unique key data; shared data is split evenly among its users
  std::size_t json_before = 0;  ///< bytes of minified JSON of the animation, its accessors and bufferViews
  std::size_t keys_after = 0;
  std::size_t json_after = 0;
  int frequencies = 0;                ///< largest number of frequencies that a pose uses
  motion::ErrorReport error;          ///< of the decoded bytes against the original; zero where the animation is kept
  double tolerance = 0;               ///< world units; of the points of which no rule says another
  double finest_tolerance = 0;        ///< world units; the smallest of any point
  double share_of_tolerance = 0;      ///< the largest error of a point in units of that point's tolerance
  double seconds = 0;                 ///< time spent on it
  std::vector<Candidate> candidates;  ///< in the order of the search; where CompressOptions asks for them
};

struct CompressResult {
  gltf::Document document;
  std::vector<ClipResult> clips;   ///< one per animation, in the file's order
  std::vector<std::string> notes;  ///< sentences for the user
  double size = 1;                 ///< the character's size in world units
  double tolerance = 0;            ///< in world units
};

/// Compresses the animations of a document. Throws Error as the readers do.
CompressResult compress(const gltf::Document& document, const CompressOptions& options);

/// Decodes the extension back to core channels. Returns the new document; one without the extension comes back as it
/// is.
gltf::Document expand(const gltf::Document& document);

/// The skeleton of a read asset.
motion::Skeleton make_skeleton(const gltf::Asset& asset);

/// All animations of a document as curves, compressed ones decoded; channels that are no node curves are left out.
std::vector<Animation> all_animations(const gltf::Document& document, const gltf::Asset& asset);

/// The comparison of two files, animation by animation (matched by name, else by index).
struct VerifiedClip {
  std::string name;
  motion::ErrorReport error;
  double tolerance = 0;                 ///< as ClipResult's
  double finest_tolerance = 0;          ///< as ClipResult's
  double share_of_tolerance = 0;        ///< the largest error of a point in units of that point's tolerance
  double joint_share_of_tolerance = 0;  ///< ErrorReport.max_joint in units of the clip's tolerance
};
struct Verification {
  double size = 1;
  double tolerance = 0;  ///< in world units, where no rule makes an exception
  std::vector<VerifiedClip> clips;
};
/// Throws Error (invalid_input) when the documents have different nodes or animations.
Verification verify(const gltf::Document& original, const gltf::Document& other, const Tolerance& tolerance = {},
                    std::span<const ToleranceRule> rules = {});

/// The smallest of all candidates of one kind.
struct TriedKind {
  std::string basis;          ///< as Candidate's
  bool jumps = false;         ///< as Candidate's
  std::size_t bytes = 0;      ///< of the clip alone
  bool within_bound = false;  ///< otherwise the bytes are those at which it was given up
};

/// What was tried for one animation.
struct SearchRecord {
  std::vector<TriedKind> tried;               ///< those within the bound first, then by bytes: the first was taken
  std::size_t key_bytes = 0, json_bytes = 0;  ///< of the animation before
};

/// What was tried for the poses that a clip set writes out.
struct PoseRecord {
  int coarser = 0;            ///< steps are 2^(coarser / 4) of the usual ones
  std::size_t bytes = 0;      ///< of the whole stream
  bool within_bound = false;  ///< as many clips as with the usual steps are
};

/// An animation that stays as it was.
struct KeptRecord {
  int animation = 0;
  std::string reason;
  SearchRecord search;
};

/// What is inside a compressed document.
struct InspectedClip {
  int animation = 0;
  std::string name;
  std::size_t frames = 0;
  double duration_seconds = 0;
  std::vector<int> frequencies;  ///< half cycles per clip (paper profile) or the highest used index of each window
  std::size_t nonzero_weights = 0;
  std::string basis;                     ///< "cosine", "periodic" or "sine" (gltf_ext/README.md, A.6)
  std::size_t corrections = 0;           ///< atoms
  std::optional<SearchRecord> search{};  ///< where the file has it
};
struct InspectedPart {
  std::string name;  ///< "header", "references", "times", "network", "weights", ...
  std::size_t bits = 0;
};
struct InspectedSet {
  std::size_t stream_bytes = 0;
  std::size_t targets = 0;
  std::string model;  ///< one line: what kind of model and why it was chosen
  std::vector<InspectedPart> parts;
  std::vector<InspectedClip> clips;
  std::vector<PoseRecord> poses;  ///< where the file has them
};
std::vector<InspectedSet> inspect(const gltf::Document& document);

/// The animations of which a compressed document says why they are not in a clip set.
std::vector<KeptRecord> inspect_kept(const gltf::Document& document);

}  // namespace nmc::codec
