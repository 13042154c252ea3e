// Where a motion becomes another one: segmentation by probabilistic PCA (Barbic et al. 2004, as Liu and McMillan 2006,
// section 3.2, give it) and grouping by normalised cuts (Lin et al. 2011, section 4.1).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace nmc::baselines {

/// In frames at 120 Hz; `at_rate` scales them.
struct SegmentSettings {
  int first_frames = 200;  ///< K at the start of a segment
  int test_frames = 150;   ///< T
  int step_frames = 10;    ///< Delta
  double covered = 0.95;   ///< tau
  double threshold = 500;  ///< R: of the mean squared Mahalanobis distance H

  static SegmentSettings at_rate(double rate_hz);
};

/// First frames of all segments but the first, increasing. `poses`: one frame a column. The residual variance of the
/// model is at least `least_variance` (in squared units of the poses): nothing is more exact than its measurement.
std::vector<Eigen::Index> behaviour_cuts(const Eigen::MatrixXd& poses, const SegmentSettings& settings,
                                         double least_variance);

/// The cuts forward and backward together (Lin et al.); of cuts nearer than `test_frames` the first stays.
std::vector<Eigen::Index> behaviour_cuts_both_ways(const Eigen::MatrixXd& poses, const SegmentSettings& settings,
                                                   double least_variance);

/// Groups of segments that look alike, numbered by first appearance. `segments[i]` is the first frame of segment i;
/// the last ends with the poses. Distance: 0.6 of what the first five axes differ in, 0.4 of what the directions of
/// the mean poses differ in (equation 1).
std::vector<int> group_segments(const Eigen::MatrixXd& poses, const std::vector<Eigen::Index>& segments);

/// Recursive two-way normalised cuts (Shi and Malik 2000) of a symmetric matrix of similarities in [0, 1], as long as a
/// cut's value is below `most_cut`.
std::vector<int> normalized_cut_groups(const Eigen::MatrixXd& similarity, double most_cut);

}  // namespace nmc::baselines
