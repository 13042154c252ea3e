// The parts of the methods against independent truth.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "base/error.h"
#include "baselines/behaviour_segments.h"
#include "baselines/clip_pca.h"
#include "baselines/inverse_kinematics.h"
#include "baselines/level_curves.h"
#include "baselines/markers.h"
#include "baselines/principal_components.h"
#include "baselines/repeated_motion.h"
#include "baselines/splines.h"
#include "baselines/tiny_source.h"

namespace nmc::test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double pi = std::numbers::pi;

/// Behaviours that live in planes of their own, 600 frames each at 120 Hz.
MatrixXd behaviours(int count) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  constexpr Index rows = 30, frames = 600;
  MatrixXd poses(rows, frames * count);
  for (int b = 0; b < count; ++b) {
    const VectorXd mean = 0.3 * VectorXd::NullaryExpr(rows, [&] { return normal(random); });
    const MatrixXd axes = 0.2 * MatrixXd::NullaryExpr(rows, 2, [&] { return normal(random); });
    for (Index n = 0; n < frames; ++n) {
      const double phase = 2 * pi * static_cast<double>(n) / 97;
      poses.col(b * frames + n) = mean + axes * Eigen::Vector2d(std::cos(phase), std::sin(phase));
      poses.col(b * frames + n) += 0.005 * VectorXd::NullaryExpr(rows, [&] { return normal(random); });
    }
  }
  return poses;
}

