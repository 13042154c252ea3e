// Repeated motion analysis (Lin et al. 2011, section 4.2): which parts of a motion are like others, at another speed
// perhaps, and which of them should be told by which.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace nmc::baselines {

/// Samples (x, y), x < y, both never falling along the path, at which the motion is alike.
struct PosturePath {
  std::vector<std::pair<Eigen::Index, Eigen::Index>> steps;

  Eigen::Index length() const {  ///< Manhattan
    return steps.back().first - steps.front().first + steps.back().second - steps.front().second;
  }
};

/// Distances between all pairs of columns: the self-distance plot.
Eigen::MatrixXf self_distances(const Eigen::MatrixXd& columns);

/// Similar-posture paths of a self-distance plot. Pixels above `similar` times the mean distance are dissimilar. A
/// bridge between two paths takes at most `bridge_samples`, a path at least `least_samples` (Manhattan; the paper: 300
/// and 600 ms).
std::vector<PosturePath> similar_posture_paths(const Eigen::MatrixXf& distances, double similar,
                                               Eigen::Index bridge_samples, Eigen::Index least_samples);

enum class ClipKind { primary = 0, repeated = 1, unique = 2 };

/// Samples first ... end - 1 of the motion.
struct ClipPart {
  ClipKind kind = ClipKind::unique;
  Eigen::Index first = 0, end = 0;
  std::vector<Eigen::Index> reference;  ///< of a repeated one: per sample, a sample of a primary clip
};

/// The clips of a motion, in order, without gaps, by greedy choice of the largest gain (equations 2, 3, 5). No clip
/// crosses a sample of `junctions` (increasing); none but what junctions force is shorter than `least_samples` (200
/// ms).
std::vector<ClipPart> choose_clips(const Eigen::MatrixXd& columns, const std::vector<PosturePath>& paths,
                                   const std::vector<Eigen::Index>& junctions, Eigen::Index least_samples);

}  // namespace nmc::baselines
