#include "rate_hidden.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "baselines/motion_data.h"
#include "codec/set_steps.h"
#include "codec/source.h"
#include "codec/standard_profile.h"
#include "gltf/edit.h"
#include "hidden_layer.h"
#include "rate_codec.h"
#include "rate_reference.h"

namespace nmc::bench {
namespace {

using namespace nmc::codec;

constexpr std::array<HiddenSettings, 5> sizes{{
    {.frequencies = 2, .hidden0 = 2, .hidden1 = 2},
    {.frequencies = 4, .hidden0 = 2, .hidden1 = 2, .rate = 6},
    {.frequencies = 4, .hidden0 = 3, .hidden1 = 3, .output_step = 1},
    {.frequencies = 4, .hidden0 = 4, .hidden1 = 4, .output_step = 0.5, .rate = 1},
    {.frequencies = 8, .hidden0 = 8, .hidden1 = 8, .output_step = 1, .rate = 1},
}};

/// Clips beside a network have the same targets: one that lacks some holds them at rest.
Source with_all_targets(Source source) {
  std::vector<const motion::Clip*> clips;
  for (const ClipSource& clip : source.clips) clips.push_back(&clip.clip);
  for (const NodeTarget& target : common_targets(source.skeleton, clips))
    for (ClipSource& clip : source.clips)
      if (!find_track(clip.clip, target))
        clip.clip.tracks.push_back(
            {target.node, target.path, target.width, baselines::rest_value(source.skeleton, target)});
  return source;
}

/// A network's outputs are the parameters that move, in every clip the same: a target moves in all clips or in none.
std::vector<State> common_states(const Source& source, const SetFrame& frame) {
  std::vector<State> most(frame.targets.size(), State::fixed);
  for (const ClipSource& clip : source.clips) {
    const std::vector<State> states = layout_clip(clip.clip, frame).states;
    for (std::size_t t = 0; t < most.size(); ++t) most[t] = std::max(most[t], states[t]);
  }
  return most;
}

/// All clips of a source as one set.
class HiddenEncoder {
 public:
  HiddenEncoder(const Source& source, const CompressOptions& options)
      : source_(source), options_(options), clips_(source.clips.size()) {
    std::iota(clips_.begin(), clips_.end(), std::size_t{0});
    const bool one_bound =
        std::all_of(source.clips.begin(), source.clips.end(), [](const ClipSource& clip) { return clip.bound == 0; });
    if (!clips_.empty() && one_bound) start();
  }

  bool possible() const { return !prepared_.empty(); }
  const ClipSet& plain() const { return plain_; }

  ClipSet with_network(const HiddenSettings& settings) const {
    std::vector<SparseClip> sparse;
    for (std::size_t i = 0; i < clips_.size(); ++i) sparse.push_back({&prepared_[i], &plain_.clips[i]});
    HiddenLayer hidden = train_hidden_layer(sparse, plain_, settings);
    std::vector<PreparedClip> prepared = prepared_;
    for (std::size_t i = 0; i < clips_.size(); ++i) prepared[i].steps.given = std::move(hidden.given[i]);
    ClipSet set = search(prepared);
    set.has_network = set.quantized_network = true;
    set.shared = std::move(hidden.shared);
    for (std::size_t i = 0; i < clips_.size(); ++i) set.clips[i].layer = std::move(hidden.clips[i]);
    return set;
  }

  EncodedSet encoded(const ClipSet& set) const {
    EncodedSet made;
    made.targets = shared_.frame.targets;
    made.stream = write_clip_set(set);
    made.clips = clips_;
    return made;
  }

 private:
  void start() {
    shared_ = make_shared_part(source_, clips_, StandardEncoder::usual_precision, options_.threads);
    const std::vector<State> states = common_states(source_, shared_.frame);
    if (std::all_of(states.begin(), states.end(), [](State state) { return state == State::fixed; })) return;
    shared_.frame.least_states = states;
    const Bound& bound = source_.bounds.front();
    meter_.emplace(source_.skeleton, all_points_of(source_, bound));
    context_.emplace(SearchContext{.source = source_,
                                   .bound = bound,
                                   .frame = shared_.frame,
                                   .set = shared_.set,
                                   .meter = *meter_,
                                   .is_late = [] { return false; },
                                   .effort = options_.effort});
    prepared_.resize(clips_.size());
    parallel_for(clips_.size(), options_.threads,
                 [&](std::size_t i) { prepared_[i] = prepare_clip(*context_, i, options_.contact_weight); });
    plain_ = search(prepared_);
  }

  ClipSet search(const std::vector<PreparedClip>& prepared) const {
    ClipSet set = shared_.set;
    set.clips.resize(clips_.size());
    parallel_for(clips_.size(), options_.threads,
                 [&](std::size_t i) { set.clips[i] = search_clip(*context_, prepared[i], i).back(); });
    choose_references(set);
    return set;
  }

  const Source& source_;
  const CompressOptions& options_;
  std::vector<std::size_t> clips_;
  SharedPart shared_;
  std::optional<motion::ErrorMeter> meter_;
  std::optional<SearchContext> context_;
  std::vector<PreparedClip> prepared_;
  ClipSet plain_;
};

std::string note_of(const HiddenSettings& size, const ClipSet& set, std::size_t bytes, std::size_t bytes_without) {
  return fmt::format("{} frequencies, {} and {} units; set of {} bytes, {} of them network, {} without a network",
                     size.frequencies, size.hidden0, size.hidden1, bytes, static_cast<int>(count_bits(set).network / 8),
                     bytes_without);
}

}  // namespace

Measurement measure_hidden_layer(const std::filesystem::path& path, const CompressOptions& options) {
  gltf::Document document = gltf::read_document(path);
  const Source source = with_all_targets(read_source(document, options));
  Measurement row;
  row.method = "with a hidden layer";
  const HiddenEncoder encoder(source, options);
  if (!encoder.possible()) {
    row.note = "nothing moves, or clips have different bounds";
    return row;
  }
  EncodedSet best;
  for (const HiddenSettings& size : sizes) {
    const ClipSet set = encoder.with_network(size);
    EncodedSet encoded = encoder.encoded(set);
    if (!best.stream.empty() && encoded.stream.size() >= best.stream.size()) continue;
    best = std::move(encoded);
    row.note = note_of(size, set, best.stream.size(), encoder.encoded(encoder.plain()).stream.size());
  }
  gltf::apply_compression(document, compression_edit(source, {best}));
  measure_result(Reference(path), document, row);
  row.reached = row.error <= options.tolerance.value;
  return row;
}

}  // namespace nmc::bench
