// A made character with a motion in closed form, and what the tests of the encoder's parts do with it.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "codec/clip_layout.h"
#include "codec/motion_map.h"
#include "codec/sparse_training.h"
#include "motion/clip.h"

namespace nmc::codec {

using PerSample = Eigen::Array<float, 1, Eigen::Dynamic>;

/// A chain of joints, a moving and stretching root, and points at and beyond the joints.
struct Character {
  motion::Skeleton skeleton;
  Points points;
  motion::Clip clip;
  SetFrame frame;
  ClipLayout layout;
  ParameterSteps steps;

  explicit Character(std::size_t samples, bool stretches = false) {
    constexpr int joints = 4;
    for (int i = 0; i < joints; ++i) {
      motion::Transform t;
      t.translation = {0.1, i > 0 ? 0.5 : 0.0, 0};
      skeleton.names.push_back("joint");
      skeleton.parent.push_back(i - 1);
      skeleton.order.push_back(i);
      skeleton.rest.push_back(t);
      skeleton.rest_matrix.push_back(motion::to_matrix(t));
      skeleton.rest_weights.emplace_back();
      skeleton.joints.push_back(i);
      const Influence origin{i, {}, 1}, tip{i, {0.2, 0.3, 0.1}, 1};
      points.add(&origin, &origin + 1);
      points.add(&tip, &tip + 1);
    }
    const Influence blend[2] = {{1, {0.1, 0, 0.2}, 0.4}, {2, {-0.1, 0.1, 0}, 0.6}};
    points.add(blend, blend + 2);
    for (std::size_t n = 0; n < samples; ++n) clip.times.push_back(static_cast<float>(n) / 30);
    add_track(0, Path::translation, 3);
    for (int i = 0; i < joints; ++i) add_track(i, Path::rotation, 4);
    if (stretches) add_track(1, Path::scale, 3);
    frame = mean_frame(skeleton, {&clip});
    layout = layout_clip(clip, frame);
    const auto count = static_cast<Eigen::Index>(layout.parameters.size());
    steps = {Eigen::VectorXd::Constant(count, 0.01), Eigen::VectorXd::Constant(count, 0.002)};
  }

  Eigen::Index samples() const { return layout.values.cols(); }
  MotionMap map() const { return {skeleton, frame, layout, points, layout.values}; }

 private:
  void add_track(int node, Path path, int width) {
    motion::Track track{node, path, width, {}};
    for (std::size_t n = 0; n < clip.times.size(); ++n) {
      const double t = static_cast<double>(n) / static_cast<double>(clip.times.size());
      for (int a = 0; a < width; ++a) {
        // One scale for all axes: below others the map is an approximation.
        const int wave_of = path == Path::scale ? 0 : a;
        const double wave = 0.3 * std::sin(6.28 * t * (1 + (node + wave_of) % 3) + node + wave_of);
        const bool usual = path == Path::scale || (path == Path::rotation && a == 3);
        track.values.push_back(static_cast<float>(wave + (usual ? 1.0 : 0.0)));
      }
      if (path == Path::rotation) normalise(track);
    }
    clip.tracks.push_back(track);
  }

  static void normalise(motion::Track& track) {
    float* q = track.values.data() + track.values.size() - 4;
    const float length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int a = 0; a < 4; ++a) q[a] /= length;
  }
};

inline Rows random_rows(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  Rows made(rows, columns);
  for (Eigen::Index i = 0; i < made.size(); ++i) made.data()[i] = static_cast<float>(random() % 2001) / 1000.0f - 1.0f;
  return made;
}

inline double largest_distance(const Rows& difference, Eigen::Index points) {
  double most = 0;
  for (Eigen::Index q = 0; q < points; ++q)
    most = std::max(
        most, std::sqrt(static_cast<double>(difference.middleRows(3 * q, 3).square().colwise().sum().maxCoeff())));
  return most;
}

/// A trained clip of coarse steps, and where its points should be.
struct Trained {
  Character character{60};
  MotionMap map = character.map();
  Rows wanted = map.positions(character.layout.values);
  LevelClip levels;
  double tolerance = 0.01;

  Trained() {
    const LaneRows offset = in_blocks(Rows::Zero(map.error_rows(), 60));
    SparseSettings settings{.basis = Basis::cosine, .boundaries = {0, 60}};
    settings.iterations = 120;
    settings.rate = 0.6;
    settings.step_exponent = -6;
    levels =
        train_sparse(
            {.layout = &character.layout, .steps = &character.steps, .offset = {&offset, 1}, .tolerance = tolerance},
            map, settings)
            .levels;
  }

  Rows error(const LevelClip& clip) const {
    return map.positions(values_of_levels(clip, character.steps, 60)) - wanted;
  }
  double largest(const LevelClip& clip) const { return largest_distance(error(clip), map.point_count()); }
};

}  // namespace nmc::codec
