#include "baselines/clip_pca.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "baselines/contacts.h"
#include "baselines/level_curves.h"
#include "baselines/principal_components.h"
#include "motion/clip.h"

namespace nmc::baselines {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::array<Index, 8> lengths{64, 48, 32, 24, 16, 8, 6, 4};  // frames of clips that the knob chooses from
constexpr int value_bits = 16;
constexpr Index clips_per_cluster = 40;
constexpr Index most_clusters = 16;
constexpr double span_seconds = 8.0 / 120;

double rate_of(const Head& head) {
  double rate = 0;
  for (const std::vector<float>& t : head.times) rate = std::max(rate, motion::sample_rate_hz(t));
  return rate > 0 ? rate : 120;
}

/// Bernstein polynomials at the frames of a clip: frames x 4.
MatrixXd bernstein(Index frames) {
  MatrixXd b(frames, 4);
  for (Index n = 0; n < frames; ++n) {
    const double t = frames > 1 ? static_cast<double>(n) / static_cast<double>(frames - 1) : 0, s = 1 - t;
    b.row(n) << s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t;
  }
  return b;
}

/// Clips of a fixed length; the last one of a motion is filled up with its last pose (Lin et al., section 6.1).
MatrixXd bezier_clips(const MatrixXd& motion, Index frames) {
  const Index count = (motion.cols() + frames - 1) / frames;
  MatrixXd clips(4 * motion.rows(), count);
  for (Index c = 0; c < count; ++c) {
    MatrixXd samples(motion.rows(), frames);
    for (Index n = 0; n < frames; ++n) samples.col(n) = motion.col(std::min(c * frames + n, motion.cols() - 1));
    clips.col(c) = fit_bezier(samples);
  }
  return clips;
}

/// k-means from evenly chosen clips; numbers by first appearance.
std::vector<int> cluster(const MatrixXd& clips) {
  const Index count = std::clamp<Index>(clips.cols() / clips_per_cluster, 1, most_clusters);
  MatrixXd centers(clips.rows(), count);
  for (Index k = 0; k < count; ++k) centers.col(k) = clips.col((2 * k + 1) * clips.cols() / (2 * count));
  std::vector<int> numbers(static_cast<std::size_t>(clips.cols()), 0);
  for (int round = 0; round < 20; ++round) {
    for (Index c = 0; c < clips.cols(); ++c) {
      Index nearest = 0;
      (centers.colwise() - clips.col(c)).colwise().squaredNorm().minCoeff(&nearest);
      numbers[static_cast<std::size_t>(c)] = static_cast<int>(nearest);
    }
    for (Index k = 0; k < count; ++k) {
      VectorXd sum = VectorXd::Zero(clips.rows());
      double members = 0;
      for (Index c = 0; c < clips.cols(); ++c)
        if (numbers[static_cast<std::size_t>(c)] == k) {
          sum += clips.col(c);
          ++members;
        }
      if (members > 0) centers.col(k) = sum / members;
    }
  }
  return numbers;
}

void write_16_bits(ByteWriter& ranges, ByteWriter& levels, const MatrixXd& numbers) {
  const auto low = static_cast<double>(static_cast<float>(numbers.size() ? numbers.minCoeff() : 0));
  const auto range =
      static_cast<double>(static_cast<float>(1.000001 * ((numbers.size() ? numbers.maxCoeff() : 0) - low) + 1e-12));
  ranges.f32(low);
  ranges.f32(range);
  for (const double x : numbers.reshaped()) levels.u16(quantize(x, low, range, value_bits));
}

MatrixXd read_16_bits(ByteReader& ranges, ByteReader& levels, Index rows, Index columns) {
  const double low = ranges.f32(), range = ranges.f32();
  if (levels.left() / 2 < static_cast<std::size_t>(rows * columns)) refuse_damaged("it ends too early");
  MatrixXd numbers(rows, columns);
  for (double& x : numbers.reshaped()) x = dequantize(levels.u16(), low, range, value_bits);
  return numbers;
}

MatrixXd columns_of(const MatrixXd& clips, const std::vector<int>& numbers, int number) {
  std::vector<Index> own;
  for (std::size_t c = 0; c < numbers.size(); ++c)
    if (numbers[c] == number) own.push_back(static_cast<Index>(c));
  return clips(Eigen::all, own);
}

std::vector<MatrixXd> read_body(ByteReader& bytes, const motion::Skeleton& skeleton, const Head& head) {
  const MarkerRig rig = make_marker_rig(skeleton, head, MarkerSet::full, static_cast<double>(bytes.f32()));
  const auto length = static_cast<Index>(bytes.count(1 << 16));
  if (length < 2) refuse_damaged("clips have no length");
  std::vector<Index> frames;
  Index clips = 0;
  for (const std::vector<float>& times : head.times) {
    frames.push_back(static_cast<Index>(times.size()));
    clips += (frames.back() + length - 1) / length;
  }
  const std::vector<RootMotion> roots = read_roots(bytes, frames);
  const auto clusters = static_cast<int>(bytes.count(most_clusters));
  const Bytes parts[] = {bytes.packed(), bytes.packed(), bytes.packed()};
  ByteReader layout(parts[0]), ranges(parts[1]), levels(parts[2]);
  std::vector<int> numbers;
  for (Index c = 0; c < clips; ++c) {
    numbers.push_back(static_cast<int>(layout.u8()));
    if (numbers.back() >= clusters) refuse_damaged("a clip is of no cluster");
  }
  const Index rows = 4 * rig.rows();
  MatrixXd all(rows, clips);
  for (int k = 0; k < clusters; ++k) {
    const auto members = static_cast<Index>(std::count(numbers.begin(), numbers.end(), k));
    const auto axes = static_cast<Index>(layout.count(static_cast<std::uint64_t>(rows)));
    const MatrixXd mean = read_16_bits(ranges, levels, rows, 1), basis = read_16_bits(ranges, levels, rows, axes);
    const MatrixXd coefficients = read_16_bits(ranges, levels, axes, members);
    Index next = 0;
    for (Index c = 0; c < clips; ++c)
      if (numbers[static_cast<std::size_t>(c)] == k) all.col(c) = mean.col(0) + basis * coefficients.col(next++);
  }
  std::vector<MatrixXd> values;
  Index next = 0;
  for (std::size_t c = 0; c < frames.size(); ++c) {
    MatrixXd markers(rig.rows(), frames[c]);
    for (Index first = 0; first < frames[c]; first += length) {
      const MatrixXd made = bezier(all.col(next++), rig.rows(), length);
      const Index count = std::min(length, frames[c] - first);
      markers.middleCols(first, count) = made.leftCols(count);
    }
    values.push_back(from_markers(rig, unalign(rig, roots[c], std::move(markers))));
  }
  return values;
}

}  // namespace

