// Adaptive motion data representation with repeated motion analysis: Lin, Peng, Lin and Tsai 2011.
#pragma once

#include "baselines/behaviour_segments.h"
#include "baselines/markers.h"
#include "baselines/method.h"
#include "baselines/repeated_motion.h"
#include "baselines/root_alignment.h"

namespace nmc::baselines {

/// Lengths in world units; of coefficients they are those along an axis.
struct RmaSettings {
  double covered = 0;            ///< share of variance that axes cover (the paper: 0.95, 0.98); 0: by `residual`
  double residual = 0;           ///< root mean square per marker that axes leave out
  double curve = 0;              ///< of the splines
  double expected_primary = 0;   ///< of rounding, primary and unique clips (the paper: 5 mm)
  double expected_repeated = 0;  ///< repeated clips (the paper: 6 mm)
  int uniform_primary = 0;       ///< not 0: uniform quantisation in so many bits (table 4)
  int uniform_repeated = 0;
  double root = 0;          ///< of the root's splines
  double contact_step = 0;  ///< of contacts' ways (the paper: 4 bits up to 25 mm)
  int axis_bits = 12;       ///< of elements of axes
};

/// What an encoding used (tables 1 to 4).
struct RmaCounts {
  double mean_axes = 0;                                            ///< over groups, weighted by their frames
  double primary_bits = 0, repeated_bits = 0;                      ///< mean of coded values
  double primary_share = 0, unique_share = 0, repeated_share = 0;  ///< of frames
  int groups = 0;
};

class RmaEncoder : public Encoder {
 public:
  explicit RmaEncoder(const codec::Source& source);

  /// Everything in the paper's proportions.
  Bytes encode(double knob) override;
  Bytes encode(const RmaSettings& settings, RmaCounts* counts = nullptr) const;

 private:
  struct Group {
    std::vector<std::pair<Eigen::Index, Eigen::Index>> ranges;  ///< first, end in all frames one after the other
    std::vector<ClipPart> clips;                                ///< in the group's own frames
  };
  Bytes body(const RmaSettings& settings, RmaCounts& counts) const;

  const codec::Source& source_;
  MotionData data_;
  std::vector<Eigen::MatrixXd> markers_;  ///< per clip, world
  std::vector<RootMotion> roots_;
  std::vector<Eigen::Index> frames_;  ///< per clip
  std::vector<Group> groups_;
};

std::unique_ptr<Encoder> prepare_rma(const codec::Source& source, const EncodeSettings& settings);
std::vector<motion::Clip> decode_rma(std::span<const std::uint8_t> bytes, const motion::Skeleton& skeleton);

}  // namespace nmc::baselines
