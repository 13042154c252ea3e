// play FILE.glb [ANIMATION [POSES]]: loads a compressed file with tinygltf and plays an animation as a table, one line
// a pose. Nothing of gltf-nmc but its decoder for C is used.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define NMC_DECODE_IMPLEMENTATION
#include <nmc_decode.h>
#include <tiny_gltf.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

const std::string extension = "NMC_animation_compression";

tinygltf::Model load(const std::string& path) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader([](tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
  tinygltf::Model model;
  std::string error, warning;
  if (!loader.LoadBinaryFromFile(&model, &error, &warning, path)) throw std::runtime_error(error);
  return model;
}

/// The member of a JSON object; throws where there is none.
const tinygltf::Value& member(const tinygltf::Value& object, const std::string& key) {
  if (!object.IsObject() || !object.Has(key)) throw std::runtime_error("the file has no " + key);
  return object.Get(key);
}

std::size_t index_of(const tinygltf::Value& object, const std::string& key, std::size_t count) {
  const tinygltf::Value& value = member(object, key);
  const int index = value.IsInt() ? value.Get<int>() : -1;
  if (index < 0 || static_cast<std::size_t>(index) >= count) throw std::runtime_error("the file has a wrong " + key);
  return static_cast<std::size_t>(index);
}

/// A stream in memory, ready to be evaluated.
class Clips {
 public:
  Clips(const unsigned char* bytes, std::size_t size) {
    nmc_info info;
    check(nmc_read_info(bytes, size, &info));
    workspace_.resize(info.workspace_bytes / 8 + 1);
    check(nmc_open(&set_, bytes, size, workspace_.data(), workspace_.size() * 8));
    scratch_.resize(info.scratch_bytes / 8 + 1);
    pose_.resize(info.slots);
  }

  const nmc_set& set() const { return set_; }

  const std::vector<float>& pose(std::uint32_t clip, double seconds) {
    check(nmc_evaluate(&set_, clip, seconds, NMC_LOOP, pose_.data(), scratch_.data()));
    return pose_;
  }

 private:
  static void check(nmc_result result) {
    if (result != NMC_OK) throw std::runtime_error(nmc_message(result));
  }

  std::vector<std::uint64_t> workspace_, scratch_;
  std::vector<float> pose_;
  nmc_set set_{};
};

Clips open_clips(const tinygltf::Model& model, const tinygltf::Value& clip_set) {
  const tinygltf::BufferView& view = model.bufferViews[index_of(clip_set, "bufferView", model.bufferViews.size())];
  const std::vector<unsigned char>& data = model.buffers.at(static_cast<std::size_t>(view.buffer)).data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
    throw std::runtime_error("a bufferView is not inside its buffer");
  return Clips(data.data() + view.byteOffset, view.byteLength);
}

/// "node.path" of each of the stream's targets, in its order.
std::vector<std::string> target_names(const tinygltf::Model& model, const tinygltf::Value& clip_set) {
  std::vector<std::string> names;
  const tinygltf::Value& targets = member(clip_set, "targets");
  for (std::size_t t = 0; t < targets.ArrayLen(); ++t) {
    const tinygltf::Value& group = targets.Get(static_cast<int>(t));
    const tinygltf::Value& nodes = member(group, "nodes");
    for (std::size_t n = 0; n < nodes.ArrayLen(); ++n) {
      const auto node = static_cast<std::size_t>(nodes.Get(static_cast<int>(n)).Get<int>());
      names.push_back(model.nodes.at(node).name + "." + member(group, "path").Get<std::string>());
    }
  }
  return names;
}

void print_table(Clips& clips, std::uint32_t clip, const std::vector<std::string>& names, int poses) {
  const nmc_set& set = clips.set();
  std::vector<std::uint32_t> moving;
  for (std::uint32_t t = 0; t < set.info.targets && t < names.size(); ++t)
    if (nmc_state(&set, clip, t) >= NMC_MOVING) moving.push_back(t);
  std::printf("seconds");
  for (const std::uint32_t t : moving) std::printf("\t%s", names[t].c_str());
  std::printf("\n");
  const float* times = nmc_times(&set, clip);
  const double first = times[0], last = times[set.clips[clip].samples - 1];
  for (int i = 0; i < poses; ++i) {
    const double seconds = poses > 1 ? first + (last - first) * i / poses : first;
    const std::vector<float>& pose = clips.pose(clip, seconds);
    std::printf("%.3f", seconds);
    for (const std::uint32_t t : moving)
      for (std::uint32_t a = 0; a < set.targets[t].width; ++a)
        std::printf("%s%.5f", a == 0 ? "\t" : " ", static_cast<double>(pose[set.targets[t].offset + a]));
    std::printf("\n");
  }
}

void play(const std::string& path, std::size_t animation, int poses) {
  const tinygltf::Model model = load(path);
  if (animation >= model.animations.size()) throw std::runtime_error("the file has no such animation");
  const auto found = model.animations[animation].extensions.find(extension);
  if (found == model.animations[animation].extensions.end())
    throw std::runtime_error("the animation is not compressed");
  const auto root = model.extensions.find(extension);
  if (root == model.extensions.end()) throw std::runtime_error("the file has no clip sets");
  const tinygltf::Value& sets = member(root->second, "clipSets");
  const tinygltf::Value& clip_set = sets.Get(static_cast<int>(index_of(found->second, "clipSet", sets.ArrayLen())));
  Clips clips = open_clips(model, clip_set);
  const std::size_t clip = index_of(found->second, "clip", clips.set().info.clips);
  std::printf("%s\n", model.animations[animation].name.c_str());
  print_table(clips, static_cast<std::uint32_t>(clip), target_names(model, clip_set), poses);
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) {
    std::fprintf(stderr, "usage: play FILE.glb [ANIMATION [POSES]]\n");
    return 1;
  }
  try {
    const auto animation = static_cast<std::size_t>(count > 2 ? std::strtoul(arguments[2], nullptr, 10) : 0);
    play(arguments[1], animation, count > 3 ? std::atoi(arguments[3]) : 20);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", arguments[1], error.what());
    return 2;
  }
}
