// Two poses at a time, the differences of their world matrices, and what these do to the points.
#include "motion/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "motion/contact.h"
#include "motion/index.h"
#include "motion/pose.h"

namespace nmc::motion {
namespace {

constexpr double same_key_seconds = 1e-6;
constexpr std::size_t most_sampled_points = 300;
constexpr std::size_t fewest_sampled_points = 16;
constexpr std::size_t most_sampled_values = 8'000'000;

struct SampleTime {
  double seconds = 0.0;
  bool key = true;
};

/// All key times and the midpoints between them, increasing; time 0 without curves.
std::vector<SampleTime> sample_times(const Animation& animation) {
  std::vector<double> keys;
  const std::vector<float>* before_times = nullptr;  // most often all curves have the same keys
  for (const Curve& curve : animation.curves) {
    if (before_times && curve.times == *before_times) continue;
    keys.insert(keys.end(), curve.times.begin(), curve.times.end());
    before_times = &curve.times;
  }
  if (keys.empty()) keys.push_back(0.0);
  std::sort(keys.begin(), keys.end());
  std::vector<SampleTime> samples;
  double last = keys.front(), before = keys.front();
  samples.push_back({last, true});
  for (const double t : keys) {
    if (t - before > same_key_seconds) {
      samples.push_back({0.5 * (last + t), false});
      samples.push_back({t, true});
      last = t;
    }
    before = t;
  }
  return samples;
}

/// Raises a maximum; what is not a number makes it infinite.
void raise(double& largest, double value) { largest = std::max(largest, number_or_infinity(value)); }

double angle_degrees(const glm::dquat& a, const glm::dquat& b) {
  const double minus = glm::length(a - b), plus = glm::length(a + b);
  if (std::isnan(minus) || std::isnan(plus)) return std::numeric_limits<double>::infinity();
  return glm::degrees(4.0 * std::atan2(std::min(minus, plus), std::max(minus, plus)));
}

/// A morph error is one more point, whose place is a node.
struct MorphError {
  double error = 0.0;
  int node = -1;
};

/// The two animations' poses at one time and their difference.
class Comparison {
 public:
  Comparison(const Skeleton& skeleton, const Points& points, const Animation& original, const Animation& decoded)
      : skeleton_(&skeleton),
        original_(skeleton, original),
        decoded_(skeleton, decoded),
        morphs_(points.morphs),
        difference_(skeleton.size(), glm::dmat4(0.0)) {
    std::vector<bool> moves(skeleton.size(), false);
    for (const PoseReader* pose : {&original_, &decoded_}) {
      for (const int node : pose->moving()) moves[at(node)] = true;
    }
    for (const int node : skeleton.order) {
      if (moves[at(node)]) moving_.push_back(node);
      if (has_either(node, Path::rotation)) rotating_.push_back(node);
      if (has_either(node, Path::weights)) morphing_.push_back(node);
    }
    std::stable_sort(morphs_.begin(), morphs_.end(),
                     [](const MorphReach& a, const MorphReach& b) { return a.node < b.node; });
  }

  void read(double seconds) { read(seconds, seconds); }

  void read(double original_seconds, double decoded_seconds) {
    original_.read(original_seconds);
    decoded_.read(decoded_seconds);
    for (const int node : moving_) difference_[at(node)] = decoded_.world()[at(node)] - original_.world()[at(node)];
  }

  std::span<const glm::dmat4> difference() const { return difference_; }

  void raise_joint(double& largest) const {
    for (const int joint : skeleton_->joints) raise(largest, glm::length(glm::dvec3(difference_[at(joint)][3])));
  }

  /// One drift per skin joint.
  void add_drift(double seconds, double size, std::vector<ContactDrift>& drifts) const {
    for (std::size_t i = 0; i < drifts.size(); ++i) {
      const int joint = skeleton_->joints[i];
      drifts[i].add(seconds, original_.world()[at(joint)][3], difference_[at(joint)][3], size);
    }
  }

  void raise_rotation(double& largest_degrees) const {
    for (const int node : rotating_) {
      raise(largest_degrees, angle_degrees(original_.rotation(node), decoded_.rotation(node)));
    }
  }

  void raise_weight(double& largest) const {
    for (const int node : morphing_) {
      const std::size_t targets = std::max(original_.weights(node).size(), decoded_.weights(node).size());
      for (std::size_t k = 0; k < targets; ++k) raise(largest, weight_difference(node, k));
    }
  }

