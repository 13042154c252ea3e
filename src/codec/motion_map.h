// From pose parameters to the points where error is seen: exact positions, and the linear map of small changes with its
// transpose.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <vector>

#include "base/points.h"
#include "codec/clip_layout.h"
#include "motion/skeleton.h"

namespace nmc::codec {

/// One component a row, one sample a column: operations on rows run over samples at vector width.
using Rows = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Pose parameters: all of a layout x some samples.
using ConstValues = Eigen::Ref<const Eigen::MatrixXd>;

/// One number per sample.
using SampleRow = Eigen::Array<float, 1, Eigen::Dynamic>;

/// Samples that a kernel works on at once, and numbers of them: one number a column.
constexpr Eigen::Index lanes = 16;
using Lanes = Eigen::Array<float, lanes, 1>;
using LaneRows = Eigen::Array<float, lanes, Eigen::Dynamic>;

/// Blocks that hold so many samples.
constexpr Eigen::Index blocks_of(Eigen::Index samples) { return (samples + lanes - 1) / lanes; }

/// Rows of numbers in blocks of samples: column block * rows + r has row r's samples of one block. What lies beyond the
/// last sample is zero.
LaneRows in_blocks(const Rows& rows);

/// The loss of training: with e a point's error in units of `tolerance` and w its emphasis, the squares e^2 weighted so
/// that their sum behaves like a p-norm (reweighted least squares; the weights count as constant in the gradient).
struct PointLoss {
  double tolerance = 1;                ///< world units
  int power = 2;                       ///< p: 2, 4 or 6
  const LaneRows* emphasis = nullptr;  ///< points and morph targets x samples, in blocks; null: one everywhere
};

/// What a training looks at: far below the bound a few points stand for all.
struct Focus {
  struct Seen {
    Eigen::Index point = 0;
    float count = 1;  ///< points that it stands for
  };
  std::vector<std::vector<Seen>> blocks;  ///< per block of samples
};

/// The blocks that samples first ... first + count - 1 lie in.
struct BlockRange {
  Eigen::Index first = 0, count = 0;

  static BlockRange of(Eigen::Index first_sample, Eigen::Index samples) {
    const Eigen::Index first = first_sample / lanes;
    return {first, (first_sample + samples - 1) / lanes - first + 1};
  }
};

/// What one unit of a free parameter does to the points that it moves.
struct Effect {
  std::vector<Eigen::Index> points;  ///< ascending; a morph target m is point_count() + m
  BlockRange blocks;
  LaneRows values;  ///< three columns (a morph target uses the first) per entry of `points`, of each block

  /// The first column of points[k] in the b-th of the blocks.
  Eigen::Index column(std::size_t k, Eigen::Index b) const {
    return 3 * (b * static_cast<Eigen::Index>(points.size()) + static_cast<Eigen::Index>(k));
  }
};

/// Which parameters of a layout a map takes as free.
enum class FreeParameters {
  moving,  ///< those of moving targets, numbered as in ClipLayout::moving; fixed targets hold the values given
  all,     ///< every parameter of the layout
};

/// The kinematics of one clip. Linear maps cost O(movers + points) per sample. They are exact to first order, but for
/// rotations and scales below a node whose scales differ from axis to axis, which are taken as if its scale was even.
class MotionMap {
 public:
  /// Takes the points that free parameters move. Fixed targets take their values from the first column of `fixed` (all
  /// parameters of the layout x at least one).
  MotionMap(const motion::Skeleton& skeleton, const SetFrame& frame, const ClipLayout& layout, const Points& points,
            const Eigen::MatrixXd& fixed, FreeParameters free = FreeParameters::moving);

  /// Rows of an error: three per point, then one per morph target.
  Eigen::Index error_rows() const { return 3 * point_count() + static_cast<Eigen::Index>(morphs_.size()); }
  Eigen::Index point_count() const { return static_cast<Eigen::Index>(first_.size()) - 1; }

  /// What has an error of its own: q counts the points, then the morph targets.
  Eigen::Index seen_count() const { return point_count() + static_cast<Eigen::Index>(morphs_.size()); }
  /// The rows of q's error: row_count(q) of them from first_row(q) on.
  Eigen::Index first_row(Eigen::Index q) const { return q < point_count() ? 3 * q : 2 * point_count() + q; }
  Eigen::Index row_count(Eigen::Index q) const { return q < point_count() ? 3 : 1; }

  /// World positions of the points (and reach times weight of morph targets) for `values` (all parameters of the layout
  /// x samples).
  Rows positions(const ConstValues& values, int threads = 1) const;

  /// Makes the linear map at these values.
  void linearise(const ConstValues& values, int threads = 1);

  /// Makes room for the linear map of so many samples, which is zero until linearise_block makes it.
  void resize(Eigen::Index samples);
  /// Makes the linear map of one block at these values, one column for each of its samples. Several threads may, of
  /// different blocks.
  void linearise_block(const ConstValues& values, Eigen::Index block);

