#include "baselines/behaviour_segments.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/symmetric_eigen.h"
#include "baselines/principal_components.h"

namespace nmc::baselines {
namespace {

/// Sums over the first frames of a segment, that grow with it.
struct Moments {
  Eigen::VectorXd sum;
  Eigen::MatrixXd products;
  double count = 0;

  explicit Moments(Eigen::Index rows) : sum(Eigen::VectorXd::Zero(rows)), products(Eigen::MatrixXd::Zero(rows, rows)) {}

  void add(const Eigen::Ref<const Eigen::MatrixXd>& frames) {
    sum += frames.rowwise().sum();
    products.noalias() += frames * frames.transpose();
    count += static_cast<double>(frames.cols());
  }
};

/// The mean squared Mahalanobis distance of `frames` from the Gaussian of PPCA.
double mean_distance(const Moments& moments, const Eigen::Ref<const Eigen::MatrixXd>& frames, double covered,
                     double least_variance) {
  const Eigen::VectorXd mean = moments.sum / moments.count;
  const Eigen::MatrixXd covariance = moments.products / moments.count - mean * mean.transpose();
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  const Eigen::VectorXd variances = eigen.values.cwiseMax(0.0);  // rising
  const Eigen::Index rows = variances.size();
  Eigen::Index discarded = 0;
  double left = 0;
  while (discarded + 1 < rows && left + variances(discarded) <= (1 - covered) * variances.sum())
    left += variances(discarded++);
  const double noise = std::max(discarded > 0 ? left / static_cast<double>(discarded) : 0.0, least_variance);
  const Eigen::MatrixXd coefficients = eigen.vectors.transpose() * (frames.colwise() - mean);
  double sum = coefficients.topRows(discarded).squaredNorm() / noise;
  for (Eigen::Index i = discarded; i < rows; ++i)
    sum += coefficients.row(i).squaredNorm() / std::max(variances(i), noise);
  return sum / static_cast<double>(frames.cols());
}

/// The length of the first segment of the frames from `first` on; 0 where nothing ends it.
Eigen::Index first_segment(const Eigen::MatrixXd& poses, Eigen::Index first, const SegmentSettings& settings,
                           double least_variance) {
  Moments moments(poses.rows());
  Eigen::Index length = settings.first_frames;
  moments.add(poses.middleCols(first, length));
  double valley = std::numeric_limits<double>::max(), peak = 0;
  Eigen::Index peak_length = 0;
  for (; first + length + settings.test_frames <= poses.cols(); length += settings.step_frames) {
    const double h = mean_distance(moments, poses.middleCols(first + length, settings.test_frames), settings.covered,
                                   least_variance);
    if (h > peak) {
      peak = h;
      peak_length = length;
    } else if (peak - valley > settings.threshold) {
      return peak_length;
    }
    if (h < valley) {
      valley = peak = h;
      peak_length = length;
    }
    if (first + length + settings.step_frames > poses.cols()) break;
    moments.add(poses.middleCols(first + length, settings.step_frames));
  }
  return 0;
}

double axes_distance(const PrincipalComponents& a, const PrincipalComponents& b) {
  constexpr Eigen::Index axes = 5;
  double sum = 0, weights = 0;
  for (Eigen::Index p = 0; p < std::min({axes, a.axes.cols(), b.axes.cols()}); ++p) {
    const double weight = 1.0 / static_cast<double>(p + 1);
    sum += weight * (1 - std::abs(a.axes.col(p).dot(b.axes.col(p))));
    weights += weight;
  }
  return weights > 0 ? sum / weights : 0;
}

void split_group(const Eigen::MatrixXd& similarity, const std::vector<Eigen::Index>& members, double most_cut,
                 std::vector<std::vector<Eigen::Index>>& groups, int depth) {
  const auto count = static_cast<Eigen::Index>(members.size());
  if (count < 2 || depth > 20) {
    groups.push_back(members);
    return;
  }
  Eigen::MatrixXd w(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      w(i, j) = similarity(members[static_cast<std::size_t>(i)], members[static_cast<std::size_t>(j)]);
  const Eigen::VectorXd degree = w.rowwise().sum();
  const Eigen::VectorXd root = degree.cwiseSqrt().cwiseInverse();
  const SymmetricEigen eigen = symmetric_eigen(root.asDiagonal() * w * root.asDiagonal());
  const Eigen::VectorXd order = root.asDiagonal() * eigen.vectors.col(count - 2);
  std::vector<Eigen::Index> sorted(members.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) sorted[i] = static_cast<Eigen::Index>(i);
  std::sort(sorted.begin(), sorted.end(),
            [&](Eigen::Index a, Eigen::Index b) { return order(a) != order(b) ? order(a) < order(b) : a < b; });
  double best = std::numeric_limits<double>::max();
  std::size_t best_size = 0;
  for (std::size_t size = 1; size < sorted.size(); ++size) {
    double cut = 0, first = 0, second = 0;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      (i < size ? first : second) += degree(sorted[i]);
      for (std::size_t j = 0; i < size && j < sorted.size(); ++j)
        if (j >= size) cut += w(sorted[i], sorted[j]);
    }
    const double value = cut / first + cut / second;
    if (value < best) {
      best = value;
      best_size = size;
    }
  }
  if (best >= most_cut) {
    groups.push_back(members);
    return;
  }
  std::vector<Eigen::Index> parts[2];
  for (std::size_t i = 0; i < sorted.size(); ++i)
    parts[i < best_size ? 0 : 1].push_back(members[static_cast<std::size_t>(sorted[i])]);
  for (std::vector<Eigen::Index>& part : parts) {
    std::sort(part.begin(), part.end());
    split_group(similarity, part, most_cut, groups, depth + 1);
  }
}

}  // namespace

SegmentSettings SegmentSettings::at_rate(double rate_hz) {
  SegmentSettings settings;
  const double scale = rate_hz > 0 ? rate_hz / 120 : 1;
  const auto scaled = [scale](int frames) { return std::max(1, static_cast<int>(std::lround(scale * frames))); };
  settings.first_frames = std::max(2, scaled(settings.first_frames));
  settings.test_frames = scaled(settings.test_frames);
  settings.step_frames = scaled(settings.step_frames);
  return settings;
}

std::vector<Eigen::Index> behaviour_cuts(const Eigen::MatrixXd& poses, const SegmentSettings& settings,
                                         double least_variance) {
  std::vector<Eigen::Index> cuts;
  Eigen::Index first = 0;
  while (poses.cols() - first >= settings.first_frames + settings.test_frames) {
    const Eigen::Index length = first_segment(poses, first, settings, least_variance);
    if (length == 0) break;
    first += length;
    cuts.push_back(first);
  }
  return cuts;
}

std::vector<Eigen::Index> behaviour_cuts_both_ways(const Eigen::MatrixXd& poses, const SegmentSettings& settings,
                                                   double least_variance) {
  std::vector<Eigen::Index> all = behaviour_cuts(poses, settings, least_variance);
  for (const Eigen::Index cut : behaviour_cuts(poses.rowwise().reverse(), settings, least_variance))
    all.push_back(poses.cols() - cut);
  std::sort(all.begin(), all.end());
  std::vector<Eigen::Index> cuts;
  for (const Eigen::Index cut : all)
    if (cut >= (cuts.empty() ? 0 : cuts.back()) + settings.test_frames && poses.cols() - cut >= settings.test_frames)
      cuts.push_back(cut);
  return cuts;
}

std::vector<int> group_segments(const Eigen::MatrixXd& poses, const std::vector<Eigen::Index>& segments) {
  constexpr double axes_share = 0.6, spread = 0.3, most_cut = 0.7;
  std::vector<PrincipalComponents> models;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Eigen::Index end = i + 1 < segments.size() ? segments[i + 1] : poses.cols();
    models.push_back(principal_components(poses.middleCols(segments[i], end - segments[i])));
  }
  const auto count = static_cast<Eigen::Index>(models.size());
  Eigen::MatrixXd similarity(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j) {
      const PrincipalComponents &a = models[static_cast<std::size_t>(i)], &b = models[static_cast<std::size_t>(j)];
      const double means = 1 - a.mean.normalized().dot(b.mean.normalized());
      const double distance = axes_share * axes_distance(a, b) + (1 - axes_share) * means;
      similarity(i, j) = std::exp(-std::pow(distance / spread, 2));
    }
  return normalized_cut_groups(similarity, most_cut);
}

std::vector<int> normalized_cut_groups(const Eigen::MatrixXd& similarity, double most_cut) {
  std::vector<Eigen::Index> all;
  for (Eigen::Index i = 0; i < similarity.rows(); ++i) all.push_back(i);
  std::vector<std::vector<Eigen::Index>> groups;
  split_group(similarity, all, most_cut, groups, 0);
  std::sort(groups.begin(), groups.end());
  std::vector<int> numbers(all.size(), 0);
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const Eigen::Index i : groups[g]) numbers[static_cast<std::size_t>(i)] = static_cast<int>(g);
  return numbers;
}

}  // namespace nmc::baselines