  void raise_morph(MorphError& worst) const {
    for (std::size_t first = 0, last = 0; first < morphs_.size(); first = last) {
      const int node = morphs_[first].node;
      double sum = 0.0;
      for (; last < morphs_.size() && morphs_[last].node == node; ++last) {
        sum += weight_difference(node, static_cast<std::size_t>(morphs_[last].target)) * morphs_[last].reach;
      }
      if (sum == 0.0) continue;
      const glm::dmat4& world = original_.world()[at(node)];
      const double scale = std::max(
          {glm::length(glm::dvec3(world[0])), glm::length(glm::dvec3(world[1])), glm::length(glm::dvec3(world[2]))});
      const double error = number_or_infinity(sum * scale);
      if (error > worst.error) worst = {error, node};
    }
  }

 private:
  bool has_either(int node, Path path) const {
    return original_.has_curve(node, path) || decoded_.has_curve(node, path);
  }

  double weight_difference(int node, std::size_t target) const {
    const auto weight = [&](const PoseReader& pose) {
      return target < pose.weights(node).size() ? pose.weights(node)[target] : 0.0;
    };
    return std::abs(weight(decoded_) - weight(original_));
  }

  const Skeleton* skeleton_;
  PoseReader original_, decoded_;
  std::vector<MorphReach> morphs_;
  std::vector<glm::dmat4> difference_;
  std::vector<int> moving_, rotating_, morphing_;
};

/// Mean, percentile and jitter over some of the points.
class SampledPoints {
 public:
  SampledPoints(const Points& points, std::size_t times) : points_(&points) {
    const std::size_t wanted =
        std::clamp(most_sampled_values / std::max<std::size_t>(times, 1), fewest_sampled_points, most_sampled_points);
    const std::size_t count = std::min(points.size(), wanted);
    for (std::size_t i = 0; i < count; ++i) picked_.push_back(i * points.size() / count);
    before_.resize(count);
    last_.resize(count);
    errors_.reserve(count * times);
  }

  void add(std::span<const glm::dmat4> difference, bool key) {
    for (std::size_t i = 0; i < picked_.size(); ++i) {
      const glm::dvec3 vector = point_error(*points_, picked_[i], difference);
      const double error = number_or_infinity(glm::length(vector));
      sum_ += error;
      errors_.push_back(static_cast<float>(error));
      if (!key) continue;
      if (keys_ >= 2) {
        const glm::dvec3 second = vector - 2.0 * last_[i] + before_[i];
        squares_ += number_or_infinity(glm::dot(second, second));
      }
      before_[i] = last_[i];
      last_[i] = vector;
    }
    if (key) ++keys_;
  }

  void report(ErrorReport& report) {
    if (errors_.empty()) return;
    report.mean = sum_ / static_cast<double>(errors_.size());
    const std::size_t rank = errors_.size() - errors_.size() / 100 - 1;
    const auto place = errors_.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(errors_.begin(), place, errors_.end());
    report.percentile_99 = *place;
    if (keys_ > 2) report.jitter = std::sqrt(squares_ / static_cast<double>((keys_ - 2) * picked_.size()));
  }

