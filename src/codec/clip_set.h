// A clip set as the encoder holds it: every number of a stream as whole levels, before it is written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/animation.h"

namespace nmc::codec {

/// How a clip holds a target (nmc_decode.h, NMC_ABSENT ...).
enum class State : std::uint8_t { absent = 0, fixed = 1, moving = 2, quaternion = 3 };

/// A clip's features (nmc_decode.h, NMC_COSINE ...).
enum class Basis : std::uint8_t { cosine = 0, periodic = 1, sine = 2 };

constexpr const char* basis_name(Basis basis) {
  return basis == Basis::cosine ? "cosine" : basis == Basis::periodic ? "periodic" : "sine";
}

/// A target of the set. A rotation has four slots: three for rotation vectors, four for quaternions.
struct SetTarget {
  Path path = Path::translation;
  int width = 3;                    ///< slots
  std::vector<int> step_exponents;  ///< per slot: step = base_step * 2^(-exponent / 2)
  std::vector<std::int32_t>
      reference;  ///< per slot, in anchor steps; a rotation vector (3 used), else value minus default
  std::vector<float> exact_reference;  ///< instead of `reference` where the set has exact references
};

struct LevelWeight {
  int feature = 1;    ///< j, from 1
  int parameter = 0;  ///< index among the clip's parameters
  std::int32_t level = 0;
};

/// Weights of one window, sorted by parameter, then feature.
struct LevelWindow {
  std::uint32_t begin = 0;
  std::uint32_t length = 1;
  std::vector<LevelWeight> weights;
};

struct LevelAtom {
  std::uint32_t sample = 0;
  int parameter = 0;
  int width = 0;  ///< half-width 2^width samples, or jump_width
  std::int32_t level = 0;

  static constexpr int jump_width = 17;             ///< a jump between this sample and the one before
  static constexpr double largest_level = 8388607;  ///< of a stream
};

/// A network's clip layer (paper: W0, b0 and Omega).
struct ClipLayer {
  std::vector<int> half_cycles;
  std::vector<float> w0;  ///< hidden0 x (2K + 1), column by column
  std::vector<float> b0;
};

struct LevelClip {
  std::vector<float> times;
  Basis basis = Basis::cosine;
  std::vector<State> states;  ///< per target
  int reference = -1;         ///< earlier clip whose last anchor pose predicts the first, or -1
  int step_exponent = 0;
  std::vector<std::int32_t> anchors;  ///< rows x parameters; 1 row (cosine), 2 (periodic), windows + 1 (sine)
  std::vector<LevelWindow> windows;
  std::vector<LevelAtom> atoms;  ///< sorted by sample
  ClipLayer layer;               ///< where the set has a network
};

/// The shared layers of a network (paper: W1, b1, W2, b2), column by column.
struct SharedLayers {
  int hidden0 = 0;
  int hidden1 = 0;
  int outputs = 0;
  std::vector<float> w1, b1, w2, b2;
};

struct ClipSet {
  bool exact_references = false;
  bool has_network = false;
  bool quantized_network = false;  ///< tensors end with one more number, their step; the others are whole levels
  float base_step = 1.0f;
  int anchor_exponent = 0;
  std::vector<SetTarget> targets;
  std::vector<LevelClip> clips;
  SharedLayers shared;
};

/// Numbers that a clip stores per pose for a target.
int parameter_count(const SetTarget& target, State state);

/// The bits of a payload by part, as in NMC_PART_.
struct PartBits {
  double header = 0, references = 0, times = 0, states = 0, anchors = 0, weights = 0, atoms = 0, network = 0;
  double total() const { return header + references + times + states + anchors + weights + atoms + network; }
};

/// The stream of a clip set (header, checksum, payload). Throws Error (unsupported) where the set exceeds the format's
/// limits.
std::vector<std::uint8_t> write_clip_set(const ClipSet& set);

/// Ideal code lengths of the payload, without writing it.
PartBits count_bits(const ClipSet& set);

/// Steps as the decoder computes them. Atoms are in anchor steps.
double anchor_step(const ClipSet& set, const SetTarget& target, int axis);
double slot_step(const ClipSet& set, const SetTarget& target, int axis);

}  // namespace nmc::codec
