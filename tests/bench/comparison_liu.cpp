// Liu and McMillan 2006: tables 2 and 3.
#include <fmt/format.h>

#include "baselines/marker_pca.h"
#include "comparison_measures.h"

namespace nmc::bench {

void print_liu(const std::vector<std::filesystem::path>& files) {
  using baselines::MarkerPcaKind;
  // The paper's bounds: 30 mm, feet 10 mm, key frames 10 mm, normalisation markers 1 mm.
  const baselines::MarkerPcaSettings settings{0.03, 0.01, 0.01, 0.001};
  fmt::print(
      "\n## Liu and McMillan 2006\n\nTables 2 and 3, with the paper's bounds\n\n"
      "| sequence | frames | method | segments | axes | key frames | ratio | d, % | ms/frame, encoding | decoding |\n"
      "| --- | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n");
  for (const std::filesystem::path& path : files) {
    const auto source = read_motion(path);
    for (const auto& [kind, name] :
         {std::pair(MarkerPcaKind::global, "global PCA"), std::pair(MarkerPcaKind::piecewise, "piecewise PCA"),
          std::pair(MarkerPcaKind::segment, "segments and key frames")}) {
      const double start = thread_seconds();
      const baselines::MarkerPcaEncoder encoder(*source, kind);
      baselines::MarkerPcaCounts counts;
      const baselines::Bytes bytes = encoder.encode(settings, &counts);
      const double encoded = thread_seconds();
      const std::vector<motion::Clip> decoded = baselines::decode_marker_pca(bytes, source->skeleton);
      const double done = thread_seconds();
      const baselines::MotionData data = baselines::motion_data(*source);
      const baselines::MarkerRig rig =
          baselines::make_marker_rig(source->skeleton, data.head, baselines::MarkerSet::compact, source->size);
      const auto frames = static_cast<double>(frame_count(*source));
      fmt::print("| {} | {} | {} | {} | {:.1f} | {} | {:.1f} | {:.1f} | {:.2f} | {:.2f} |\n", path.stem().string(),
                 frame_count(*source), name, counts.segments, counts.mean_axes,
                 kind == MarkerPcaKind::segment ? std::to_string(counts.key_frames) : "",
                 4 * rig.marker_rows() * frames / static_cast<double>(bytes.size()),
                 measure_as_papers(*source, decoded).distortion_percent, 1000 * (encoded - start) / frames,
                 1000 * (done - encoded) / frames);
      std::fflush(stdout);
    }
  }
}

}  // namespace nmc::bench
