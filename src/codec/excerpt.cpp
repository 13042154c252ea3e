#include "codec/excerpt.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace nmc::codec {
namespace {

using Samples = std::vector<Eigen::Index>;  ///< of the clip, ascending

/// How much there is to say about each sample, about: bits of its second differences in slot steps.
Eigen::VectorXd busyness(const PreparedClip& clip) {
  const Eigen::Index samples = clip.layout.values.cols();
  Eigen::VectorXd bits = Eigen::VectorXd::Zero(samples);
  for (const Eigen::Index parameter : clip.layout.moving) {
    const auto row = clip.layout.values.row(parameter).array();
    const auto inner = samples - 2;
    const Eigen::ArrayXd bend =
        ((row.head(inner) + row.tail(inner) - 2 * row.segment(1, inner)) / clip.steps.slot(parameter)).transpose();
    bits.segment(1, inner).array() += (1 + bend.square()).log();
  }
  return bits;
}

/// Windows of a clip, ascending: about `share` of its samples, of calm and busy ones the same share.
std::vector<std::size_t> typical_windows(const PreparedClip& clip, const std::vector<std::uint32_t>& boundaries,
                                         double share) {
  constexpr double fewest = 2;
  const Eigen::VectorXd busy = busyness(clip);
  const std::size_t count = boundaries.size() - 1;
  std::vector<std::pair<double, std::size_t>> ranked;
  for (std::size_t w = 0; w < count; ++w)
    ranked.push_back({busy.segment(boundaries[w], boundaries[w + 1] - boundaries[w]).mean(), w});
  std::sort(ranked.begin(), ranked.end());
  const double wanted = std::max(fewest, std::round(share * static_cast<double>(count)));
  const double every = static_cast<double>(boundaries.back()) / wanted;
  std::vector<std::size_t> typical;
  double passed = 0, next = every / 2;
  for (const auto& [bits, w] : ranked) {
    passed += boundaries[w + 1] - boundaries[w];
    if (passed <= next) continue;
    typical.push_back(w);
    while (next < passed) next += every;
  }
  std::sort(typical.begin(), typical.end());
  return typical;
}

/// These samples of what a training takes in turns.
std::vector<LaneRows> columns_of(const std::vector<LaneRows>& turns, Eigen::Index all, const Samples& samples) {
  if (turns.empty()) return {};
  const auto stride = static_cast<Eigen::Index>(turns.size());
  const Eigen::Index first_samples = (all + stride - 1) / stride;
  const Eigen::Index rows = turns.front().cols() / blocks_of(first_samples);
  Rows some(rows, static_cast<Eigen::Index>(samples.size()));
  for (std::size_t k = 0; k < samples.size(); ++k) {
    const LaneRows& turn = turns[static_cast<std::size_t>(samples[k] % stride)];
    const Eigen::Index at = samples[k] / stride;
    for (Eigen::Index r = 0; r < rows; ++r)
      some(r, static_cast<Eigen::Index>(k)) = turn(at % lanes, at / lanes * rows + r);
  }
  return in_turns(some, stride);
}

/// Puts the clip's window from `first` to `last` behind what the excerpt has; `follows`: that ends where it begins.
void append_window(const std::vector<LevelAtom>& jumps, std::uint32_t first, std::uint32_t last, bool follows,
                   Excerpt& excerpt, Samples& taken) {
  if (follows) taken.pop_back();  // the end of the window before
  const auto place = static_cast<std::uint32_t>(taken.size());
  if (!follows) excerpt.boundaries.push_back(place);
  excerpt.boundaries.push_back(place + last - first);
  for (std::uint32_t n = first; n <= last; ++n) taken.push_back(static_cast<Eigen::Index>(n));
  for (LevelAtom jump : jumps) {
    if (jump.sample <= first || jump.sample > last) continue;
    jump.sample = place + jump.sample - first;
    excerpt.clip.jumps.push_back(jump);
  }
}

}  // namespace

std::optional<Excerpt> excerpt_of(const PreparedClip& clip, const std::vector<std::uint32_t>& boundaries,
                                  Eigen::Index samples) {
  constexpr double most = 0.75;  // of the clip
  constexpr std::size_t fewest_windows = 6;
  if (boundaries.size() <= fewest_windows) return std::nullopt;
  const Eigen::Index all = clip.layout.values.cols();
  const std::vector<std::size_t> windows =
      typical_windows(clip, boundaries, static_cast<double>(samples) / static_cast<double>(all));
  Excerpt excerpt;
  Samples taken;
  for (std::size_t k = 0; k < windows.size(); ++k)
    append_window(clip.jumps, boundaries[windows[k]], boundaries[windows[k] + 1],
                  k > 0 && windows[k - 1] + 1 == windows[k], excerpt, taken);
  excerpt.share = static_cast<double>(taken.size()) / static_cast<double>(all);
  if (excerpt.share > most) return std::nullopt;
  PreparedClip& made = excerpt.clip;
  made.layout = {clip.layout.states, clip.layout.blocks, clip.layout.parameters, clip.layout.moving,
                 clip.layout.values(Eigen::all, taken)};
  made.steps = {clip.steps.slot, clip.steps.anchor, {}};
  if (clip.steps.given.size() > 0) made.steps.given = clip.steps.given(Eigen::all, taken);
  made.coded = clip.coded;
  made.wanted = clip.wanted(Eigen::all, taken);
  made.offset = columns_of(clip.offset, all, taken);
  made.emphasis = columns_of(clip.emphasis, all, taken);
  for (std::size_t n = 0; n < taken.size(); ++n) excerpt.source.clip.times.push_back(static_cast<float>(n));
  return excerpt;
}

}  // namespace nmc::codec
