#include "codec/paper_profile.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "codec/clip_set.h"
#include "motion/error.h"
#include "motion/pose.h"
#include "motion/pose_parameters.h"
#include "network/adaptive_training.h"
#include "network/fourier_features.h"

namespace nmc::codec {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// One target of the clip and where its parameters stand in the pose vector.
struct PaperTarget {
  const motion::Track* track = nullptr;
  State state = State::fixed;
  motion::Block block;
};

bool moves_rotation(const motion::Clip& clip, int node) {
  const motion::Track* track = find_track(clip, {node, Path::rotation, 4});
  return track && !track->constant();
}

/// A root has no ancestor whose rotation moves (paper, section 3: the root's rotation is a quaternion).
bool is_root(const motion::Skeleton& skeleton, const motion::Clip& clip, int node) {
  for (int above = skeleton.parent[static_cast<std::size_t>(node)]; above >= 0;
       above = skeleton.parent[static_cast<std::size_t>(above)])
    if (moves_rotation(clip, above)) return false;
  return true;
}

/// The farthest joint below each node in the clip's first frame, in world units (the paper's w for rotations).
std::vector<double> reach_of_nodes(const Source& source, const motion::Clip& clip) {
  const motion::Skeleton& skeleton = source.skeleton;
  const std::vector<glm::dmat4> world = motion::world_pose(skeleton, motion::to_animation(clip), clip.times.front());
  std::vector<double> reach(skeleton.size(), 0.0);
  const auto raise = [&](int from) {
    for (int node = from; node >= 0; node = skeleton.parent[static_cast<std::size_t>(node)]) {
      const auto i = static_cast<std::size_t>(node);
      reach[i] = std::max(reach[i], glm::length(glm::dvec3(world[static_cast<std::size_t>(from)][3] - world[i][3])));
    }
  };
  if (!skeleton.joints.empty()) {
    for (const int joint : skeleton.joints) raise(joint);
    return reach;
  }
  for (const Influence& influence : source.points.influences) raise(influence.node);
  for (double& r : reach) r = std::max(r, source.size);
  return reach;
}

std::vector<PaperTarget> layout_of(const Source& source, const motion::Clip& clip,
                                   const std::vector<NodeTarget>& targets) {
  std::vector<PaperTarget> layout;
  int first = 0;
  for (const NodeTarget& target : targets) {
    PaperTarget made;
    made.track = find_track(clip, target);
    if (!made.track->constant()) {
      made.state = State::moving;
      made.block.width = target.width;
      if (target.path == Path::rotation) {
        const motion::MeanRotation mean = motion::mean_rotation(made.track->values);
        const bool as_quaternion = is_root(source.skeleton, clip, target.node) ||
                                   mean.largest_angle_radians > motion::axis_angle_limit_radians;
        made.state = as_quaternion ? State::quaternion : State::moving;
        made.block.form = as_quaternion ? motion::Form::quaternion : motion::Form::axis_angle;
        made.block.width = as_quaternion ? 4 : 3;
        // The stream holds the reference as float32: the parameters are relative to that one.
        made.block.reference = glm::dquat(static_cast<float>(mean.mean.w), static_cast<float>(mean.mean.x),
                                          static_cast<float>(mean.mean.y), static_cast<float>(mean.mean.z));
        if (as_quaternion) made.block.reference = glm::dquat(1, 0, 0, 0);
      }
      made.block.first = first;
      first += made.block.width;
    }
    layout.push_back(made);
  }
  return layout;
}

network::TrainingClip training_clip(const Source& source, const motion::Clip& clip,
                                    const std::vector<PaperTarget>& layout) {
  int size = 0;
  for (const PaperTarget& target : layout)
    if (target.state != State::fixed) size += target.block.width;
  const auto frames = static_cast<Eigen::Index>(clip.times.size());
  network::TrainingClip training{Eigen::MatrixXf(frames, size), Eigen::VectorXf(size)};
  const std::vector<double> reach = reach_of_nodes(source, clip);
  for (const PaperTarget& target : layout) {
    if (target.state == State::fixed) continue;
    const std::vector<double> values = motion::to_parameters(*target.track, target.block);
    const double weight =
        target.track->path == Path::translation ? 1.0 : reach[static_cast<std::size_t>(target.track->node)];
    for (int a = 0; a < target.block.width; ++a) {
      training.weights(target.block.first + a) = static_cast<float>(weight);
      for (Eigen::Index n = 0; n < frames; ++n)
        training.poses(n, target.block.first + a) =
            static_cast<float>(values[static_cast<std::size_t>(n * target.block.width + a)]);
    }
  }
  return training;
}

/// The clip that a network stands for.
motion::Clip clip_of(const motion::Clip& clip, const std::vector<PaperTarget>& layout, const Eigen::MatrixXf& poses) {
  motion::Clip made{clip.name, clip.times, {}};
  for (const PaperTarget& target : layout) {
    motion::Track track = *target.track;
    if (target.state != State::fixed) {
      std::vector<double> values;
      for (Eigen::Index n = 0; n < poses.rows(); ++n)
        for (int a = 0; a < target.block.width; ++a) values.push_back(poses(n, target.block.first + a));
      track.values = motion::from_parameters(values, target.block, track.path);
    }
    made.tracks.push_back(std::move(track));
  }
  return made;
}

std::vector<float> numbers(const Eigen::MatrixXf& m) { return {m.data(), m.data() + m.size()}; }

ClipSet to_clip_set(const motion::Clip& clip, const std::vector<PaperTarget>& layout,
                    const network::PoseNetwork* trained) {
  ClipSet set;
  set.exact_references = true;
  LevelClip levels;
  levels.times = clip.times;
  levels.windows = {{0, static_cast<std::uint32_t>(clip.times.size()), {}}};
  std::size_t parameters = 0;
  for (const PaperTarget& target : layout) {
    SetTarget made{target.track->path,
                   target.track->width,
                   {},
                   {},
                   std::vector<float>(static_cast<std::size_t>(target.track->width), 0.0f)};
    if (target.state == State::fixed)
      made.exact_reference = target.track->values;
    else if (made.path == Path::rotation) {
      const glm::dquat& q = target.block.reference;
      made.exact_reference = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
                              static_cast<float>(q.w)};
    }
    parameters += static_cast<std::size_t>(parameter_count(made, target.state));
    levels.states.push_back(target.state);
    set.targets.push_back(std::move(made));
  }
  levels.anchors.assign(parameters, 0);
  if (trained) {
    set.has_network = true;
    levels.layer = {trained->half_cycles, numbers(trained->W0), numbers(trained->b0)};
    const auto hidden = static_cast<int>(trained->hidden_size());
    set.shared = {hidden,
                  hidden,
                  static_cast<int>(trained->pose_size()),
                  numbers(trained->W1),
                  numbers(trained->b1),
                  numbers(trained->W2),
                  numbers(trained->b2)};
  }
  set.clips.push_back(std::move(levels));
  return set;
}

}  // namespace

