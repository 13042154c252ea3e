#include "baselines/repeated_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace nmc::baselines {
namespace {

using Eigen::Index;
using Step = std::pair<Index, Index>;

enum Label : std::uint8_t { none = 0, minimum_x = 1, minimum_y = 2, minimum_both = 3 };

/// Step 2: minima of the similar pixels above the diagonal, at least `gap` from it.
Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic> label_minima(const Eigen::MatrixXf& d, float most,
                                                                         Index gap) {
  const Index n = d.rows();
  Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic> labels =
      Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic>::Zero(n, n);
  for (Index y = gap; y < n; ++y)
    for (Index x = 0; x + gap <= y; ++x) {
      const float v = d(x, y);
      if (v > most) continue;
      const auto at = [&](Index a, Index b) {
        return a >= 0 && b < n && b >= a ? d(a, b) : std::numeric_limits<float>::max();
      };
      const bool along_x = v <= at(x - 1, y) && v <= at(x + 1, y);
      const bool along_y = v <= at(x, y - 1) && v <= at(x, y + 1);
      labels(x, y) = static_cast<std::uint8_t>((along_x ? minimum_x : none) | (along_y ? minimum_y : none));
    }
  return labels;
}

/// Step 6: paths whose next one begins within a short bridge become one.
void merge_paths(std::vector<PosturePath>& paths, Index bridge_samples) {
  std::sort(paths.begin(), paths.end(), [](const PosturePath& a, const PosturePath& b) { return a.steps < b.steps; });
  for (std::size_t i = 0; i < paths.size(); ++i)
    for (bool merged = true; merged;) {
      merged = false;
      const auto [x, y] = paths[i].steps.back();
      std::size_t nearest = paths.size();
      Index least = bridge_samples + 1;
      for (std::size_t j = 0; j < paths.size(); ++j) {
        if (j == i || paths[j].steps.empty()) continue;
        const auto [a, b] = paths[j].steps.front();
        if (a < x || b < y || a - x + b - y >= least) continue;
        least = a - x + b - y;
        nearest = j;
      }
      if (nearest == paths.size()) break;
      const auto [a, b] = paths[nearest].steps.front();
      const Index bridge = std::max(a - x, b - y);
      for (Index k = 1; k < bridge; ++k) paths[i].steps.push_back({x + (a - x) * k / bridge, y + (b - y) * k / bridge});
      paths[i].steps.insert(paths[i].steps.end(), paths[nearest].steps.begin(), paths[nearest].steps.end());
      paths[nearest].steps.clear();
      merged = true;
    }
  std::erase_if(paths, [](const PosturePath& p) { return p.steps.empty(); });
}

/// What a path maps each sample of an axis to; -1 where it does not reach.
std::vector<Index> mapping(const PosturePath& path, bool from_x, Index samples) {
  std::vector<Index> map(static_cast<std::size_t>(samples), -1);
  std::vector<std::pair<double, int>> sums(static_cast<std::size_t>(samples), {0.0, 0});
  Index low = samples, high = -1;
  for (const auto& [x, y] : path.steps) {
    const Index from = from_x ? x : y, to = from_x ? y : x;
    sums[static_cast<std::size_t>(from)].first += static_cast<double>(to);
    ++sums[static_cast<std::size_t>(from)].second;
    low = std::min(low, from);
    high = std::max(high, from);
  }
  Index before = low;
  for (Index n = low; n <= high; ++n) {
    const auto& [sum, count] = sums[static_cast<std::size_t>(n)];
    if (count == 0) continue;
    map[static_cast<std::size_t>(n)] = std::lround(sum / count);
    for (Index k = before + 1; k < n; ++k) {  // the path steps over these
      const double part = static_cast<double>(k - before) / static_cast<double>(n - before);
      const auto a = static_cast<double>(map[static_cast<std::size_t>(before)]);
      const auto b = static_cast<double>(map[static_cast<std::size_t>(n)]);
      map[static_cast<std::size_t>(k)] = std::lround(a + part * (b - a));
    }
    before = n;
  }
  return map;
}

/// Equation 2.
double primary_cost(const Eigen::MatrixXd& columns, Index first, Index end) {
  const auto part = columns.middleCols(first, end - first);
  const double deviation =
      std::sqrt((part.colwise() - part.rowwise().mean()).squaredNorm() / static_cast<double>(end - first));
  return deviation * static_cast<double>(end - first) + (columns.col((first + end) / 2) - columns.col(0)).norm();
}

/// Equation 3.
double repeated_cost(const Eigen::MatrixXd& columns, const ClipPart& clip) {
  double sum = 0;
  for (Index n = clip.first; n < clip.end; ++n)
    sum += (columns.col(n) - columns.col(clip.reference[static_cast<std::size_t>(n - clip.first)])).norm();
  return sum;
}

/// The greedy search for primary clips.
class ClipChoice {
 public:
  ClipChoice(const Eigen::MatrixXd& columns, const std::vector<PosturePath>& paths, std::vector<Index> junctions,
             Index least)
      : columns_(columns),
        junctions_(std::move(junctions)),
        least_(least),
        taken_(static_cast<std::size_t>(columns.cols()), 0) {
    for (const PosturePath& path : paths)
      for (const bool from_x : {true, false}) maps_.push_back(mapping(path, from_x, columns.cols()));
    cuts_.insert(0);
    cuts_.insert(columns.cols());
    cuts_.insert(junctions_.begin(), junctions_.end());
    for (const PosturePath& path : paths)
      for (const Step& step : {path.steps.front(), path.steps.back()})
        for (const Index cut : {step.first, step.second}) cuts_.insert(cut);
  }

