// Liu and McMillan 2006: PCA of marker positions in the body's frame, of the whole motion, of its segments, and of its
// segments with key frames.
#pragma once

#include "baselines/markers.h"
#include "baselines/method.h"

namespace nmc::baselines {

enum class MarkerPcaKind {
  global = 0,     ///< one model
  piecewise = 1,  ///< one per segment, every frame stored
  segment = 2,    ///< one per segment, key frames stored
};

/// Bounds in world units, root mean square per marker. The paper's: 30, 10, 10 and 1 mm.
struct MarkerPcaSettings {
  double others = 0;         ///< what PCA leaves out of markers that are no feet
  double feet = 0;           ///< what it leaves out of feet
  double spline = 0;         ///< what key frames leave out of a frame
  double normalization = 0;  ///< the same for the three markers that give the body's frame
};

/// What an encoding used (Liu and McMillan, table 2).
struct MarkerPcaCounts {
  int segments = 0;
  double mean_axes = 0;  ///< of the larger group of markers, over segments
  int key_frames = 0;    ///< of that group
};

class MarkerPcaEncoder : public Encoder {
 public:
  MarkerPcaEncoder(const codec::Source& source, MarkerPcaKind kind);

  /// The paper's proportions: 1 : 1/3 : 1/3 : 1/30 of the knob.
  Bytes encode(double knob) override;
  Bytes encode(const MarkerPcaSettings& settings, MarkerPcaCounts* counts = nullptr) const;

 private:
  const codec::Source& source_;
  MarkerPcaKind kind_;
  MotionData data_;
  std::vector<Eigen::MatrixXd> markers_;  ///< per clip, world
  std::vector<Eigen::Index> segments_;    ///< first frames, in all clips one after the other
};

std::unique_ptr<Encoder> prepare_pca(const codec::Source& source, const EncodeSettings& settings);
std::unique_ptr<Encoder> prepare_pca_piecewise(const codec::Source& source, const EncodeSettings& settings);
std::unique_ptr<Encoder> prepare_pca_segment(const codec::Source& source, const EncodeSettings& settings);
std::vector<motion::Clip> decode_marker_pca(std::span<const std::uint8_t> bytes, const motion::Skeleton& skeleton);

}  // namespace nmc::baselines
