#include "codec/clip_layout.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace nmc::codec {
namespace {

std::vector<float> all_rotations(const std::vector<const motion::Clip*>& clips, const NodeTarget& target) {
  std::vector<float> rows;
  for (const motion::Clip* clip : clips)
    if (const motion::Track* track = find_track(*clip, target))
      rows.insert(rows.end(), track->values.begin(), track->values.end());
  return rows;
}

std::vector<double> mean_value(const std::vector<const motion::Clip*>& clips, const NodeTarget& target) {
  std::vector<double> mean(static_cast<std::size_t>(target.width), 0.0);
  double count = 0;
  for (const motion::Clip* clip : clips) {
    const motion::Track* track = find_track(*clip, target);
    if (!track) continue;
    const std::size_t rows = track->values.size() / mean.size();
    for (std::size_t i = 0; i < track->values.size(); ++i)
      mean[i % mean.size()] += track->values[i] / static_cast<double>(rows);
    ++count;
  }
  for (double& m : mean) m /= count;
  return mean;
}

State state_of(const motion::Track& track, const glm::dquat& reference) {
  if (track.constant()) return State::fixed;
  if (track.path != Path::rotation) return State::moving;
  double smallest = 1;
  for (std::size_t i = 0; i + 3 < track.values.size(); i += 4)
    smallest = std::min(smallest, std::abs(reference.x * track.values[i] + reference.y * track.values[i + 1] +
                                           reference.z * track.values[i + 2] + reference.w * track.values[i + 3]));
  return 2 * std::acos(std::min(1.0, smallest)) > motion::axis_angle_limit_radians ? State::quaternion : State::moving;
}

}  // namespace

SetFrame mean_frame(const motion::Skeleton& skeleton, const std::vector<const motion::Clip*>& clips) {
  SetFrame frame;
  frame.targets = common_targets(skeleton, clips);
  for (const NodeTarget& target : frame.targets) {
    const bool rotation = target.path == Path::rotation;
    frame.rotation_reference.push_back(rotation ? motion::mean_rotation(all_rotations(clips, target)).mean
                                                : glm::dquat(1, 0, 0, 0));
    frame.value_reference.push_back(rotation ? std::vector<double>{} : mean_value(clips, target));
  }
  return frame;
}

ClipLayout layout_clip(const motion::Clip& clip, const SetFrame& frame) {
  ClipLayout layout;
  const auto samples = static_cast<Eigen::Index>(clip.times.size());
  std::vector<std::vector<double>> rows;
  for (std::size_t t = 0; t < frame.targets.size(); ++t) {
    const motion::Track* track = find_track(clip, frame.targets[t]);
    if (!track) {
      layout.states.push_back(State::absent);
      continue;
    }
    LayoutBlock made{t, state_of(*track, frame.rotation_reference[t]), {}, -1};
    if (!frame.least_states.empty()) made.state = std::max(made.state, frame.least_states[t]);
    made.block.first = static_cast<int>(layout.parameters.size());
    made.block.reference = frame.rotation_reference[t];
    made.block.width = frame.targets[t].width;
    if (frame.targets[t].path == Path::rotation) {
      made.block.form = made.state == State::quaternion ? motion::Form::quaternion : motion::Form::axis_angle;
      made.block.width = made.state == State::quaternion ? 4 : 3;
    }
    if (made.state != State::fixed) made.first_moving = static_cast<int>(layout.moving.size());
    for (int a = 0; a < made.block.width; ++a) {
      if (made.state != State::fixed) layout.moving.push_back(static_cast<Eigen::Index>(layout.parameters.size()));
      layout.parameters.push_back({t, a, made.state != State::fixed});
    }
    layout.states.push_back(made.state);
    rows.push_back(motion::to_parameters(*track, made.block));
    layout.blocks.push_back(made);
  }
  layout.values.resize(static_cast<Eigen::Index>(layout.parameters.size()), samples);
  for (std::size_t b = 0; b < layout.blocks.size(); ++b) {
    const LayoutBlock& block = layout.blocks[b];
    const int width = block.block.width;
    for (int a = 0; a < width; ++a) {
      const double reference = frame.value_reference[block.target].empty()
                                   ? 0
                                   : frame.value_reference[block.target][static_cast<std::size_t>(a)];
      for (Eigen::Index n = 0; n < samples; ++n)
        layout.values(block.block.first + a, n) =
            rows[b][static_cast<std::size_t>(std::ssize(rows[b]) == width ? a : n * width + a)] - reference;
    }
  }
  return layout;
}

motion::Clip clip_of_parameters(const motion::Clip& clip, const SetFrame& frame, const ClipLayout& layout,
                                const Eigen::MatrixXd& values) {
  motion::Clip made{clip.name, clip.times, {}};
  for (const LayoutBlock& block : layout.blocks) {
    const NodeTarget& target = frame.targets[block.target];
    const Eigen::Index samples = block.state == State::fixed ? 1 : values.cols();
    const std::vector<double>& reference = frame.value_reference[block.target];
    std::vector<double> rows;
    rows.reserve(static_cast<std::size_t>(samples * block.block.width));
    for (Eigen::Index n = 0; n < samples; ++n)
      for (int a = 0; a < block.block.width; ++a)
        rows.push_back(values(block.block.first + a, n) +
                       (reference.empty() ? 0.0 : reference[static_cast<std::size_t>(a)]));
    made.tracks.push_back(
        {target.node, target.path, target.width, motion::from_parameters(rows, block.block, target.path)});
  }
  return made;
}

Eigen::VectorXd end_signs(const ClipLayout& layout) {
  Eigen::VectorXd signs = Eigen::VectorXd::Ones(layout.values.rows());
  for (const LayoutBlock& block : layout.blocks) {
    const auto ends = layout.values.middleRows(block.block.first, block.block.width);
    if (block.state == State::quaternion && ends.col(0).dot(ends.rightCols(1).col(0)) < 0)
      signs.segment(block.block.first, block.block.width).setConstant(-1);
  }
  return signs;
}

}  // namespace nmc::codec
