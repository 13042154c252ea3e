// Curves through few points: cubic splines through key frames (Liu and McMillan 2006) and Catmull-Rom splines (Lin et
// al. 2011).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace nmc::baselines {

/// Natural cubic splines through the columns of `values` at the samples `keys` (increasing, the first 0), at samples
/// 0 ... keys.back(). Of two keys a straight line.
Eigen::MatrixXd cubic_spline(const std::vector<Eigen::Index>& keys, const Eigen::MatrixXd& values);

/// Liu and McMillan, section 3.4: four even key frames, then the middle of every interval in which some sample is
/// farther from the curve than `threshold` (length of the difference of columns), until none is.
std::vector<Eigen::Index> choose_keys(const Eigen::MatrixXd& curve, double threshold);

/// A Catmull-Rom spline through values at samples (increasing, the first 0): tangents are the vectors between
/// neighbours, over their distance in samples; ends use their one neighbour.
Eigen::VectorXd catmull_rom(const std::vector<Eigen::Index>& points, const Eigen::VectorXd& values);

/// Lin et al., section 5.1: control points every `span` samples and at the end, then the sample with the largest error,
/// until it is at most `threshold`.
std::vector<Eigen::Index> fit_catmull_rom(const Eigen::VectorXd& curve, Eigen::Index span, double threshold);

/// The control points that need no index: 0, span, 2 span, ..., frames - 1.
std::vector<Eigen::Index> regular_points(Eigen::Index frames, Eigen::Index span);

/// The values of a curve at some samples.
Eigen::MatrixXd columns_at(const Eigen::MatrixXd& curve, const std::vector<Eigen::Index>& samples);

}  // namespace nmc::baselines