  std::vector<ClipPart> choose() {
    for (;;) {
      double best_gain = 1;
      ClipPart best;
      std::vector<ClipPart> best_repeated;
      for (const auto& [first, end] : free_intervals()) {
        std::vector<ClipPart> repeated = repetitions(first, end);
        Index frames = 0;
        const double own = primary_cost(columns_, first, end);
        double before = own, after = own;
        for (const ClipPart& clip : repeated) {
          frames += clip.end - clip.first;
          before += primary_cost(columns_, clip.first, clip.end);
          after += repeated_cost(columns_, clip);
        }
        if (frames <= end - first || !(before / after > best_gain)) continue;
        best_gain = before / after;
        best = {ClipKind::primary, first, end, {}};
        best_repeated = std::move(repeated);
      }
      if (best.end == 0) break;
      take(best);
      for (const ClipPart& clip : best_repeated) take(clip);
    }
    add_unique();
    std::sort(clips_.begin(), clips_.end(), [](const ClipPart& a, const ClipPart& b) { return a.first < b.first; });
    return clips_;
  }

 private:
  bool is_free(Index n) const { return !taken_[static_cast<std::size_t>(n)]; }

  void take(const ClipPart& clip) {
    for (Index n = clip.first; n < clip.end; ++n) taken_[static_cast<std::size_t>(n)] = 1;
    cuts_.insert(clip.first);
    cuts_.insert(clip.end);
    clips_.push_back(clip);
  }

  std::vector<Step> free_intervals() const {
    std::vector<Step> intervals;
    for (auto cut = cuts_.begin(); std::next(cut) != cuts_.end(); ++cut) {
      const Index first = *cut, end = *std::next(cut);
      if (end - first >= least_ && is_free(first)) intervals.push_back({first, end});
    }
    return intervals;
  }

  /// Runs of free samples that paths map into [first, end), in order of the paths; none twice.
  std::vector<ClipPart> repetitions(Index first, Index end) const {
    std::vector<ClipPart> found;
    std::vector<char> used(taken_.begin(), taken_.end());
    for (Index n = first; n < end; ++n) used[static_cast<std::size_t>(n)] = 1;
    for (const std::vector<Index>& map : maps_) {
      ClipPart clip{ClipKind::repeated, 0, 0, {}};
      const auto close = [&] {
        if (clip.end - clip.first >= least_) {
          for (Index n = clip.first; n < clip.end; ++n) used[static_cast<std::size_t>(n)] = 1;
          found.push_back(clip);
        }
        clip = {ClipKind::repeated, 0, 0, {}};
      };
      for (Index n = 0; n < columns_.cols(); ++n) {
        const Index to = map[static_cast<std::size_t>(n)];
        const bool fits = to >= first && to < end && !used[static_cast<std::size_t>(n)];
        if (!fits || std::binary_search(junctions_.begin(), junctions_.end(), n)) close();
        if (!fits) continue;
        if (clip.reference.empty()) clip.first = n;
        clip.end = n + 1;
        clip.reference.push_back(to);
      }
      close();
    }
    return found;
  }

  void add_unique() {
    for (Index n = 0; n < columns_.cols();) {
      if (!is_free(n)) {
        ++n;
        continue;
      }
      Index end = n + 1;
      while (end < columns_.cols() && is_free(end) && !std::binary_search(junctions_.begin(), junctions_.end(), end))
        ++end;
      clips_.push_back({ClipKind::unique, n, end, {}});
      n = end;
    }
  }

