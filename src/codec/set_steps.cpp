#include "codec/set_steps.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "codec/motion_map.h"
#include "motion/pose_parameters.h"

namespace nmc::codec {
namespace {

/// Sums over clips and samples of a slot's squared reach.
struct ReachSum {
  double square = 0;
  double samples = 0;
  double mean() const { return samples > 0 ? std::sqrt(square / samples) : 0.0; }
};

const Bound& bound_of(const Source& source, const std::vector<std::size_t>& clips) {
  return source.bounds[source.clips[clips.front()].bound];
}

/// Evenly spaced samples of a clip, enough to know how far its points are from its joints.
Eigen::MatrixXd some_samples(const Eigen::MatrixXd& values) {
  constexpr Eigen::Index fewest = 16, most = 256, share = 8;
  const Eigen::Index samples = values.cols();
  const Eigen::Index count = std::min(samples, std::clamp(samples / share, fewest, most));
  Eigen::MatrixXd some(values.rows(), count);
  for (Eigen::Index n = 0; n < count; ++n) some.col(n) = values.col(n * samples / count);
  return some;
}

/// Per target and slot: how far a unit moves the farthest point.
std::vector<std::vector<double>> slot_reaches(const Source& source, const std::vector<std::size_t>& clips,
                                              const SetFrame& frame, int threads) {
  std::vector<std::vector<ReachSum>> sums;
  for (const NodeTarget& target : frame.targets) sums.emplace_back(static_cast<std::size_t>(target.width));
  const Points& points = points_of(source, bound_of(source, clips));
  std::vector<ClipLayout> layouts(clips.size());
  std::vector<Eigen::VectorXd> reaches(clips.size());
  parallel_for(layouts.size(), threads, [&](std::size_t c) {
    layouts[c] = layout_clip(source.clips[clips[c]].clip, frame);
    MotionMap map(source.skeleton, frame, layouts[c], points, layouts[c].values, FreeParameters::all);
    map.linearise(some_samples(layouts[c].values));
    reaches[c] = map.reach();
  });
  for (std::size_t c = 0; c < layouts.size(); ++c)
    for (std::size_t i = 0; i < layouts[c].parameters.size(); ++i) {
      const Parameter& parameter = layouts[c].parameters[i];
      ReachSum& sum = sums[parameter.target][static_cast<std::size_t>(parameter.axis)];
      const double samples = static_cast<double>(layouts[c].values.cols());
      const double reach = reaches[c](static_cast<Eigen::Index>(i));
      sum.square += samples * reach * reach;
      sum.samples += samples;
    }
  std::vector<std::vector<double>> means;
  for (const std::vector<ReachSum>& target : sums) {
    means.emplace_back();
    for (const ReachSum& sum : target) means.back().push_back(sum.mean());
  }
  return means;
}

int step_exponent(double reach, Path path, double size) {
  const double least = path == Path::translation ? 1e-3 : 0.01 * size;
  return std::clamp(static_cast<int>(std::lround(2 * std::log2(std::max(reach, least) / size))), -100, 100);
}

std::int32_t to_level(double value, double step) { return static_cast<std::int32_t>(std::lround(value / step)); }

/// Writes the reference pose of target t in whole steps, and makes the frame's the same.
void quantise_reference(const ClipSet& set, SetTarget& made, std::size_t t, SetFrame& frame) {
  if (made.path == Path::rotation) {
    const glm::dvec3 v = motion::rotation_vector(frame.rotation_reference[t]);
    glm::dvec3 quantised(0.0);
    for (int a = 0; a < 3; ++a) {
      const double step = anchor_step(set, made, a);
      made.reference.push_back(to_level(v[a], step));
      quantised[a] = static_cast<float>(static_cast<float>(made.reference.back()) * step);
    }
    frame.rotation_reference[t] = motion::rotation_of_vector(quantised);
    return;
  }
  for (int a = 0; a < made.width; ++a) {
    const double step = anchor_step(set, made, a), usual = made.path == Path::scale ? 1.0 : 0.0;
    double& value = frame.value_reference[t][static_cast<std::size_t>(a)];
    made.reference.push_back(to_level(value - usual, step));
    value = usual + made.reference.back() * step;
  }
}

}  // namespace

SharedPart make_shared_part(const Source& source, const std::vector<std::size_t>& clips, int anchor_exponent,
                            int threads) {
  std::vector<const motion::Clip*> motions;
  for (const std::size_t i : clips) motions.push_back(&source.clips[i].clip);
  SharedPart shared{mean_frame(source.skeleton, motions), {}};
  const std::vector<std::vector<double>> reaches = slot_reaches(source, clips, shared.frame, threads);
  ClipSet& set = shared.set;
  set.base_step = static_cast<float>(bound_of(source, clips).tolerance / source.size);
  set.anchor_exponent = anchor_exponent;
  for (std::size_t t = 0; t < shared.frame.targets.size(); ++t) {
    const NodeTarget& target = shared.frame.targets[t];
    SetTarget made{target.path, target.width, {}, {}, {}};
    for (const double reach : reaches[t]) made.step_exponents.push_back(step_exponent(reach, target.path, source.size));
    if (target.path == Path::rotation) made.step_exponents[3] = made.step_exponents[2];  // the format stores three
    quantise_reference(set, made, t, shared.frame);
    set.targets.push_back(std::move(made));
  }
  return shared;
}

ParameterSteps steps_for(const ClipSet& set, const ClipLayout& layout) {
  const auto count = static_cast<Eigen::Index>(layout.parameters.size());
  ParameterSteps steps{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Parameter& parameter = layout.parameters[static_cast<std::size_t>(i)];
    steps.slot(i) = slot_step(set, set.targets[parameter.target], parameter.axis);
    steps.anchor(i) = anchor_step(set, set.targets[parameter.target], parameter.axis);
  }
  return steps;
}

}  // namespace nmc::codec