TEST(BehaviourCuts, AreWhereTheBehaviourChanges) {
  const auto settings = baselines::SegmentSettings::at_rate(120);
  const std::vector<Index> cuts = baselines::behaviour_cuts(behaviours(4), settings, 1e-6);
  ASSERT_EQ(cuts.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(static_cast<double>(cuts[i]), 600.0 * static_cast<double>(i + 1), 25);
}

TEST(BehaviourCuts, OneBehaviourHasNone) {
  EXPECT_TRUE(baselines::behaviour_cuts(behaviours(1), baselines::SegmentSettings::at_rate(120), 1e-6).empty());
}

TEST(BehaviourCuts, SettingsScaleWithTheRate) {
  const auto settings = baselines::SegmentSettings::at_rate(30);
  EXPECT_EQ(settings.first_frames, 50);
  EXPECT_EQ(settings.test_frames, 38);
  EXPECT_EQ(settings.threshold, 500);
}

TEST(GroupSegments, FindsTheSameBehaviourAgain) {
  const MatrixXd once = behaviours(2);
  MatrixXd poses(once.rows(), 2 * once.cols());
  poses << once, once;  // A B A B
  const std::vector<int> groups = baselines::group_segments(poses, {0, 600, 1200, 1800});
  EXPECT_EQ(groups, (std::vector<int>{0, 1, 0, 1}));
}

TEST(NormalizedCuts, SplitBlocksAndLeaveTheRest) {
  MatrixXd similarity = MatrixXd::Constant(5, 5, 0.01);
  similarity.topLeftCorner(3, 3).setConstant(0.9);
  similarity.bottomRightCorner(2, 2).setConstant(0.9);
  EXPECT_EQ(baselines::normalized_cut_groups(similarity, 0.7), (std::vector<int>{0, 0, 0, 1, 1}));
  EXPECT_EQ(baselines::normalized_cut_groups(MatrixXd::Ones(4, 4), 0.7), (std::vector<int>{0, 0, 0, 0}));
}

/// A gesture that does not repeat within itself, at a phase of [0, 1].
VectorXd gesture(double phase) {
  return Eigen::Vector4d(std::sin(2 * pi * phase), std::cos(3 * phase), 2 * phase, std::sin(5 * phase * phase));
}

/// Something else, then the gesture, something else again, the gesture slower by half.
MatrixXd repeated_gesture() {
  MatrixXd motion(4, 340);
  for (Index n = 0; n < 340; ++n) {
    const auto t = static_cast<double>(n);
    if (n >= 50 && n < 130)
      motion.col(n) = gesture((t - 50) / 79);
    else if (n >= 180 && n < 300)
      motion.col(n) = gesture((t - 180) / 119);
    else
      motion.col(n) = Eigen::Vector4d(-4 - 0.03 * t, 5 + 0.02 * t, -5 - std::sin(t / 9), 6 + 0.05 * t);
  }
  return motion;
}

TEST(SimilarPosturePaths, FollowAGestureAtAnotherSpeed) {
  const std::vector<baselines::PosturePath> paths =
      baselines::similar_posture_paths(baselines::self_distances(repeated_gesture()), 0.1, 20, 70);
  const baselines::PosturePath* longest = nullptr;
  for (const baselines::PosturePath& path : paths)
    if (path.steps.front().first >= 45 && path.steps.back().first < 135 && path.steps.front().second >= 175 &&
        (!longest || path.length() > longest->length()))
      longest = &path;
  ASSERT_TRUE(longest);
  EXPECT_GE(longest->length(), 170);  // of 79 + 119
  for (std::size_t i = 0; i < longest->steps.size(); ++i) {
    const auto [x, y] = longest->steps[i];
    const double phase_x = (static_cast<double>(x) - 50) / 79, phase_y = (static_cast<double>(y) - 180) / 119;
    EXPECT_NEAR(phase_x, phase_y, 0.04);
    if (i == 0) continue;
    EXPECT_GE(x, longest->steps[i - 1].first);
    EXPECT_GE(y, longest->steps[i - 1].second);
  }
}

TEST(ChooseClips, TellsTheSlowGestureByTheFastOne) {
  const MatrixXd motion = repeated_gesture();
  const auto paths = baselines::similar_posture_paths(baselines::self_distances(motion), 0.1, 20, 70);
  const std::vector<baselines::ClipPart> clips = baselines::choose_clips(motion, paths, {}, 24);
  Index next = 0, repeated = 0;
  for (const baselines::ClipPart& clip : clips) {
    EXPECT_EQ(clip.first, next);
    next = clip.end;
    if (clip.kind != baselines::ClipKind::repeated) continue;
    ASSERT_EQ(clip.reference.size(), static_cast<std::size_t>(clip.end - clip.first));
    repeated += clip.end - clip.first;
    double error = 0;
    for (Index n = clip.first; n < clip.end; ++n)
      error += (motion.col(n) - motion.col(clip.reference[static_cast<std::size_t>(n - clip.first)])).norm();
    EXPECT_LT(error / static_cast<double>(clip.end - clip.first), 0.15);
  }
  EXPECT_EQ(next, motion.cols());
  EXPECT_GE(repeated, 60);
}

TEST(CubicSpline, PassesThroughKeysAndFollowsACubicsMiddle) {
  std::vector<Index> keys;
  for (Index n = 0; n <= 60; n += 5) keys.push_back(n);
  const auto f = [](double n) { return std::sin(n / 9); };
  MatrixXd values(1, static_cast<Index>(keys.size()));
  for (std::size_t k = 0; k < keys.size(); ++k) values(0, static_cast<Index>(k)) = f(static_cast<double>(keys[k]));
  const MatrixXd curve = baselines::cubic_spline(keys, values);
  for (const Index key : keys) EXPECT_NEAR(curve(0, key), f(static_cast<double>(key)), 1e-12);
  // The error of a cubic spline is at most 5/384 h^4 max |f''''| away from the natural ends.
  for (Index n = 20; n <= 40; ++n)
    EXPECT_NEAR(curve(0, n), f(static_cast<double>(n)), 5.0 / 384 * std::pow(5.0 / 9, 4));
}

TEST(ChooseKeys, KeepsEveryFrameWithinTheThreshold) {
  MatrixXd curve(2, 200);
  for (Index n = 0; n < 200; ++n)
    curve.col(n) << std::sin(static_cast<double>(n * n) / 900), std::abs(static_cast<double>(n) - 77) / 30;
  std::size_t last = 1000;
  for (const double threshold : {0.001, 0.01, 0.1}) {
    const std::vector<Index> keys = baselines::choose_keys(curve, threshold);
    const MatrixXd made = baselines::cubic_spline(keys, baselines::columns_at(curve, keys));
    EXPECT_LE((made - curve).colwise().norm().maxCoeff(), threshold);
    EXPECT_LT(keys.size(), last);
    last = keys.size();
  }
}

TEST(CatmullRom, PassesThroughItsPointsAndReproducesALine) {
  const std::vector<Index> points{0, 3, 10, 11, 20};
  const VectorXd line = baselines::catmull_rom(points, VectorXd(Eigen::Vector<double, 5>(1, 7, 21, 23, 41)));
  for (Index n = 0; n <= 20; ++n) EXPECT_NEAR(line(n), 1 + 2 * static_cast<double>(n), 1e-12);
}

TEST(CatmullRom, FitsWithinTheThreshold) {
  VectorXd curve(300);
  for (Index n = 0; n < 300; ++n)
    curve(n) = std::sin(static_cast<double>(n) / 13) + (n > 150 ? 0.8 : 0.0) + 0.05 * std::sin(static_cast<double>(n));
  std::size_t last = 301;
  for (const double threshold : {0.003, 0.03, 0.3}) {
    const std::vector<Index> points = baselines::fit_catmull_rom(curve, 8, threshold);
    const VectorXd values = baselines::columns_at(curve.transpose(), points).transpose();
    EXPECT_LE((baselines::catmull_rom(points, values) - curve).cwiseAbs().maxCoeff(), threshold + 1e-12);
    EXPECT_LT(points.size(), last);
    last = points.size();
  }
  EXPECT_EQ(baselines::fit_catmull_rom(curve, 8, 10.0), baselines::regular_points(300, 8));
}

TEST(Quantiser, ErrsByHalfAStepAtMostAndAQuarterOnAverage) {
  std::mt19937 random(5);
  for (const double expected : {0.005, 0.006, 0.0001}) {
    const double range = 3.0;
    const int bits = baselines::bits_for(range, expected);
    const double step = range / std::exp2(bits);
    EXPECT_LE(step / 4, expected);      // equation 8
    EXPECT_GT(2 * step / 4, expected);  // and no bit too many
    std::uniform_real_distribution<double> values(-1.0, -1.0 + range);
    double worst = 0, sum = 0;
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i) {
      const double x = values(random);
      const double error =
          std::abs(baselines::dequantize(baselines::quantize(x, -1.0, range, bits), -1.0, range, bits) - x);
      worst = std::max(worst, error);
      sum += error;
    }
    EXPECT_LE(worst, step / 2 * (1 + 1e-9));
    EXPECT_NEAR(sum / count, step / 4, 0.02 * step);
  }
}