VectorXd fit_bezier(const MatrixXd& samples) {
  const MatrixXd b = bernstein(samples.cols());
  MatrixXd control(samples.rows(), 4);
  control.col(0) = samples.col(0);
  control.col(3) = samples.col(samples.cols() - 1);
  const MatrixXd rest = samples - control.col(0) * b.col(0).transpose() - control.col(3) * b.col(3).transpose();
  if (samples.cols() < 4) {
    control.col(1) = (2 * control.col(0) + control.col(3)) / 3;
    control.col(2) = (control.col(0) + 2 * control.col(3)) / 3;
  } else {
    const MatrixXd inner = b.middleCols(1, 2);
    control.middleCols(1, 2) = rest * inner * (inner.transpose() * inner).inverse();
  }
  return control.reshaped();
}

MatrixXd bezier(const VectorXd& control, Index rows, Index frames) {
  return control.reshaped(rows, 4) * bernstein(frames).transpose();
}

ClipPcaEncoder::ClipPcaEncoder(const codec::Source& source) : source_(source), data_(motion_data(source)) {
  const MarkerRig rig = make_marker_rig(source.skeleton, data_.head, MarkerSet::full, source.size);
  roots_ = find_roots(rig, data_.clips);
  for (std::size_t c = 0; c < data_.clips.size(); ++c) {
    markers_.push_back(to_markers(rig, data_.clips[c]));
    aligned_.push_back(align(rig, roots_[c], markers_[c]));
  }
  for (const Index length : lengths) bezier_errors_.emplace_back(length, largest_bezier_error(length));
}

double ClipPcaEncoder::largest_bezier_error(Index frames) const {
  double worst = 0;
  for (const MatrixXd& motion : aligned_) {
    const MatrixXd clips = bezier_clips(motion, frames);
    for (Index c = 0; c < clips.cols(); ++c) {
      const Index count = std::min(frames, motion.cols() - c * frames);
      const MatrixXd made = bezier(clips.col(c), motion.rows(), frames).leftCols(count);
      if (made.size()) worst = std::max(worst, (made - motion.middleCols(c * frames, count)).cwiseAbs().maxCoeff());
    }
  }
  return worst;
}

