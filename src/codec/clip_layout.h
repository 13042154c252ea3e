// Which parameters a clip has in a clip set, and their values: the border between local transforms and matrices.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "codec/clip_set.h"
#include "codec/source.h"
#include "motion/pose_parameters.h"

namespace nmc::codec {

/// What the clips of a set share: targets and the pose that parameters are relative to.
struct SetFrame {
  std::vector<NodeTarget> targets;
  std::vector<glm::dquat> rotation_reference;        ///< per target; identity where it is no rotation
  std::vector<std::vector<double>> value_reference;  ///< per target, width numbers; empty for rotations
  std::vector<State> least_states;  ///< per target: what every clip that has it holds it as at least; empty: any
};

/// One number that a clip stores per pose.
struct Parameter {
  std::size_t target = 0;
  int axis = 0;
  bool moves = false;
};

/// One target of the clip with its parameters at [first, first + count).
struct LayoutBlock {
  std::size_t target = 0;
  State state = State::fixed;
  motion::Block block;
  int first_moving = -1;  ///< of its first parameter among the moving ones; -1 for a fixed target
};

struct ClipLayout {
  std::vector<State> states;        ///< per target of the set
  std::vector<LayoutBlock> blocks;  ///< present targets, in order
  std::vector<Parameter> parameters;
  std::vector<Eigen::Index> moving;  ///< the parameters of moving targets
  Eigen::MatrixXd values;  ///< parameters x samples, relative to the set's reference; constant rows for fixed targets
};

/// The mean pose of some clips as the reference of a set. Rotations: the mean over all samples; others: the mean over
/// clips of their means.
SetFrame mean_frame(const motion::Skeleton& skeleton, const std::vector<const motion::Clip*>& clips);

/// A clip's parameters in a frame.
ClipLayout layout_clip(const motion::Clip& clip, const SetFrame& frame);

/// The clip that parameters stand for (parameters x samples).
motion::Clip clip_of_parameters(const motion::Clip& clip, const SetFrame& frame, const ClipLayout& layout,
                                const Eigen::MatrixXd& values);

/// Per parameter what a change at the first sample is at the last one: -1 for a joint that has turned once around,
/// whose quaternion is minus that of the first sample; else 1.
Eigen::VectorXd end_signs(const ClipLayout& layout);

}  // namespace nmc::codec
