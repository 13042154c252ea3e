// From pose parameters to the points where error is seen: exact positions, and the linear map of small changes with its
// transpose.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "base/points.h"
#include "codec/clip_layout.h"
#include "motion/skeleton.h"

namespace nmc::codec {

/// One component a row, one sample a column: operations on rows run over samples at vector width.
using Rows = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Which parameters of a layout a map takes as free.
enum class FreeParameters {
  moving,  ///< those of moving targets, numbered as in ClipLayout::moving; fixed targets hold the values given
  all,     ///< every parameter of the layout
};

/// The kinematics of one clip. Linear maps cost O(movers + points) per sample.
class MotionMap {
 public:
  /// Takes the points that free parameters move. Fixed targets take their values from the first column of `fixed` (all
  /// parameters of the layout x at least one).
  MotionMap(const motion::Skeleton& skeleton, const SetFrame& frame, const ClipLayout& layout, const Points& points,
            const Eigen::MatrixXd& fixed, FreeParameters free = FreeParameters::moving);

  /// Rows of an error: three per point, then one per morph target.
  Eigen::Index error_rows() const { return 3 * point_count() + static_cast<Eigen::Index>(morphs_.size()); }
  Eigen::Index point_count() const { return static_cast<Eigen::Index>(first_.size()) - 1; }

  /// World positions of the points (and reach times weight of morph targets) for `values` (all parameters of the layout
  /// x samples).
  Rows positions(const Eigen::MatrixXd& values) const;

  /// Makes the linear map at these values.
  void linearise(const Eigen::MatrixXd& values);

  /// error = J delta; delta is free parameters x samples, for the samples from `from` on.
  void errors(const Rows& delta, Rows& error, Eigen::Index from = 0) const;

  /// gradient = J^T weight, for a weight on every error row, for the samples from `from` on.
  void gradient(const Rows& weight, Rows& gradient, Eigen::Index from = 0) const;

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
    Eigen::Index row = 0;  ///< in rows_: 3 x width; for a scale 3 axes x 3, then 3 factors
  };
  struct Mover {
    int node = -1;
    int parent = -1;  ///< index of the nearest mover above
    Property rotation, translation, scale;
    glm::dmat4 chain{1.0};        ///< from the mover above (or the world) to this node's parent
    Eigen::Index offset_row = 0;  ///< in rows_: origin minus the parent's origin (3)
  };
  struct Share {
    int mover = -1;
    glm::dvec4 offset{0.0};  ///< weight * (offset, 1), in the mover's space
    Eigen::Index row = 0;    ///< in rows_: weight * (position - origin) (3)
  };
  struct Morph {
    int free = 0;   ///< free parameter
    int value = 0;  ///< parameter of the layout
    double reach = 0;
  };

  void world(const Eigen::MatrixXd& values, Eigen::Index sample, std::vector<glm::dmat4>& world) const;
  glm::dquat rotation(const Mover& mover, const Eigen::MatrixXd& values, Eigen::Index sample) const;
  void linearise_rotation(const Mover& mover, const glm::dmat3& above, const Eigen::MatrixXd& values,
                          Eigen::Index sample);

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
  Rows rows_;
};

}  // namespace nmc::codec
