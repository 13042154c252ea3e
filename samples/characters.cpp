// The list of sample files and how each is put together.
#include "samples/characters.h"

#include <stdexcept>

#include "samples/export.h"
#include "samples/humanoid.h"
#include "samples/props.h"
#include "samples/quadruped.h"

namespace nmc::samples {
namespace {

std::vector<std::uint8_t> make_humanoid(RestStyle style, double frames_per_second,
                                        const std::vector<std::string>& clip_names, const ExportOptions& options) {
  const Rig rig = humanoid_rig(style);
  std::vector<PoseClip> clips;
  for (const std::string& name : clip_names) clips.push_back(humanoid_clip(rig, name, frames_per_second));
  return export_character(rig, humanoid_mesh(rig), clips, options);
}

std::vector<std::uint8_t> make_quadruped() {
  const Rig rig = quadruped_rig(RestStyle::along_bone);
  std::vector<PoseClip> clips;
  for (const std::string& name : quadruped_clip_names()) clips.push_back(quadruped_clip(rig, name, 30.0));
  return export_character(rig, quadruped_mesh(rig), clips, {"Quadruped", false, true});
}

struct Recipe {
  CharacterInfo info;
  std::vector<std::uint8_t> (*make)();
};

const std::vector<Recipe>& recipes() {
  static const std::vector<Recipe> all = {
      {{"humanoid_30hz.glb", "human figure, 52 joints, all clips at 30 Hz"},
       [] {
         return make_humanoid(RestStyle::along_bone, 30.0, humanoid_clip_names(), {"Humanoid", false, false});
       }},
      {{"humanoid_120hz.glb", "human figure, longer clips at 120 Hz, one with noise as from motion capture"},
       [] {
         return make_humanoid(RestStyle::along_bone, 120.0, {"walk", "run_root_motion", "idle", "mocap_sequence"},
                              {"Humanoid", false, true});
       }},
      {{"humanoid_all_channels.glb",
        "rest rotations near half turns; translation, rotation and scale channels on all joints"},
       [] {
         return make_humanoid(RestStyle::half_turn, 30.0, {"walk", "run_root_motion", "wave", "spin"},
                              {"Humanoid", true, false});
       }},
      {{"quadruped_30hz.glb", "dog, 38 joints, walk, trot, gallop, idle, jump"}, make_quadruped},
      {{"props.glb", "nodes without skin, morph weights, spline and step samplers, extras, an image"}, make_props},
      {{"unknown_extension.glb", "a fan, and an extension that nobody knows"}, make_unknown_extension},
  };
  return all;
}

}  // namespace

std::vector<CharacterInfo> list_characters() {
  std::vector<CharacterInfo> result;
  for (const Recipe& recipe : recipes()) result.push_back(recipe.info);
  return result;
}

std::vector<std::uint8_t> make_character(std::string_view file_name) {
  for (const Recipe& recipe : recipes()) {
    if (recipe.info.file_name == file_name) return recipe.make();
  }
  throw std::invalid_argument("there is no sample character named " + std::string(file_name));
}

}  // namespace nmc::samples
