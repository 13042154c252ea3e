// The two edits of a document: animations out of core glTF into the extension, and back.
#pragma once

#include <compare>
#include <string>
#include <vector>

#include "base/animation.h"
#include "gltf/document.h"

namespace nmc::gltf {

inline constexpr const char* extension_name = "NMC_animation_compression";

/// A target of a clip set: which node property a stream target moves.
struct Target {
  int node = -1;
  Path path = Path::translation;

  auto operator<=>(const Target&) const = default;
};

/// A stream of the codec with the node properties that its targets move.
struct ClipSetBytes {
  std::vector<Target> targets;
  Bytes stream;
  Json extras{};  ///< of the clip set's object; null for none
};

/// What to take out of one animation and where it went.
struct TakenAnimation {
  int animation = 0;
  std::vector<int> channels;  ///< indices in animation.channels that the clip replaces
  int clip_set = 0;
  int clip = 0;             ///< clip within the set
  float start_seconds = 0;  ///< first and last key time over all channels of the animation as it was
  float end_seconds = 0;
  Json extras{};               ///< of the animation's extension object; null for none
  std::vector<int> resting{};  ///< indices in animation.channels that nothing needs to replace
};

enum class Requirement {
  required,  ///< listed in extensionsRequired
  optional,  ///< readers without the extension show the model standing still
  fallback,  ///< the original keys stay in the file as well; the root extension then says "fallback": true
};

struct CompressionEdit {
  std::vector<ClipSetBytes> clip_sets;
  std::vector<TakenAnimation> taken;
  Requirement requirement = Requirement::required;
  Json extras{};  ///< of the root's extension object; null for none
};

/// Puts clip sets into the document and takes the replaced channels out, with samplers, accessors, bufferViews and
/// bytes that nothing else uses (DESIGN: the file). An animation that loses all channels keeps one, its stub: two keys
/// that hold a node at its rest value from start_seconds to end_seconds. Its extension object then says "stub": true,
/// which means that channels[0] is no motion of the file's. Stubs share accessors. Changes nothing where `taken` is
/// empty. Returns notes for the user (for example that unknown extensions kept indices from being renumbered). Throws
/// Error: invalid_input for a document that is compressed already, has references or ranges that do not fit;
/// unsupported for a GLB without a buffer that could take the streams; internal for an edit that does not fit the
/// document. After an error the document is of no use.
std::vector<std::string> apply_compression(Document& document, const CompressionEdit& edit);

/// A clip as found in a compressed document.
struct CompressedAnimation {
  int animation = 0;
  int clip_set = 0;
  int clip = 0;
  Json extras{};  ///< as found: anything; null for none
};

struct CompressedContent {
  std::vector<ClipSetBytes> clip_sets;
  std::vector<CompressedAnimation> animations;
  Requirement requirement = Requirement::required;
  Json extras{};  ///< as found: anything; null for none
};

/// The extension's content, checked (indices, bufferViews, node targets). Empty where the document does not use the
/// extension. Throws Error: invalid_input naming the object, unsupported for a newer version.
CompressedContent read_compression(const Document& document);

/// Replaces the extension by core channels: decoded[i] are the curves of animation animations[i] in read_compression's
/// order. They follow the channels that the animation has. Curves with the same times share one input accessor. Stub
/// channels and the extension leave the file. With the fallback's original keys in place the original keys are kept,
/// the extension is dropped and `decoded` is not looked at. Throws Error: invalid_input where a curve moves what a
/// channel moves too, internal where curves are missing or incomplete.
void remove_compression(Document& document, const CompressedContent& content, const std::vector<Animation>& decoded);

}  // namespace nmc::gltf
