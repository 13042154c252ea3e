// Trains the sparse Fourier layer of one clip through kinematics, with the rate of its levels in the loss.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/clip_layout.h"
#include "codec/clip_set.h"
#include "codec/level_prices.h"
#include "codec/motion_map.h"
#include "codec/parts.h"

namespace nmc::codec {

/// Steps per parameter of a clip, in the parameter's unit, and what of it no level has to say.
struct ParameterSteps {
  Eigen::VectorXd slot;     ///< times 2^(-step_exponent / 4) sqrt(2 / window length): one level of a weight
  Eigen::VectorXd anchor;   ///< one level of an anchor or an atom
  Eigen::MatrixXd given{};  ///< parameters x samples: what a network adds to what the levels stand for; empty: nothing
};

struct SparseSettings {
  Basis basis = Basis::cosine;
  std::vector<std::uint32_t>
      boundaries;  ///< window begins and the clip's end: sample indices, first 0; end = samples - 1 (cosine: samples)
  int step_exponent = 0;
  double rate = 0.25;    ///< how much a bit weighs against error
  int iterations = 300;  ///< 0: the rounded transform
  bool loops = false;    ///< the last anchor is as far from the first as the last pose is (not with the cosine basis)
  bool jumps = false;    ///< the given atoms are in use
};

/// Where a training ended and another may start: weights before rounding.
struct TrainingState {
  int step_exponent = 0;
  std::vector<Weights> weights;  ///< per window
};

/// Rows of a clip's samples as TrainingInput takes them.
std::vector<LaneRows> in_turns(const Rows& rows, Eigen::Index turns);

/// A clip ready for training.
struct TrainingInput {
  const ClipLayout* layout = nullptr;
  const ParameterSteps* steps = nullptr;
  /// For each turn, in blocks, error rows x samples: what the rounding of fixed targets alone moves the points by.
  /// Iterations take turns: with n of them the k-th looks at samples k, k + n, k + 2 n, ...
  std::span<const LaneRows> offset{};
  std::span<const LaneRows>
      emphasis{};        ///< as `offset`, points and morph targets x samples: how much an error counts; empty: one
  double tolerance = 1;  ///< world units
  int threads = 1;
  Parts parts{};
  const std::vector<LevelAtom>* atoms = nullptr;  ///< that the clip may have from the start (codec/jumps.h); null: none
  const TrainingState* start = nullptr;           ///< of the same basis and boundaries; null: from the transform
};

struct TrainedClip {
  LevelClip levels;  ///< anchors, windows and the given atoms (times, states and reference are left to the caller)
  TrainingState state;
};

/// Trains by Adam on levels that are rounded on the way forward (straight-through), with the rate of the levels in the
/// loss. `map` is linearised anew as needed.
TrainedClip train_sparse(const TrainingInput& input, MotionMap& map, const SparseSettings& settings);

/// The level of a fixed target's parameter.
std::int32_t fixed_level(const ClipLayout& layout, const ParameterSteps& steps, Eigen::Index parameter);

/// The parameters (parameters x samples) that levels stand for.
Eigen::MatrixXd values_of_levels(const LevelClip& clip, const ParameterSteps& steps, Eigen::Index samples,
                                 int threads = 1);

}  // namespace nmc::codec