Bytes ClipPcaEncoder::encode(double knob) {
  const double bound = knob * source_.size;
  ClipPcaSettings settings;
  settings.frames = lengths.back();
  for (const auto& [length, error] : bezier_errors_)
    if (error <= bound) {
      settings.frames = length;
      break;
    }
  settings.residual = 0.25 * bound;
  settings.root = 0.2 * bound;
  settings.contact_step = std::min(0.2 * bound, 0.025 / 1.6 / 8 * source_.size);
  return encode(settings);
}

Bytes ClipPcaEncoder::encode(const ClipPcaSettings& settings, ClipPcaCounts* counts) const {
  ByteWriter bytes;
  write_head(bytes, data_.head);
  if (data_.head.rows() == 0) return bytes.take();
  const MarkerRig rig = make_marker_rig(source_.skeleton, data_.head, MarkerSet::full, source_.size);
  const Index span = std::max<Index>(2, std::lround(span_seconds * rate_of(data_.head)));
  ByteWriter main;
  main.f32(source_.size);
  main.count(static_cast<std::uint64_t>(settings.frames));
  const std::vector<RootMotion> roots = write_roots(main, roots_, source_.size, span, settings.root);
  std::vector<MatrixXd> parts;
  Index count = 0;
  for (std::size_t c = 0; c < markers_.size(); ++c) {
    parts.push_back(bezier_clips(align(rig, roots[c], markers_[c]), settings.frames));
    count += parts.back().cols();
  }
  MatrixXd clips(4 * rig.rows(), count);
  Index next = 0;
  for (const MatrixXd& part : parts) {
    clips.middleCols(next, part.cols()) = part;
    next += part.cols();
  }
  const std::vector<int> numbers = cluster(clips);
  const int clusters = *std::max_element(numbers.begin(), numbers.end()) + 1;
  main.count(static_cast<std::uint64_t>(clusters));
  ByteWriter layout, ranges, levels;
  for (const int number : numbers) layout.u8(static_cast<unsigned>(number));
  ClipPcaCounts used;
  for (int k = 0; k < clusters; ++k) {
    const MatrixXd own = columns_of(clips, numbers, k);
    PrincipalComponents pca{VectorXd::Zero(clips.rows()), MatrixXd(clips.rows(), 0), VectorXd(0)};
    if (own.cols() > 0) pca = principal_components(own);
    const double points = 4 * static_cast<double>(rig.rows()) / 3;
    const Index axes = settings.covered > 0 ? axes_for_share(pca, settings.covered)
                                            : axes_for_residual(pca, settings.residual * settings.residual * points);
    used.mean_axes += static_cast<double>(axes * own.cols()) / static_cast<double>(count);
    const MatrixXd basis = pca.axes.leftCols(axes);
    layout.count(static_cast<std::uint64_t>(axes));
    write_16_bits(ranges, levels, pca.mean);
    write_16_bits(ranges, levels, basis);
    write_16_bits(ranges, levels, basis.transpose() * (own.colwise() - pca.mean));
  }
  for (const ByteWriter* part : {&layout, &ranges, &levels}) main.packed(part->bytes());
  ByteReader reader(main.bytes());
  const std::vector<MatrixXd> decoded = read_body(reader, source_.skeleton, data_.head);
  bytes.raw(main.bytes());
  write_contacts(bytes, source_.skeleton, data_.head, data_.clips, decoded, source_.size, settings.contact_step);
  if (counts) *counts = used;
  return bytes.take();
}

std::unique_ptr<Encoder> prepare_clip_pca(const codec::Source& source, const EncodeSettings&) {
  return std::make_unique<ClipPcaEncoder>(source);
}

std::vector<motion::Clip> decode_clip_pca(std::span<const std::uint8_t> input, const motion::Skeleton& skeleton) {
  ByteReader bytes(input);
  const Head head = read_head(bytes, skeleton);
  std::vector<MatrixXd> values = no_values(head);
  if (head.rows() > 0) {
    values = read_body(bytes, skeleton, head);
    apply_contacts(bytes, skeleton, head, values);
  }
  bytes.expect_end();
  return to_clips(head, values);
}

}  // namespace nmc::baselines
