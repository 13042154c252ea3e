#include "codec/atoms.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "codec/features.h"

namespace nmc::codec {
namespace {

double bits(const std::vector<LevelAtom>& atoms) {
  double sum = 0;
  for (const LevelAtom& atom : atoms) sum += 12 + 2 * std::log2(std::abs(static_cast<double>(atom.level)));
  return sum;
}

/// A jump of `height` within its window: what the line between the anchors does not have.
void add_jump_values(const LevelAtom& jump, const LevelClip& clip, double height, Eigen::MatrixXd& values) {
  const auto after = std::lower_bound(clip.windows.begin(), clip.windows.end(), jump.sample,
                                      [](const LevelWindow& w, std::uint32_t sample) { return w.begin < sample; });
  const LevelWindow& window = *std::prev(after);
  const auto first = static_cast<Eigen::Index>(window.begin);
  const Eigen::Index count =
      after == clip.windows.end() ? values.cols() - first : static_cast<Eigen::Index>(window.length);
  const Eigen::MatrixXd shares = anchor_shares(clip.basis, window.length, count);
  for (Eigen::Index m = 0; m < count; ++m)
    values(jump.parameter, first + m) +=
        height * ((first + m >= static_cast<Eigen::Index>(jump.sample) ? 1 : 0) - shares(1, m));
}

/// As few of the first lists as are enough, as far as halving tells; all where all are not enough.
std::vector<std::vector<LevelAtom>> first_lists(std::vector<std::vector<LevelAtom>> lists, const Excess& excess) {
  const auto first = [&](std::size_t count) {
    return std::vector<std::vector<LevelAtom>>(lists.begin(), lists.begin() + static_cast<std::ptrdiff_t>(count));
  };
  std::size_t too_few = 0, enough = lists.size();
  while (enough - too_few > 1) {
    const std::size_t middle = (too_few + enough) / 2;
    (excess(joined(first(middle))) > 0 ? too_few : enough) = middle;
  }
  return first(enough);
}

}  // namespace

void put_atom(const LevelAtom& atom, std::vector<LevelAtom>& atoms) {
  const auto same = std::find_if(atoms.begin(), atoms.end(), [&](const LevelAtom& other) {
    return other.sample == atom.sample && other.parameter == atom.parameter && other.width == atom.width;
  });
  if (same == atoms.end())
    atoms.push_back(atom);
  else
    same->level += atom.level;
}

void put_atoms(const std::vector<LevelAtom>& added, std::vector<LevelAtom>& atoms) {
  const auto key = [](const LevelAtom& atom) { return std::tuple(atom.sample, atom.parameter, atom.width); };
  std::map<decltype(key(LevelAtom{})), std::size_t> places;
  for (std::size_t k = 0; k < atoms.size(); ++k) places.emplace(key(atoms[k]), k);
  for (const LevelAtom& atom : added) {
    const auto [place, is_new] = places.emplace(key(atom), atoms.size());
    if (is_new)
      atoms.push_back(atom);
    else
      atoms[place->second].level += atom.level;
  }
}

std::vector<LevelAtom> joined(const std::vector<std::vector<LevelAtom>>& lists) {
  std::vector<LevelAtom> all;
  for (const std::vector<LevelAtom>& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

void tidy_atoms(std::vector<LevelAtom>& atoms) {
  std::erase_if(atoms, [](const LevelAtom& a) { return a.level == 0; });
  std::stable_sort(atoms.begin(), atoms.end(),
                   [](const LevelAtom& a, const LevelAtom& b) { return a.sample < b.sample; });
}

void add_atom_values(const LevelAtom& atom, const LevelClip& clip, const ParameterSteps& steps,
                     Eigen::MatrixXd& values) {
  if (atom.width == LevelAtom::jump_width) {
    add_jump_values(atom, clip, atom.level * steps.anchor(atom.parameter), values);
    return;
  }
  const auto at = static_cast<Eigen::Index>(atom.sample);
  const Eigen::Index half = Eigen::Index{1} << atom.width;
  const Eigen::Index end = std::min<Eigen::Index>(values.cols(), at + half);
  for (Eigen::Index n = std::max<Eigen::Index>(0, at - half + 1); n < end; ++n)
    values(atom.parameter, n) += atom.level * steps.anchor(atom.parameter) * atom_share(std::abs(n - at), atom.width);
}

std::vector<std::vector<LevelAtom>> missing_by_target(const ClipLayout& layout, const ParameterSteps& steps,
                                                      Eigen::Index first, Eigen::Index count,
                                                      const Eigen::MatrixXd& values) {
  std::vector<std::vector<LevelAtom>> lists;
  for (const LayoutBlock& block : layout.blocks) {
    if (block.state == State::fixed) continue;
    std::vector<LevelAtom> atoms;
    for (Eigen::Index n = first; n < first + count; ++n)
      for (int parameter = block.block.first; parameter < block.block.first + block.block.width; ++parameter) {
        const double exact = (layout.values(parameter, n) - values(parameter, n)) / steps.anchor(parameter);
        if (const auto level = static_cast<std::int32_t>(std::lround(exact)); level != 0)
          atoms.push_back({static_cast<std::uint32_t>(n), parameter, 0, level});
      }
    if (!atoms.empty()) lists.push_back(std::move(atoms));
  }
  return lists;
}

std::optional<std::vector<LevelAtom>> few_atoms(const std::vector<std::vector<LevelAtom>>& lists, const Excess& excess,
                                                int& tries) {
  constexpr int most = 5;
  std::vector<LevelAtom> chosen;
  double now = excess(chosen);
  for (int k = 0; k < most && now > 0; ++k) {
    std::vector<LevelAtom> best;
    for (const std::vector<LevelAtom>& list : lists) {
      if (now <= 0) break;
      if (tries-- <= 0) return {};
      std::vector<LevelAtom> with = joined({chosen, list});
      if (const double then = excess(with); then < now) {
        now = then;
        best = std::move(with);
      }
    }
    if (best.empty()) return {};
    chosen = std::move(best);
  }
  return now > 0 ? std::nullopt : std::optional(chosen);
}

std::vector<LevelAtom> needed_atoms(std::vector<std::vector<LevelAtom>> lists, const Excess& excess, int& tries) {
  if (const std::optional<std::vector<LevelAtom>> few = few_atoms(lists, excess, tries)) return *few;
  if (tries <= 0) return joined(first_lists(std::move(lists), excess));
  std::stable_sort(lists.begin(), lists.end(), [](const auto& a, const auto& b) { return bits(a) > bits(b); });
  if (excess(joined(lists)) > 0) return joined(lists);
  for (std::vector<LevelAtom>& list : lists) {
    if (tries-- <= 0) break;
    const std::vector<LevelAtom> kept = std::exchange(list, {});
    if (excess(joined(lists)) > 0) list = kept;
  }
  return joined(lists);
}

}  // namespace nmc::codec
