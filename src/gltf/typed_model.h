// A document as tinygltf's typed model, with everything that is read unpacked and checked beforehand.
#pragma once

#include <tiny_gltf.h>

#include "gltf/document.h"

namespace nmc::gltf {

/// Which bytes the model holds.
enum class Contents {
  animation,  ///< animation inputs and outputs, inverse bind matrices
  meshes,     ///< inverse bind matrices, POSITION, JOINTS_n and WEIGHTS_n of meshes, POSITION of morph targets
  drawing,    ///< as meshes, and the indices and modes of primitives that Draco has not packed
};

/// Validates the document and gives it to tinygltf as a prepared copy: only nodes, meshes, skins, animations, accessors
/// and views, one buffer, no extension left. tinygltf refuses or misreads much that is legal (placeholder buffers,
/// views packed by meshopt or Draco, channels without a node, images it cannot decode), and trusts much that is not;
/// the copy has none of that. Nodes, meshes, skins, accessors and animations have the file's numbers. Attributes that
/// are not read are left out, accessors outside `contents` are placeholders of one zero. Channels: those with a node,
/// in the file's order; `channel_numbers` has their places. Throws Error as `validate`, and invalid_input or
/// unsupported for packed data.
struct TypedModel {
  tinygltf::Model model;
  std::vector<std::vector<int>> channel_numbers;  ///< per animation: the file's number of each channel of the model
};

TypedModel typed_model(const Document& document, Contents contents);

}  // namespace nmc::gltf
