#include "rate_dct.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "codec/clip_search.h"
#include "codec/set_steps.h"
#include "codec/source.h"
#include "codec/standard_profile.h"
#include "gltf/edit.h"
#include "rate_codec.h"
#include "rate_process.h"
#include "rate_reference.h"

namespace nmc::bench {
namespace {

using namespace nmc::codec;

constexpr int coarsest = -24, finest = 40;  // step exponents, quarters of an octave
constexpr int look_back = 3;                // coarser exponents tried below the bisection's result

/// Finds one clip's levels.
class ClipTransform {
 public:
  ClipTransform(const SearchContext& context, std::size_t index)
      : context_(context),
        clip_(context.source.clips[index]),
        prepared_(prepare_clip(context, index, 1)),
        map_(context.source.skeleton, context.frame, prepared_.layout, context.source.points, prepared_.coded) {}

  /// None where the finest step is not within the tolerance.
  std::optional<LevelClip> coarsest_within_bound() {
    std::optional<LevelClip> best = within_bound(finest);
    if (!best) return best;
    int low = coarsest, high = finest;  // high is within the bound
    while (low < high) {
      const int middle = low + (high - low) / 2;
      if (auto found = within_bound(middle)) {
        best = std::move(found);
        high = middle;
      } else {
        low = middle + 1;
      }
    }
    for (int exponent = high - look_back; exponent < high; ++exponent)
      if (auto found = within_bound(exponent)) return found;
    return best;
  }

 private:
  std::optional<LevelClip> within_bound(int step_exponent) {
    const auto samples = static_cast<std::uint32_t>(clip_.clip.times.size());
    TrainedClip made = train_sparse(
        {.layout = &prepared_.layout,
         .steps = &prepared_.steps,
         .offset = &prepared_.offset,
         .emphasis = &prepared_.emphasis,
         .tolerance = context_.source.tolerance,
         .threads = context_.threads},
        map_, {.basis = Basis::cosine, .boundaries = {0, samples}, .step_exponent = step_exponent, .iterations = 0});
    made.levels.times = clip_.clip.times;
    made.levels.states = prepared_.layout.states;
    if (error_of(made.levels) > 0.999 * context_.source.tolerance) return std::nullopt;
    return std::move(made.levels);
  }

  double error_of(const LevelClip& levels) const {
    const Eigen::MatrixXd values = values_of_levels(levels, prepared_.steps, prepared_.layout.values.cols());
    Animation decoded = motion::to_animation(clip_of_parameters(clip_.clip, context_.frame, prepared_.layout, values));
    decoded.curves.insert(decoded.curves.end(), clip_.kept.curves.begin(), clip_.kept.curves.end());
    double worst = 0;
    for (const double error : context_.meter.profile(clip_.original, decoded).max_error)
      if (!(error <= worst)) worst = error;
    return worst;
  }

  const SearchContext& context_;
  const ClipSource& clip_;
  PreparedClip prepared_;
  MotionMap map_;
};

struct TransformedSet {
  SharedPart shared;
  std::vector<std::size_t> clips;  ///< those within the bound
};

TransformedSet transform(const Source& source, const motion::ErrorMeter& meter, const std::vector<std::size_t>& clips,
                         int precision, int threads) {
  TransformedSet result{make_shared_part(source, clips, precision, threads), {}};
  const SearchContext context{
      .source = source, .frame = result.shared.frame, .set = result.shared.set, .meter = meter, .is_late = [] {
        return false;
      }};
  std::vector<std::optional<LevelClip>> levels(clips.size());
  parallel_for(clips.size(), threads,
               [&](std::size_t i) { levels[i] = ClipTransform(context, clips[i]).coarsest_within_bound(); });
  for (std::size_t i = 0; i < clips.size(); ++i) {
    if (!levels[i]) continue;
    result.clips.push_back(clips[i]);
    result.shared.set.clips.push_back(std::move(*levels[i]));
  }
  return result;
}

void add_to(gltf::CompressionEdit& edit, const Source& source, const TransformedSet& set) {
  if (set.clips.empty()) return;
  gltf::ClipSetBytes bytes;
  bytes.stream = write_clip_set(set.shared.set);
  for (const NodeTarget& target : set.shared.frame.targets) bytes.targets.push_back({target.node, target.path});
  for (std::size_t i = 0; i < set.clips.size(); ++i) {
    const ClipSource& clip = source.clips[set.clips[i]];
    edit.taken.push_back({clip.animation, clip.channels, static_cast<int>(edit.clip_sets.size()), static_cast<int>(i),
                          clip.clip.times.front(), clip.clip.times.back()});
  }
  edit.clip_sets.push_back(std::move(bytes));
}

/// A set at the codec's usual precision of anchors, and one at its finest for clips that this cannot hold.
gltf::CompressionEdit make_edit(const Source& source, int threads) {
  const motion::ErrorMeter meter(source.skeleton, source.all_points);
  gltf::CompressionEdit edit;
  std::vector<std::size_t> left(source.clips.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  for (const int precision : {StandardEncoder::usual_precision, StandardEncoder::finest_precision}) {
    if (left.empty()) break;
    const TransformedSet set = transform(source, meter, left, precision, threads);
    add_to(edit, source, set);
    std::erase_if(left,
                  [&](std::size_t i) { return std::find(set.clips.begin(), set.clips.end(), i) != set.clips.end(); });
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
  const gltf::CompressionEdit edit = make_edit(source, options.threads);
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
