// A rigged, skinned, animated character as a GLB file.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "samples/rig.h"
#include "samples/shape.h"

namespace nmc::samples {

/// A clip: poses at the key times (first_frame + i) / frames_per_second.
struct PoseClip {
  std::string name;
  double frames_per_second = 30.0;
  int first_frame = 0;
  std::vector<Pose> poses;
};

/// How the file is laid out.
struct ExportOptions {
  std::string name;  ///< of the armature and the mesh
  bool all_channels =
      false;  ///< translation, rotation and scale of every joint, constant or not, as many exporters write
  bool small_weights =
      false;  ///< skin weights as normalized bytes with 16-bit joint indices; else floats with 8-bit indices
};

/// The GLB bytes. Clips use LINEAR interpolation; the root has a translation channel, every joint a rotation channel.
std::vector<std::uint8_t> export_character(const Rig& rig, const SkinMesh& mesh, const std::vector<PoseClip>& clips,
                                           const ExportOptions& options);

}  // namespace nmc::samples