  /// Drops the linear map and its memory.
  void forget();

  /// error = J delta; delta is free parameters x samples, for the samples from `from` on.
  void errors(const Rows& delta, Rows& error, Eigen::Index from = 0) const;

  /// gradient = J^T weight, for a weight on every error row, for the samples from `from` on.
  void gradient(const Rows& weight, Rows& gradient, Eigen::Index from = 0) const;

  /// Of each block the points whose error J delta + offset (in blocks) is anywhere above half the tolerance, and every
  /// fourth of the others.
  Focus focus(const Rows& delta, const LaneRows& offset, double tolerance, int threads) const;

  /// The gradient of `loss` at the error J delta + offset (in blocks), over all samples, on `threads` threads. Returns
  /// the mean over samples of the sum of the weights. `focus`: the points to look at; null: all.
  double descend(const Rows& delta, const LaneRows& offset, const PointLoss& loss, const Focus* focus, int threads,
                 Rows& gradient) const;

  /// J times one unit of a free parameter; beyond the last sample zero.
  Effect effect(Eigen::Index parameter, const BlockRange& blocks) const;

  /// Root over samples of the mean of max over points |dp / dparameter|^2, per free parameter; world units per unit.
  Eigen::VectorXd reach() const;

  /// Samples of the last linearisation.
  Eigen::Index samples() const { return samples_; }

 private:
  /// A free property of a node.
  struct Property {
    int free = -1;   ///< first free parameter, or -1
    int value = -1;  ///< first parameter of the layout
    int width = 3;
    std::size_t target = 0;
    Eigen::Index row = 0;  ///< among the numbers: 3 x width; for a scale 3 axes x 3, then 3 factors
  };
  struct Mover {
    int node = -1;
    int parent = -1;  ///< index of the nearest mover above
    Property rotation, translation, scale;
    glm::dmat4 chain{1.0};        ///< from the mover above (or the world) to this node's parent
    bool has_chain = true;        ///< that is not the identity
    Eigen::Index offset_row = 0;  ///< among the numbers: origin minus the parent's origin (3)
  };
  /// A mover at one sample.
  struct MoverPose {
    glm::dquat change{1, 0, 0, 0};      ///< of a rotation vector: from the reference
    glm::dquat rotation{1, 0, 0, 0};    ///< local
    glm::dmat4 above{1.0}, world{1.0};  ///< of the node's parent; of the node
  };
  struct Share {
    int mover = -1;
    glm::dvec4 offset{0.0};  ///< weight * (offset, 1), in the mover's space
    Eigen::Index row = 0;    ///< among the numbers: weight * (position - origin) (3)
  };
  struct Morph {
    int free = 0;   ///< free parameter
    int value = 0;  ///< parameter of the layout
    double reach = 0;
  };

  void positions(const ConstValues& values, Eigen::Index first, Eigen::Index end, Rows& out) const;
  void pose(const ConstValues& values, Eigen::Index sample, std::vector<MoverPose>& poses) const;
  void turn(const Mover& mover, const ConstValues& values, Eigen::Index sample, MoverPose& pose) const;
  void linearise_rotation(const Mover& mover, const MoverPose& pose, const glm::dmat3& above, const ConstValues& values,
                          Eigen::Index block, Eigen::Index lane);

  Eigen::Index state_width() const { return stretches_ ? 15 : 6; }
  Eigen::Index block_count() const { return blocks_of(samples_); }
  auto row(Eigen::Index block, Eigen::Index r) const { return rows_.col(block * row_count_ + r); }
  float& entry(Eigen::Index r, Eigen::Index block, Eigen::Index lane) { return rows_(lane, block * row_count_ + r); }
  void move(std::size_t mover, Eigen::Index block, const LaneRows& delta, LaneRows& state) const;
  void point_error(Eigen::Index point, Eigen::Index block, const LaneRows& state, LaneRows& error) const;
  void pull(Eigen::Index point, Eigen::Index block, const LaneRows& weight, LaneRows& state) const;
  void settle(Eigen::Index block, LaneRows& state, LaneRows& gradient) const;
  double descend_block(Eigen::Index block, const Rows& delta, const LaneRows& offset, const PointLoss& loss,
                       const Focus* focus, Rows& gradient) const;

  Property add_property(const LayoutBlock* block, bool all, Eigen::Index rows);

  std::vector<motion::Transform> rest_;  ///< of all nodes, with the values of fixed targets
  const SetFrame* frame_;
  Eigen::Index free_count_ = 0;
  std::vector<Mover> movers_;
  std::vector<std::size_t> first_;
  std::vector<Share> shares_;
  std::vector<Morph> morphs_;
  bool stretches_ = false;  ///< some mover has scale parameters
  Eigen::Index samples_ = 0;
  Eigen::Index row_count_ = 0;
  LaneRows rows_;  ///< per block of samples row_count_ numbers; what lies beyond the last sample is zero
};

}  // namespace nmc::codec
