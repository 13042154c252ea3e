#include "rate_dct.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "baselines/dct.h"
#include "codec/source.h"
#include "gltf/edit.h"
#include "rate_codec.h"
#include "rate_process.h"
#include "rate_reference.h"

namespace nmc::bench {
namespace {

using namespace nmc::codec;

gltf::CompressionEdit make_edit(const Source& source, const std::vector<EncodedSet>& sets) {
  gltf::CompressionEdit edit;
  for (const EncodedSet& set : sets) {
    gltf::ClipSetBytes bytes;
    bytes.stream = set.stream;
    for (const NodeTarget& target : set.targets) bytes.targets.push_back({target.node, target.path});
    for (std::size_t i = 0; i < set.clips.size(); ++i) {
      const ClipSource& clip = source.clips[set.clips[i]];
      edit.taken.push_back({clip.animation, clip.channels, static_cast<int>(edit.clip_sets.size()), static_cast<int>(i),
                            clip.clip.times.front(), clip.clip.times.back()});
    }
    edit.clip_sets.push_back(std::move(bytes));
  }
  std::sort(edit.taken.begin(), edit.taken.end(),
            [](const auto& a, const auto& b) { return a.animation < b.animation; });
  return edit;
}

}  // namespace

Measurement measure_dct(const std::filesystem::path& path, const CompressOptions& options) {
  gltf::Document document = gltf::read_document(path);
  const auto start = std::chrono::steady_clock::now();
  const Source source = read_source(document, options);
  const gltf::CompressionEdit edit = make_edit(source, baselines::encode_dct(source, options.threads));
  gltf::apply_compression(document, edit);
  Measurement row;
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  row.peak_bytes = peak_resident_bytes();
  row.method = "DCT, one step a clip";
  row.reached = true;
  if (const std::size_t missed = source.clips.size() - edit.taken.size())
    row.note = fmt::format("not reached on {} of {} clips, which stay as keys", missed, source.clips.size());
  measure_result(Reference(path), document, row);
  return row;
}

}  // namespace nmc::bench
