// A source's motion as numbers: the values of everything that moves, and the head that all methods write alike.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "baselines/bytes.h"
#include "codec/source.h"

namespace nmc::baselines {

/// A node property that some clip changes, or that holds another value than at rest.
struct Channel {
  codec::NodeTarget target;
  bool moves = false;
  int first = -1;            ///< row of its first value among those that move
  std::vector<float> value;  ///< where it does not move: the value that it has in all clips
};

/// What is known of a motion before its values: written by write_head.
struct Head {
  std::vector<Channel> channels;
  std::vector<std::vector<float>> times;  ///< per clip, seconds

  int rows() const;  ///< values per sample
};

/// Rows of values of the moving channels (rotations as x, y, z, w of unit length, sign-continuous) x samples.
struct MotionData {
  Head head;
  std::vector<Eigen::MatrixXd> clips;
};

/// What a property is where no clip animates it: width numbers.
std::vector<float> rest_value(const motion::Skeleton& skeleton, const codec::NodeTarget& target);

/// A property that a clip does not animate has its rest value there.
MotionData motion_data(const codec::Source& source);

/// Times that are within a microsecond (or what a float can tell) of a uniform grid come back as that grid.
void write_head(ByteWriter& bytes, const Head& head);

/// Throws Error (invalid_input) where it does not fit the skeleton, or is larger than 2^26 values.
Head read_head(ByteReader& bytes, const motion::Skeleton& skeleton);

/// The clips of values; rotations are normalised.
std::vector<motion::Clip> to_clips(const Head& head, const std::vector<Eigen::MatrixXd>& values);
motion::Clip to_clip(const Head& head, std::size_t clip, const Eigen::MatrixXd& values);

/// The values of clips in which nothing moves: no rows.
std::vector<Eigen::MatrixXd> no_values(const Head& head);

/// Targets as bytes, and back, checked against the skeleton.
void write_target(ByteWriter& bytes, const codec::NodeTarget& target);
codec::NodeTarget read_target(ByteReader& bytes, const motion::Skeleton& skeleton);

}  // namespace nmc::baselines
