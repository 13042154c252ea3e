// Says what is inside the clip sets of a compressed document.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "codec/compress.h"
#include "codec/decoded_set.h"
#include "codec/reference_codec.h"
#include "codec/search_record.h"

namespace nmc::codec {
namespace {

std::string model_of(const nmc_set& set) {
  if (set.has_network)
    return "Fourier feature network, " + std::to_string(set.info.hidden0) + " and " + std::to_string(set.info.hidden1) +
           " hidden units, " + (set.quantized_network ? "quantised weights" : "float32 weights");
  return "sparse Fourier layer with quantised weights";
}

InspectedClip clip_of(const nmc_set& set, std::uint32_t index) {
  const nmc_clip& clip = set.clips[index];
  InspectedClip made;
  made.frames = clip.samples;
  made.basis = basis_name(static_cast<Basis>(clip.basis));
  made.corrections = clip.atoms;
  const float* times = nmc_times(&set, index);
  made.duration_seconds = static_cast<double>(times[clip.samples - 1]) - times[0];
  for (std::uint32_t k = 0; k < clip.frequencies; ++k)
    made.frequencies.push_back(static_cast<int>(set.dense[clip.first_dense + k]));
  if (set.has_network)
    made.nonzero_weights =
        static_cast<std::size_t>(std::count_if(set.dense, set.dense + set.info.dense, [](float w) { return w != 0; }));
  for (std::uint32_t w = 0; w < clip.windows; ++w) {
    const nmc_window& window = set.windows[clip.first_window + w];
    made.nonzero_weights += window.weights;
    if (!set.has_network) made.frequencies.push_back(static_cast<int>(window.features));
  }
  return made;
}

std::vector<InspectedPart> parts_of(const PartBits& bits) {
  std::vector<InspectedPart> parts;
  const std::pair<const char*, double> all[] = {
      {"header", bits.header},   {"references", bits.references}, {"times", bits.times}, {"states", bits.states},
      {"anchors", bits.anchors}, {"weights", bits.weights},       {"atoms", bits.atoms}, {"network", bits.network}};
  for (const auto& [name, count] : all) parts.push_back({name, static_cast<std::size_t>(std::lround(count))});
  return parts;
}

}  // namespace

std::vector<InspectedSet> inspect(const gltf::Document& document) {
  const gltf::CompressedContent content = gltf::read_compression(document);
  std::vector<InspectedSet> sets;
  for (std::size_t s = 0; s < content.clip_sets.size(); ++s) {
    const DecodedSet decoded(content.clip_sets[s].stream, document.name + ": clipSets[" + std::to_string(s) + "]");
    InspectedSet set;
    set.stream_bytes = content.clip_sets[s].stream.size();
    set.targets = decoded.target_count();
    set.model = model_of(decoded.raw());
    set.parts = parts_of(decoded.bits());
    set.poses = read_poses(content.clip_sets[s].extras);
    for (const gltf::CompressedAnimation& animation : content.animations) {
      if (static_cast<std::size_t>(animation.clip_set) != s ||
          static_cast<std::size_t>(animation.clip) >= decoded.clip_count())
        continue;
      set.clips.push_back(clip_of(decoded.raw(), static_cast<std::uint32_t>(animation.clip)));
      set.clips.back().animation = animation.animation;
      set.clips.back().search = read_search(animation.extras);
      set.clips.back().name = document.json.at("animations")
                                  .at(static_cast<std::size_t>(animation.animation))
                                  .value("name", fmt::format("#{}", animation.animation));
    }
    sets.push_back(std::move(set));
  }
  return sets;
}

std::vector<KeptRecord> inspect_kept(const gltf::Document& document) {
  return read_kept(gltf::read_compression(document).extras);
}

}  // namespace nmc::codec
