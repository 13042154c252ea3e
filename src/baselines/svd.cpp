// Low-rank SVD of the pose matrix: Tojo et al. 2022, section 4.1.
#include <algorithm>

#include "base/parallel.h"
#include "base/symmetric_eigen.h"
#include "baselines/bounded_search.h"
#include "baselines/pose_matrix.h"
#include "baselines/simple_methods.h"
#include "motion/error.h"

namespace nmc::baselines {
namespace {

struct Factors {
  PoseForms forms;
  Eigen::MatrixXf left;   ///< rows x rank
  Eigen::MatrixXf right;  ///< frames x rank; one of the two holds the singular values
};

Eigen::MatrixXd product(const Factors& factors, int rank) {
  return (factors.left.leftCols(rank) * factors.right.leftCols(rank).transpose()).cast<double>();
}

/// The singular vectors of one side are the eigenvectors of the matrix times its transpose; of the two products the
/// smaller one. Projected on these, the matrix gives the other side, the largest values first.
void decompose(const Eigen::MatrixXd& poses, Factors& factors) {
  if (poses.rows() <= poses.cols()) {
    const Eigen::MatrixXd left = symmetric_eigen(poses * poses.transpose()).vectors.rowwise().reverse();
    factors.left = left.cast<float>();
    factors.right = (poses.transpose() * left).cast<float>();
  } else {
    const Eigen::MatrixXd right = symmetric_eigen(poses.transpose() * poses).vectors.rowwise().reverse();
    factors.left = (poses * right).cast<float>();
    factors.right = right.cast<float>();
  }
}

class SvdEncoder : public Encoder {
 public:
  SvdEncoder(const codec::Source& source, const EncodeSettings& settings)
      : source_(source), threads_(settings.threads), data_(motion_data(source)) {
    factors_.resize(data_.clips.size());
    parallel_for(factors_.size(), threads_, [&](std::size_t i) {
      Factors& f = factors_[i];
      f.forms = pose_forms(source_.skeleton, data_.head, data_.clips[i]);
      const Eigen::MatrixXd poses = to_pose_matrix(source_.skeleton, data_.head, f.forms, data_.clips[i]);
      if (poses.size() == 0) return;
      decompose(poses, f);
    });
  }

  Bytes encode(double knob) override {
    const motion::ErrorMeter meter(source_.skeleton, source_.all_points);
    std::vector<int> ranks(factors_.size());
    parallel_for(factors_.size(), threads_, [&](std::size_t i) {
      const auto full = static_cast<int>(factors_[i].left.cols());
      ranks[i] = coarsest_setting(0, full, [&](int rank) {
        const Eigen::MatrixXd values =
            from_pose_matrix(source_.skeleton, data_.head, factors_[i].forms, product(factors_[i], rank));
        return largest_error(source_, meter, i, to_clip(data_.head, i, values)) <= knob * source_.size;
      });
    });
    ByteWriter bytes;
    write_head(bytes, data_.head);
    for (std::size_t i = 0; i < factors_.size(); ++i) write(bytes, factors_[i], ranks[i]);
    return bytes.take();
  }

 private:
  static void write(ByteWriter& bytes, const Factors& factors, int rank) {
    write_forms(bytes, factors.forms);
    bytes.count(static_cast<std::uint64_t>(rank));
    for (int k = 0; k < rank; ++k) {
      for (const float x : factors.left.col(k)) bytes.f32(static_cast<double>(x));
      for (const float x : factors.right.col(k)) bytes.f32(static_cast<double>(x));
    }
  }

  const codec::Source& source_;
  int threads_;
  MotionData data_;
  std::vector<Factors> factors_;
};

}  // namespace

std::unique_ptr<Encoder> prepare_svd(const codec::Source& source, const EncodeSettings& settings) {
  return std::make_unique<SvdEncoder>(source, settings);
}

std::vector<motion::Clip> decode_svd(std::span<const std::uint8_t> input, const motion::Skeleton& skeleton) {
  ByteReader bytes(input);
  const Head head = read_head(bytes, skeleton);
  std::vector<Eigen::MatrixXd> clips;
  for (const std::vector<float>& times : head.times) {
    Factors factors;
    factors.forms = read_forms(bytes, head);
    const auto frames = static_cast<Eigen::Index>(times.size());
    const auto rank = static_cast<Eigen::Index>(
        bytes.count(static_cast<std::uint64_t>(std::min<Eigen::Index>(frames, factors.forms.rows))));
    if (bytes.left() / 4 < static_cast<std::size_t>(rank * (frames + factors.forms.rows)))
      refuse_damaged("it ends too early");
    factors.left.resize(factors.forms.rows, rank);
    factors.right.resize(frames, rank);
    for (Eigen::Index k = 0; k < rank; ++k) {
      for (float& x : factors.left.col(k)) x = bytes.f32();
      for (float& x : factors.right.col(k)) x = bytes.f32();
    }
    clips.push_back(from_pose_matrix(skeleton, head, factors.forms, product(factors, static_cast<int>(rank))));
  }
  bytes.expect_end();
  return to_clips(head, clips);
}

}  // namespace nmc::baselines
