// Clip-based PCA (Arikan 2006, as Lin et al. 2011 describe and reproduce it): Bezier clips of virtual markers,
// clustered, PCA of whole clips, 16-bit quantisation, entropy coding, contacts by inverse kinematics.
#pragma once

#include "baselines/markers.h"
#include "baselines/method.h"
#include "baselines/root_alignment.h"

namespace nmc::baselines {

/// Lengths in world units.
struct ClipPcaSettings {
  Eigen::Index frames = 24;  ///< of one clip (the paper: 200 ms at 120 Hz, 533 ms at 30 Hz)
  double covered = 0;        ///< share of variance (the paper: 0.95); 0: by `residual`
  double residual = 0;       ///< root mean square per marker and control point that axes leave out
  double root = 0;           ///< of the root's splines
  double contact_step = 0;
};

struct ClipPcaCounts {
  double mean_axes = 0;  ///< over clusters, weighted by their clips
};

/// The cubic Bezier curve nearest to some samples (a column each) that begins and ends where they do: 4 control points,
/// one under the other in a column of 4 x rows numbers.
Eigen::VectorXd fit_bezier(const Eigen::MatrixXd& samples);
Eigen::MatrixXd bezier(const Eigen::VectorXd& control, Eigen::Index rows, Eigen::Index frames);

class ClipPcaEncoder : public Encoder {
 public:
  explicit ClipPcaEncoder(const codec::Source& source);

  /// The longest clips whose Bezier curves are within the knob; the other bounds in proportion.
  Bytes encode(double knob) override;
  Bytes encode(const ClipPcaSettings& settings, ClipPcaCounts* counts = nullptr) const;

 private:
  double largest_bezier_error(Eigen::Index frames) const;

  const codec::Source& source_;
  MotionData data_;
  std::vector<Eigen::MatrixXd> markers_;  ///< per clip, world
  std::vector<Eigen::MatrixXd> aligned_;  ///< seen from the true root
  std::vector<RootMotion> roots_;
  std::vector<std::pair<Eigen::Index, double>> bezier_errors_;  ///< by length of clips, long to short
};

std::unique_ptr<Encoder> prepare_clip_pca(const codec::Source& source, const EncodeSettings& settings);
std::vector<motion::Clip> decode_clip_pca(std::span<const std::uint8_t> bytes, const motion::Skeleton& skeleton);

}  // namespace nmc::baselines
