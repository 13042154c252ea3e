// Curves of projected coefficients as control points of Catmull-Rom splines in few bits (Lin et al. 2011, sections 5.1
// and 5.2).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "baselines/bytes.h"

namespace nmc::baselines {

/// Equation 8: the bits with which a uniform quantiser of `range` has an expected error of at most `expected` (a
/// quarter of its step); 0 to 16.
int bits_for(double range, double expected);

/// Equation 7 and its inverse: the level of a value above `low`, of 2^bits over `range`, and the middle of that level.
unsigned quantize(double value, double low, double range, int bits);
double dequantize(unsigned level, double low, double range, int bits);

/// How curves are fitted and rounded.
struct CurveSettings {
  Eigen::Index span = 8;  ///< samples between regular control points
  double threshold = 0;   ///< of the fit
  double expected = 0;    ///< error of rounding
  int base_bits = 8;      ///< of each curve's lowest value
  int uniform_bits = 0;   ///< not 0: so many for every axis, over the range of the group's widest one, without bases
};

/// The bytes of curves, by what they are, so that the lossless back end sees like beside like.
struct CurveStreams {
  ByteWriter ranges, points, small, large;
};
struct CurveReaders {
  ByteReader ranges, points, small, large;
};

/// What the curves of one axis used.
struct CurveCounts {
  double bits = 0;  ///< summed over values
  std::size_t values = 0;
};

/// Writes the curves of one axis (one per clip) and returns what the decoder reads. `widest`: the range of the widest
/// axis, for uniform bits.
std::vector<Eigen::VectorXd> write_curves(CurveStreams& streams, const std::vector<Eigen::VectorXd>& curves,
                                          const CurveSettings& settings, double widest, CurveCounts& counts);
std::vector<Eigen::VectorXd> read_curves(CurveReaders& readers, const std::vector<Eigen::Index>& lengths,
                                         Eigen::Index span);

}  // namespace nmc::baselines
