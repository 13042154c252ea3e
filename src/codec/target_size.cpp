#include "codec/target_size.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"

namespace nmc::codec {
namespace {

constexpr double finest = 1e-5, coarsest = 0.5;  // of the character's size
constexpr int most_rounds = 9;
constexpr double near_enough = 0.97;   // of the bytes asked for
constexpr double usual_slope = -0.45;  // of log bytes over log tolerance

/// A tolerance that was tried, both as logarithms.
struct Tried {
  double tolerance = 0;
  double bytes = 0;
};

/// Where a line through what is known, inside the bracket, meets the bytes.
double next_guess(const std::optional<Tried>& too_large, const std::optional<Tried>& fits, double bytes) {
  const auto along = [&](const Tried& from, double slope) { return from.tolerance + (bytes - from.bytes) / slope; };
  const double low = too_large ? too_large->tolerance : std::log(finest);
  const double high = fits ? fits->tolerance : std::log(coarsest);
  double guess = 0.5 * (low + high);
  if (too_large && fits && fits->bytes < too_large->bytes)
    guess = along(*fits, (fits->bytes - too_large->bytes) / (fits->tolerance - too_large->tolerance));
  else if (fits)
    guess = along(*fits, usual_slope);
  else if (too_large)
    guess = along(*too_large, usual_slope);
  const double margin = too_large && fits ? 0.1 * (high - low) : 0;
  return std::clamp(guess, low + margin, high - margin);
}

}  // namespace

std::size_t animation_bytes(const CompressResult& result) {
  std::size_t bytes = 0;
  for (const ClipResult& clip : result.clips) bytes += clip.keys_after + clip.json_after;
  return bytes;
}

CompressResult compress_to_size(const gltf::Document& document, CompressOptions options, std::size_t bytes) {
  const Progress progress = std::move(options.progress);
  const double wanted = std::log(static_cast<double>(bytes));
  std::optional<Tried> too_large, fits;
  std::optional<CompressResult> best;
  double guess = std::log(options.tolerance.value);
  for (int round = 0; round < most_rounds; ++round) {
    if (progress)
      options.progress = [&, round](double fraction, std::string_view what) {
        progress((round + fraction) / most_rounds, what);
      };
    options.tolerance = {std::exp(guess), Tolerance::Unit::fraction_of_size};
    CompressResult result = compress(document, options);
    const std::size_t size = animation_bytes(result);
    const Tried tried{guess, std::log(static_cast<double>(std::max<std::size_t>(size, 1)))};
    if (size > bytes) {
      if (guess >= std::log(coarsest))
        throw Error(ErrorCode::usage, "--target-size: the animations of " + document.name + " need " +
                                          std::to_string(size) + " bytes even at a tolerance of 50%.");
      too_large = tried;
    } else {
      fits = tried;
      best = std::move(result);
      if (static_cast<double>(size) >= near_enough * static_cast<double>(bytes) || guess <= std::log(finest)) break;
    }
    // The last rounds find something that fits, whatever it is.
    const bool last_chance = !best && round + 2 >= most_rounds;
    guess = last_chance ? std::log(coarsest) : next_guess(too_large, fits, wanted);
    if (too_large && fits && fits->tolerance - too_large->tolerance < 0.005) break;
  }
  return std::move(*best);
}

}  // namespace nmc::codec