  const Eigen::MatrixXd& columns_;
  std::vector<Index> junctions_;
  Index least_;
  std::vector<char> taken_;
  std::vector<std::vector<Index>> maps_;
  std::set<Index> cuts_;
  std::vector<ClipPart> clips_;
};

/// A unique clip that is too short joins the clip before it where that is unique or repeated, else the one behind.
std::vector<ClipPart> merge_short(std::vector<ClipPart> clips, const std::vector<Index>& junctions, Index least) {
  const auto is_junction = [&](Index n) { return std::binary_search(junctions.begin(), junctions.end(), n); };
  for (std::size_t i = 0; i < clips.size();) {
    ClipPart& clip = clips[i];
    const Index length = clip.end - clip.first;
    if (clip.kind != ClipKind::unique || length >= least) {
      ++i;
      continue;
    }
    if (i > 0 && !is_junction(clip.first) && clips[i - 1].kind != ClipKind::primary) {
      ClipPart& before = clips[i - 1];
      before.end = clip.end;
      if (before.kind == ClipKind::repeated)
        before.reference.insert(before.reference.end(), static_cast<std::size_t>(length), before.reference.back());
      clips.erase(clips.begin() + static_cast<std::ptrdiff_t>(i));
    } else if (i + 1 < clips.size() && !is_junction(clip.end) && clips[i + 1].kind != ClipKind::primary) {
      ClipPart& behind = clips[i + 1];
      behind.first = clip.first;
      if (behind.kind == ClipKind::repeated)
        behind.reference.insert(behind.reference.begin(), static_cast<std::size_t>(length), behind.reference.front());
      clips.erase(clips.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      ++i;
    }
  }
  return clips;
}

}  // namespace

Eigen::MatrixXf self_distances(const Eigen::MatrixXd& columns) {
  const Eigen::MatrixXf c = columns.cast<float>();
  const Eigen::VectorXf squares = c.colwise().squaredNorm();
  Eigen::MatrixXf d = -2 * c.transpose() * c;
  d.colwise() += squares;
  d.rowwise() += squares.transpose();
  return d.cwiseMax(0.0f).cwiseSqrt();
}

std::vector<PosturePath> similar_posture_paths(const Eigen::MatrixXf& d, double similar, Index bridge_samples,
                                               Index least_samples) {
  std::vector<PosturePath> paths;
  const Index n = d.rows(), gap = std::max<Index>(2, least_samples / 2);
  if (n <= gap) return paths;
  const auto labels = label_minima(d, static_cast<float>(similar * static_cast<double>(d.mean())), gap);
  Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic> explored =
      Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic>::Zero(n, n);
  constexpr std::array<Step, 5> moves{{{1, 1}, {1, 0}, {0, 1}, {1, 2}, {2, 1}}};
  const auto explore = [&](Step at, Index direction) {
    std::vector<Step> way;
    for (;;) {
      Step next{-1, -1};
      float least = std::numeric_limits<float>::max();
      for (const auto& [dx, dy] : moves) {
        const Index x = at.first + direction * dx, y = at.second + direction * dy;
        if (x < 0 || y >= n || x >= y || !labels(x, y) || explored(x, y) || !(d(x, y) < least)) continue;
        least = d(x, y);
        next = {x, y};
      }
      if (next.first < 0) return way;
      explored(next.first, next.second) = 1;
      way.push_back(next);
      at = next;
    }
  };
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < y; ++x) {
      if (labels(x, y) != minimum_both || explored(x, y)) continue;
      explored(x, y) = 1;
      std::vector<Step> back = explore({x, y}, -1);
      std::reverse(back.begin(), back.end());
      back.push_back({x, y});
      const std::vector<Step> ahead = explore({x, y}, 1);
      back.insert(back.end(), ahead.begin(), ahead.end());
      paths.push_back({std::move(back)});
    }
  merge_paths(paths, bridge_samples);
  std::erase_if(paths, [&](const PosturePath& p) { return p.length() < least_samples; });
  return paths;
}

std::vector<ClipPart> choose_clips(const Eigen::MatrixXd& columns, const std::vector<PosturePath>& paths,
                                   const std::vector<Index>& junctions, Index least_samples) {
  return merge_short(ClipChoice(columns, paths, junctions, least_samples).choose(), junctions, least_samples);
}

}  // namespace nmc::baselines
