// The typed view of a document: nodes, skins and animations with their data read, checked and unpacked. Read-only.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/animation.h"
#include "base/points.h"
#include "gltf/document.h"

namespace nmc::gltf {

struct Node {
  std::string name;
  int parent = -1;
  std::vector<int> children;
  bool has_matrix = false;
  std::array<double, 16> matrix{};  ///< column-major, when has_matrix
  std::array<double, 3> translation{0, 0, 0};
  std::array<double, 4> rotation{0, 0, 0, 1};  ///< x, y, z, w
  std::array<double, 3> scale{1, 1, 1};
  int mesh = -1;
  int skin = -1;
  std::vector<double> weights;  ///< rest morph weights: the node's, else its mesh's, else zeros
};

struct Skin {
  std::vector<int> joints;
  std::vector<std::array<double, 16>> inverse_bind;  ///< one per joint, column-major; identity where the file has none
};

/// A channel that can be read as a curve of a node.
struct Channel {
  int channel = 0;  ///< index in animation.channels
  int sampler = 0;  ///< index in animation.samplers
  Curve curve;
};

/// A channel that stays in the file as it is, and why (one clause for the report).
struct UntouchedChannel {
  int channel = 0;
  std::string reason;
  Curve curve;  ///< what it does, where it is a node's curve all the same (STEP); its node is -1 elsewhere
};

struct AnimationSource {
  std::string name;  ///< the file's name for it, else "#<index>"
  std::vector<Channel> channels;
  std::vector<UntouchedChannel> untouched;
};

struct Asset {
  std::vector<Node> nodes;  ///< numbered as in the file
  std::vector<int> order;   ///< all nodes, parents before children
  std::vector<Skin> skins;
  std::vector<AnimationSource> animations;  ///< one per animation of the file, in its order
};

/// Reads and checks everything that animation needs. tinygltf gives the typed model; where the document holds what
/// tinygltf cannot express (extension channels, unknown values) the document wins and that part stays untouched. Throws
/// Error (invalid_input) naming the object: a range outside its buffer, a cycle of nodes, times that do not increase, a
/// number that is not finite, a count that does not fit.
Asset read_asset(const Document& document);

/// The points at which the character's error is seen (DESIGN: error): the origins of all skin joints, and for each
/// joint the extreme vertices that it moves; without a skin, the animated nodes, those below them, and the vertices of
/// their meshes. `all_vertices`: every vertex instead of the extreme ones (for a final check). Draco- and
/// meshopt-compressed and quantised meshes are read.
Points skin_points(const Document& document, const Asset& asset, bool all_vertices = false);

}  // namespace nmc::gltf
