#include "codec/effects.h"

namespace nmc::codec {

void add_effect(const MotionMap& map, const Effect& effect, const LaneRows& shares, BlockErrors error) {
  for (Eigen::Index b = 0; b < effect.blocks.count; ++b) {
    if ((shares.col(b) == 0).all()) continue;
    for (std::size_t k = 0; k < effect.points.size(); ++k) {
      const Eigen::Index q = effect.points[k], row = b * map.error_rows() + map.first_row(q);
      for (Eigen::Index a = 0; a < map.row_count(q); ++a)
        error.col(row + a) += shares.col(b) * effect.values.col(effect.column(k, b) + a);
    }
  }
}

std::vector<Parabola> endangered(const MotionMap& map, const Effect& effect, float most, ConstBlockErrors error,
                                 float limit) {
  std::vector<Parabola> found;
  const float unit = 1 / (limit * limit);
  for (Eigen::Index b = 0; b < effect.blocks.count; ++b)
    for (std::size_t k = 0; k < effect.points.size(); ++k) {
      const Eigen::Index q = effect.points[k], row = b * map.error_rows() + map.first_row(q);
      Lanes square = Lanes::Zero(), slope = Lanes::Zero(), bend = Lanes::Zero();
      for (Eigen::Index a = 0; a < map.row_count(q); ++a) {
        const Lanes e = error.col(row + a), unit_effect = effect.values.col(effect.column(k, b) + a);
        square += e * e;
        slope += e * unit_effect;
        bend += unit_effect * unit_effect;
      }
      slope *= 2.0f;
      if ((square + most * (slope.abs() + most * bend)).maxCoeff() * unit <= 1.0f) continue;
      found.push_back({b, unit * square, unit * slope, unit * bend});
    }
  return found;
}

}  // namespace nmc::codec
