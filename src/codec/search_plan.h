// What the search for one clip tries, by effort: how long it trains, and which bases and windows it begins with.
#pragma once

#include <vector>

#include "codec/prepared_clip.h"
#include "codec/sparse_training.h"

namespace nmc::codec {

struct SearchPlan {
  int first_iterations = 100;  ///< of the first training of each cut
  int iterations = 100;        ///< of each later one, which starts where the best one ended
  int trials = 8;              ///< later trainings
  int last_iterations = 0;     ///< of one more at the best settings
  bool prunes = true;          ///< takes from what is within the bound what the bound can do without
  /// Of the fewest bytes that a cut was trained to, up to which a cut is corrected: more hardly ever ends as less.
  double worth_correcting = 1.2;
  int first_exponent = 1;   ///< SparseSettings::step_exponent of the first trainings
  double first_rate = 0.2;  ///< SparseSettings::rate of the first trainings
  /// Only one cut is trained, at steps that suit the tolerance: which, rounding without training tells.
  bool guesses = false;
};

/// For a search on all of a clip.
SearchPlan plan_of(int effort, Eigen::Index samples);

/// For a search on an excerpt; `last_iterations` are those that the whole clip's last training has more.
SearchPlan excerpt_plan_of(int effort, Eigen::Index turns);

/// Samples of the excerpt that settings are searched on; 0: they are searched on all of the clip.
Eigen::Index excerpt_samples(int effort, Eigen::Index samples);

/// The efforts whose searches one of this effort makes.
std::vector<int> efforts_of(int effort);

/// Bases and windows worth trying for a clip, without steps and rate. Most clips with jumps are smaller when these are
/// taken out first.
std::vector<SparseSettings> cuts_of(const SearchContext& context, const PreparedClip& clip, int effort);

}  // namespace nmc::codec
