// One candidate for a clip's levels: trained at given settings, corrected until it is within the bound, counted in
// bytes.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "codec/clip_set.h"
#include "codec/compress.h"
#include "codec/motion_map.h"
#include "codec/prepared_clip.h"
#include "codec/sparse_training.h"

namespace nmc::codec {

/// More bytes than any clip has.
inline constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

struct Trial {
  SparseSettings settings;
  std::vector<SparseSettings> earlier{};  ///< of the trainings that it goes on from
  TrainingState state{};
  LevelClip levels{};
  std::size_t bytes = unlimited;
  float usual_error = 0;          ///< after training, in units of the tolerance (finish_trial); 0: not measured
  bool kept = false;              ///< within the tolerance, by the encoder's own measurement
  std::vector<Candidate> seen{};  ///< as trained and as corrected, where that is recorded

  bool beats(const Trial& other) const { return kept != other.kept ? kept : bytes < other.bytes; }

  /// Corrections never make such a trial the smallest.
  bool is_hopeless() const { return usual_error > 1.2f; }
};

/// The clip that trials are made of; what it refers to outlives them.
struct TrialClip {
  const SearchContext& context;
  const PreparedClip& prepared;
  const ClipSource& source;
  bool records = false;  ///< Trial::seen is wanted
  /// Of the clip's samples. An excerpt, below 1, has no curves of the file: the bound is kept at its samples, whatever
  /// is between them.
  double share = 1;
};

/// What one trial at a time is made with.
struct Workbench {
  MotionMap map;
  int threads = 1;
};

Workbench make_workbench(const TrialClip& clip, int threads);

/// Trains, from the transform or from where another training ended (of the same basis and boundaries; null: none).
Trial train_trial(const TrialClip& clip, const SparseSettings& settings, const TrainingState* start, Workbench& bench);

/// As Trial::usual_error, of the levels as they are.
float usual_error(const TrialClip& clip, const LevelClip& levels, Workbench& bench);

/// Corrects a trained trial that may get below `limit` bytes and is not hopeless; takes from it what the bound can do
/// without (`prunes`).
void finish_trial(const TrialClip& clip, std::size_t limit, bool prunes, Workbench& bench, Trial& trial);

}  // namespace nmc::codec