int most_paper_frequencies(const Source& source, std::size_t index) {
  constexpr int most = 40;
  const motion::Clip& clip = source.clips[index].clip;
  std::size_t outputs = 0;
  for (const PaperTarget& target : layout_of(source, clip, common_targets(source.skeleton, {&clip})))
    if (target.state != State::fixed) outputs += static_cast<std::size_t>(target.block.width);
  const auto numbers_with = [outputs](int frequencies) {
    const auto inputs = static_cast<std::size_t>(2 * frequencies + 1);
    const auto hidden = static_cast<std::size_t>(network::paper_hidden_size(frequencies));
    return hidden * (inputs + 1 + hidden + 1 + outputs) + outputs;
  };
  int frequencies = 0;
  while (frequencies < most && numbers_with(frequencies + 1) <= 2 * outputs * clip.times.size()) ++frequencies;
  return frequencies;
}

PaperClip encode_paper(const Source& source, std::size_t index, const CompressOptions& options,
                       network::FrequencyChoice choice, const std::function<void(EncodedSet)>& on_network) {
  const auto start = Clock::now();
  const ClipSource& from = source.clips[index];
  const motion::Clip& clip = from.clip;
  PaperClip result;
  result.set.targets = common_targets(source.skeleton, {&clip});
  const std::vector<PaperTarget> layout = layout_of(source, clip, result.set.targets);
  const network::TrainingClip training = training_clip(source, clip, layout);
  result.values = static_cast<std::size_t>(training.poses.size());
  result.reached = true;
  result.set.clips = {index};
  result.set.frequencies = {0};
  if (training.poses.cols() == 0) {
    result.set.stream = write_clip_set(to_clip_set(clip, layout, nullptr));
    if (on_network) on_network(result.set);
  } else {
    const motion::ErrorMeter meter(source.skeleton, source.joint_points);
    const Animation original = motion::to_animation(clip);
    const Eigen::VectorXd times = network::frame_times(training.poses.rows());
    network::AdaptiveOptions adaptive;
    adaptive.choice = choice;
    adaptive.max_frequencies = options.max_frequencies;
    adaptive.threshold = source.tolerance;
    if (options.time_limit_seconds > 0) {
      const auto late = [start, limit = options.time_limit_seconds] {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > limit;
      };
      adaptive.stop_requested = adaptive.training.stop_requested = late;
    }
    const network::AdaptiveResult trained =
        network::train_adaptive(training, adaptive, [&](const network::PoseNetwork& net) {
          const Animation decoded = motion::to_animation(clip_of(clip, layout, network::evaluate(net, times)));
          const std::vector<double> errors = meter.profile(original, decoded).max_error;
          const double error = *std::max_element(errors.begin(), errors.end());
          result.steps.push_back(
              {static_cast<int>(net.half_cycles.size()), error, network::parameter_count(net), seconds_since(start)});
          if (on_network) {
            EncodedSet made{result.set.targets, write_clip_set(to_clip_set(clip, layout, &net)), {index}, {}, {}, {}};
            made.frequencies = {static_cast<int>(net.half_cycles.size())};
            made.seconds = {seconds_since(start)};
            on_network(std::move(made));
          }
          return error;
        });
    result.joint_error = trained.error;
    result.reached = trained.success;
    result.parameters = network::parameter_count(trained.network);
    result.set.frequencies = {static_cast<int>(trained.network.half_cycles.size())};
    result.set.stream = write_clip_set(to_clip_set(clip, layout, &trained.network));
  }
  result.set.seconds = {seconds_since(start)};
  result.set.candidates.resize(1);
  if (!options.record_candidates && !options.explain) return result;
  for (const PaperStep& step : result.steps)
    result.set.candidates[0].push_back(
        {step.parameters * sizeof(float), step.joint_error, false, false, "network", false});
  if (!result.set.candidates[0].empty() && result.reached)
    result.set.candidates[0].back().kept = result.set.candidates[0].back().chosen = true;
  return result;
}

}  // namespace nmc::codec
