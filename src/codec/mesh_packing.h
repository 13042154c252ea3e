// Meshes packed with Draco beside compressed animations: the error bound holds over both together.
#pragma once

#include "codec/compress.h"
#include "gltf/draco_write.h"

namespace nmc::codec {

/// The part of the tolerance that meshes may use up; compress gets the rest when the meshes are to be packed as well.
inline constexpr double mesh_share = 0.1;

/// Packs the meshes of result.document, the outcome of compressing `original` with a tolerance that was 1 - mesh_share
/// of what the user accepts; result.tolerance becomes that whole. Positions and weights are rounded so finely that, at
/// every key of every animation, no vertex is farther than mesh_share of the tolerance from where the old mesh has it.
/// Adds notes. Throws Error as the readers do.
void pack_meshes(const gltf::Document& original, const gltf::DracoBits& bits, CompressResult& result);

}  // namespace nmc::codec
