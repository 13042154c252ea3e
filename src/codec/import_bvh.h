// Motion capture as a glTF document that viewers show: nodes, a skin over all joints, bones as a mesh, one animation.
#pragma once

#include "gltf/document.h"
#include "motion/bvh.h"

namespace nmc::codec {

/// Builds the document (a GLB in memory). Node i of the document is node i of the skeleton; one node for the mesh
/// follows. The bind pose is the rest pose. Throws Error (unsupported) beyond 65,536 joints.
gltf::Document import_bvh(const motion::BvhClip& bvh);

}  // namespace nmc::codec