 private:
  const Points* points_;
  std::vector<std::size_t> picked_;
  std::vector<glm::dvec3> before_, last_;  ///< error vectors at the last two keys
  std::vector<float> errors_;
  double sum_ = 0.0, squares_ = 0.0;
  std::size_t keys_ = 0;
};

double largest_side(const std::vector<glm::dvec3>& positions) {
  if (positions.empty()) return 0.0;
  glm::dvec3 low = positions.front(), high = low;
  for (const glm::dvec3& p : positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 side = high - low;
  return std::max({side.x, side.y, side.z});
}

/// Point errors are linear in the matrices: the change of an error vector is the error vector of their change.
std::vector<glm::dmat4> minus(std::span<const glm::dmat4> a, std::span<const glm::dmat4> b) {
  std::vector<glm::dmat4> result(a.begin(), a.end());
  for (std::size_t i = 0; i < result.size(); ++i) result[i] -= b[i];
  return result;
}

}  // namespace

double character_size(const Skeleton& skeleton, const Points& points) {
  std::vector<glm::dmat4> world(skeleton.size());
  world_matrices(skeleton, skeleton.rest_matrix, world);
  std::vector<glm::dvec3> positions;
  for (const int joint : skeleton.joints) positions.emplace_back(world[at(joint)][3]);
  if (skeleton.joints.empty()) {
    for (std::size_t p = 0; p < points.size(); ++p) positions.push_back(point_error(points, p, world));
  }
  const double size = largest_side(positions);
  return size > 0.0 ? size : 1.0;
}

ErrorMeter::ErrorMeter(const Skeleton& skeleton, const Points& points)
    : skeleton_(&skeleton), points_(&points), search_(points), size_(character_size(skeleton, points)) {}

ErrorReport ErrorMeter::report(const Animation& original, const Animation& decoded) const {
  const std::vector<SampleTime> samples = sample_times(original);
  Comparison comparison(*skeleton_, *points_, original, decoded);
  SampledPoints sampled(*points_, samples.size());
  ErrorReport report;
  WorstPoint worst;
  MorphError worst_morph;
  std::vector<glm::dmat4> first;
  std::vector<ContactDrift> drifts(skeleton_->joints.size());
  for (const SampleTime& sample : samples) {
    comparison.read(sample.seconds);
    if (first.empty()) first.assign(comparison.difference().begin(), comparison.difference().end());
    search_.raise(comparison.difference(), worst);
    comparison.raise_morph(worst_morph);
    if (std::max(worst.error, worst_morph.error) > report.max) {
      const bool morph = worst_morph.error > worst.error;
      report.max = morph ? worst_morph.error : worst.error;
      report.max_seconds = sample.seconds;
      report.max_node =
          morph ? worst_morph.node : points_->influences[at(leading_influence(*points_, at(worst.point)))].node;
    }
    comparison.raise_joint(report.max_joint);
    comparison.raise_rotation(report.max_rotation_degrees);
    comparison.raise_weight(report.max_morph_weight);
    sampled.add(comparison.difference(), sample.key);
    if (sample.key) comparison.add_drift(sample.seconds, size_, drifts);
  }
  for (const ContactDrift& drift : drifts) raise(report.contact_drift, drift.largest());
  if (samples.size() > 1 && is_loop(original, samples.front().seconds, samples.back().seconds)) {
    WorstPoint seam;
    search_.raise(minus(comparison.difference(), first), seam);
    report.loop_seam = seam.error;
  }
  sampled.report(report);
  return report;
}

bool ErrorMeter::is_loop(const Animation& animation, double first_seconds, double last_seconds) const {
  Comparison ends(*skeleton_, *points_, animation, animation);
  ends.read(first_seconds, last_seconds);
  WorstPoint worst;
  search_.raise(ends.difference(), worst);
  MorphError morph;
  ends.raise_morph(morph);
  return std::max(worst.error, morph.error) <= loop_gap * size_;
}

double ErrorMeter::error_at(const Animation& original, const Animation& decoded,
                            std::span<const double> seconds) const {
  Comparison comparison(*skeleton_, *points_, original, decoded);
  WorstPoint worst;
  MorphError morph;
  for (const double at_seconds : seconds) {
    comparison.read(at_seconds);
    search_.raise(comparison.difference(), worst);
    comparison.raise_morph(morph);
  }
  return std::max(worst.error, morph.error);
}

ErrorProfile ErrorMeter::profile(const Animation& original, const Animation& decoded, int threads) const {
  const std::vector<SampleTime> samples = sample_times(original);
  ErrorProfile profile;
  profile.seconds.resize(samples.size());
  profile.max_error.resize(samples.size());
  profile.worst_point.resize(samples.size());
  std::transform(samples.begin(), samples.end(), profile.seconds.begin(),
                 [](const SampleTime& s) { return s.seconds; });
  renew(profile, std::vector<bool>(samples.size(), true), original, decoded, threads);
  return profile;
}

void ErrorMeter::renew(ErrorProfile& profile, const std::vector<bool>& stale, const Animation& original,
                       const Animation& decoded, int threads) const {
  constexpr std::size_t part = 512;  // times that one thread looks at in a row: the worst place moves slowly
  const std::size_t count = profile.seconds.size();
  parallel_for((count + part - 1) / part, threads, [&](std::size_t k) {
    const auto first = stale.begin() + static_cast<std::ptrdiff_t>(k * part);
    const auto last = stale.begin() + static_cast<std::ptrdiff_t>(std::min(count, (k + 1) * part));
    if (std::find(first, last, true) == last) return;
    Comparison comparison(*skeleton_, *points_, original, decoded);
    WorstPoint worst;
    for (std::size_t n = k * part; n < std::min(count, (k + 1) * part); ++n) {
      if (!stale[n]) continue;
      comparison.read(profile.seconds[n]);
      worst = {0.0, -1, worst.cluster};
      search_.raise(comparison.difference(), worst);
      MorphError morph;
      comparison.raise_morph(morph);
      profile.max_error[n] = std::max(worst.error, morph.error);
      profile.worst_point[n] = morph.error > worst.error ? -1 : worst.point;
    }
  });
}

ErrorReport measure_error(const Skeleton& skeleton, const Points& points, const Animation& original,
                          const Animation& decoded) {
  return ErrorMeter(skeleton, points).report(original, decoded);
}

ErrorProfile error_profile(const Skeleton& skeleton, const Points& points, const Animation& original,
                           const Animation& decoded) {
  return ErrorMeter(skeleton, points).profile(original, decoded);
}

}  // namespace nmc::motion
