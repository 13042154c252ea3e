// The plain opponent: a DCT-II of each channel over the whole clip, one step a clip, the codec's own entropy coder.
#include "baselines/dct.h"

#include <algorithm>
#include <numeric>
#include <optional>

#include "base/parallel.h"
#include "baselines/clip_sets.h"
#include "codec/clip_search.h"
#include "codec/set_steps.h"
#include "codec/standard_profile.h"

namespace nmc::baselines {
namespace {

using namespace nmc::codec;

constexpr int coarsest = -24, finest = 40;  // step exponents, quarters of an octave
/// Of anchors, in the units of StandardEncoder::usual_precision.
constexpr int usual_precision = 10;
constexpr int look_back = 3;  // coarser exponents tried below the bisection's result

/// Finds one clip's levels.
class ClipTransform {
 public:
  ClipTransform(const SearchContext& context, std::size_t index)
      : context_(context),
        clip_(context.source.clips[index]),
        prepared_(prepare_clip(context, index, 1)),
        map_(context.source.skeleton, context.frame, prepared_.layout, points_of(context.source, context.bound),
             prepared_.coded) {}

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
         .offset = prepared_.offset,
         .emphasis = prepared_.emphasis,
         .tolerance = context_.bound.tolerance,
         .threads = context_.threads},
        map_, {.basis = Basis::cosine, .boundaries = {0, samples}, .step_exponent = step_exponent, .iterations = 0});
    made.levels.times = clip_.clip.times;
    made.levels.states = prepared_.layout.states;
    if (error_of(made.levels) > codec::kept_share * context_.bound.tolerance) return std::nullopt;
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
  const SearchContext context{.source = source,
                              .bound = source.bounds.front(),
                              .frame = result.shared.frame,
                              .set = result.shared.set,
                              .meter = meter,
                              .is_late = [] { return false; }};
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

EncodedSet to_encoded(const TransformedSet& set) {
  EncodedSet encoded;
  encoded.targets = set.shared.frame.targets;
  encoded.stream = write_clip_set(set.shared.set);
  encoded.clips = set.clips;
  encoded.frequencies.assign(set.clips.size(), 0);
  encoded.seconds.assign(set.clips.size(), 0.0);
  return encoded;
}

class DctEncoder : public Encoder {
 public:
  DctEncoder(const Source& source, const EncodeSettings& settings) : source_(source), threads_(settings.threads) {}

  Bytes encode(double knob) override {
    const Source source = codec::with_tolerance(source_, knob * source_.size);
    return write_sets(encode_dct(source, threads_), source.clips.size());
  }

 private:
  const Source& source_;
  int threads_;
};

}  // namespace

std::vector<EncodedSet> encode_dct(const Source& source, int threads) {
  const motion::ErrorMeter meter(source.skeleton, source.all_points);
  std::vector<EncodedSet> sets;
  std::vector<std::size_t> left(source.clips.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  for (const int precision : {usual_precision, StandardEncoder::finest_precision}) {
    if (left.empty()) break;
    const TransformedSet set = transform(source, meter, left, precision, threads);
    if (!set.clips.empty()) sets.push_back(to_encoded(set));
    std::erase_if(left,
                  [&](std::size_t i) { return std::find(set.clips.begin(), set.clips.end(), i) != set.clips.end(); });
  }
  return sets;
}

std::unique_ptr<Encoder> prepare_dct(const Source& source, const EncodeSettings& settings) {
  return std::make_unique<DctEncoder>(source, settings);
}

}  // namespace nmc::baselines