TEST(LevelCurves, ComeBackAsTheWriterSaidWithinBothBounds) {
  std::vector<VectorXd> curves;
  std::vector<Index> lengths;
  for (const Index length : {1, 2, 40, 200}) {
    VectorXd curve(length);
    for (Index n = 0; n < length; ++n)
      curve(n) = std::sin(static_cast<double>(n) / 7) * static_cast<double>(length) / 50;
    curves.push_back(curve);
    lengths.push_back(length);
  }
  baselines::CurveSettings settings;
  settings.threshold = 0.02;
  settings.expected = 0.004;
  baselines::CurveStreams streams;
  baselines::CurveCounts counts;
  const std::vector<VectorXd> told = baselines::write_curves(streams, curves, settings, 8.0, counts);
  baselines::CurveReaders readers{
      baselines::ByteReader(streams.ranges.bytes()), baselines::ByteReader(streams.points.bytes()),
      baselines::ByteReader(streams.small.bytes()), baselines::ByteReader(streams.large.bytes())};
  const std::vector<VectorXd> read = baselines::read_curves(readers, lengths, settings.span);
  ASSERT_EQ(read.size(), curves.size());
  for (std::size_t c = 0; c < curves.size(); ++c) {
    EXPECT_EQ(read[c], told[c]);
    // Half a step of the quantiser (twice the expected error), and the basis' overshoot of a quarter.
    EXPECT_LE((read[c] - curves[c]).cwiseAbs().maxCoeff(), 0.02 + 1.25 * 2 * 0.004 + 1e-5);
  }
}

TEST(PrincipalComponents, BothWaysAgree) {
  std::mt19937 random(9);
  std::normal_distribution<double> normal;
  const MatrixXd wide = MatrixXd::NullaryExpr(12, 40, [&] { return normal(random); });
  for (const MatrixXd& columns : {wide, MatrixXd(wide.leftCols(6))}) {
    const baselines::PrincipalComponents pca = baselines::principal_components(columns);
    EXPECT_TRUE((pca.axes.transpose() * pca.axes).isIdentity(1e-9));
    const MatrixXd centered = columns.colwise() - pca.mean;
    EXPECT_NEAR(pca.variances.sum(), centered.squaredNorm() / static_cast<double>(columns.cols()), 1e-9);
    for (const double left : {0.5, 2.0}) {
      const Index count = baselines::axes_for_residual(pca, left);
      const auto residual = [&](Index k) {
        const MatrixXd axes = pca.axes.leftCols(k);
        return (centered - axes * (axes.transpose() * centered)).squaredNorm() / static_cast<double>(columns.cols());
      };
      EXPECT_LE(residual(count), left + 1e-9);
      EXPECT_TRUE(count == 0 || residual(count - 1) > left);
    }
  }
}

