// Principal geodesic analysis with inverse kinematics (Tournier et al. 2009, as Lin et al. 2011 describe it): only the
// ways of root and end effectors are stored; decoding finds the poses.
#pragma once

#include "baselines/markers.h"
#include "baselines/method.h"
#include "baselines/root_alignment.h"

namespace nmc::baselines {

/// Lengths in world units.
struct PgaSettings {
  double covered = 0;           ///< share of the variance of rotations that axes cover; 0: by `residual_radians`
  double residual_radians = 0;  ///< root mean square per joint that axes leave out
  double way = 0;               ///< of the splines of root and end effectors
  double expected = 0;          ///< of the rounding of end effectors
};

struct PgaCounts {
  int axes = 0;
  int end_effectors = 0;
};

class PgaEncoder : public Encoder {
 public:
  explicit PgaEncoder(const codec::Source& source);

  Bytes encode(double knob) override;
  Bytes encode(const PgaSettings& settings, PgaCounts* counts = nullptr) const;

 private:
  const codec::Source& source_;
  MotionData data_;
};

std::unique_ptr<Encoder> prepare_pga_ik(const codec::Source& source, const EncodeSettings& settings);
std::vector<motion::Clip> decode_pga_ik(std::span<const std::uint8_t> bytes, const motion::Skeleton& skeleton);

}  // namespace nmc::baselines
