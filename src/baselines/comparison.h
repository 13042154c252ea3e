// All methods on one source: the fewest bytes of each at some tolerances, and its curve of error over bytes.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/progress.h"
#include "baselines/method.h"
#include "motion/error.h"

namespace nmc::baselines {

/// One encoding of all clips, judged by decoding its bytes. Errors in world units.
struct Encoding {
  double knob = 0;
  Bytes bytes;
  double max_error = 0;       ///< at joints and skin points
  double max_joint = 0;       ///< at joints alone
  double mean_error = 0;      ///< over all points (motion::ErrorReport) and clips, weighted by their frames
  double encode_seconds = 0;  ///< of one thread
  double decode_seconds = 0;
};

struct MethodResult {
  const Method* method = nullptr;
  std::vector<Encoding> curve;                   ///< all that was made, from coarse to fine knobs
  std::vector<std::optional<std::size_t>> best;  ///< per tolerance: the fewest bytes within it, an index into `curve`
  std::string failure;                           ///< why there is nothing, where the method does not take this motion
};

struct Comparison {
  std::vector<double> tolerances;  ///< shares of size, as given
  std::vector<MethodResult> methods;
  std::size_t clips = 0;
  std::size_t frames = 0;
  double size = 1;  ///< world units
};

struct CompareOptions {
  std::vector<const Method*> methods;
  std::vector<double> tolerances;  ///< shares of size, above 0
  int effort = 5;
  int threads = 0;  ///< 0: all; the result (but for times) does not depend on it
  Progress progress;
};

/// Methods that keep a bound by themselves are asked once per tolerance; with the others the knob is bisected, in
/// the logarithm, to a sixteenth of an octave, and of all encodings within the tolerance the smallest counts.
Comparison compare(const codec::Source& source, const CompareOptions& options);

/// Decodes and measures.
Encoding judge(const codec::Source& source, const motion::ErrorMeter& meter, const Method& method, Bytes bytes);

}  // namespace nmc::baselines