TEST(Bezier, ReproducesACubic) {
  MatrixXd samples(2, 24);
  for (Index n = 0; n < 24; ++n) {
    const double t = static_cast<double>(n) / 23;
    samples.col(n) << 1 - 2 * t + 5 * t * t * t, t * t;
  }
  EXPECT_TRUE(baselines::bezier(baselines::fit_bezier(samples), 2, 24).isApprox(samples, 1e-9));
}

TEST(Markers, GiveTheRotationsBack) {
  const codec::Source source = tiny_source();
  const baselines::MotionData data = baselines::motion_data(source);
  for (const auto set : {baselines::MarkerSet::full, baselines::MarkerSet::compact}) {
    const baselines::MarkerRig rig = baselines::make_marker_rig(source.skeleton, data.head, set, source.size);
    for (const MatrixXd& values : data.clips) {
      const MatrixXd back = baselines::from_markers(rig, baselines::to_markers(rig, values));
      for (Index n = 0; n < values.cols(); ++n) {
        const auto a = baselines::world_of(source.skeleton, data.head, values, n);
        const auto b = baselines::world_of(source.skeleton, data.head, back, n);
        for (std::size_t node = 0; node < a.size(); ++node)
          for (int c = 0; c < 4; ++c) EXPECT_LT(glm::length(a[node][c] - b[node][c]), 1e-9 * source.size + 1e-9);
      }
    }
  }
}

/// An arm of three joints a unit apart with a hand, all turning.
motion::Skeleton arm() {
  motion::Skeleton skeleton;
  for (int i = 0; i < 4; ++i) {
    skeleton.names.push_back("joint");
    skeleton.parent.push_back(i - 1);
    skeleton.order.push_back(i);
    motion::Transform rest;
    if (i > 0) rest.translation = {1, 0.1 * i, 0};
    skeleton.rest.push_back(rest);
    skeleton.rest_matrix.push_back(motion::to_matrix(rest));
    skeleton.rest_weights.emplace_back();
    skeleton.joints.push_back(i);
  }
  return skeleton;
}

TEST(InverseKinematics, ReachesItsTargets) {
  const motion::Skeleton skeleton = arm();
  baselines::Head head;
  MatrixXd values(12, 1);
  for (int i = 0; i < 3; ++i) {
    head.channels.push_back({{i, Path::rotation, 4}, true, 4 * i, {}});
    values.block<4, 1>(4 * i, 0) << 0, 0, 0.1, std::sqrt(1 - 0.01);
  }
  for (const glm::dvec3& target : {glm::dvec3(2, 1, 0.5), glm::dvec3(0.5, -1.5, 1), glm::dvec3(-1, 1, -1)}) {
    baselines::ReachingPose pose(skeleton, head, values, 0);
    EXPECT_LT(pose.reach(3, target, 3, 1e-4), 1e-4);
    const auto world = baselines::world_of(skeleton, head, values, 0);  // what was written back
    EXPECT_LT(glm::length(glm::dvec3(world[3][3]) - target), 1.1e-4);
  }
  baselines::ReachingPose pose(skeleton, head, values, 0);
  EXPECT_GT(pose.reach(3, {9, 0, 0}, 3, 1e-4), 5.0);  // too far for its bones, and it says so
}

TEST(Bytes, ReaderNeverLeavesThem) {
  baselines::ByteWriter writer;
  writer.count(300);
  writer.signed_count(-5);
  writer.f32(1.5);
  const std::vector<std::uint8_t> many(1000, 7);
  writer.packed(many);
  baselines::ByteReader reader(writer.bytes());
  EXPECT_EQ(reader.count(300), 300U);
  EXPECT_EQ(reader.signed_count(), -5);
  EXPECT_EQ(reader.f32(), 1.5f);
  EXPECT_EQ(reader.packed(), many);
  reader.expect_end();
  EXPECT_THROW(reader.u8(), Error);
  baselines::ByteReader again(writer.bytes());
  EXPECT_THROW(again.count(299), Error);
}

}  // namespace
}  // namespace nmc::test
