#include "baselines/rma.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "baselines/contacts.h"
#include "baselines/level_curves.h"
#include "baselines/principal_components.h"
#include "motion/clip.h"
#include "motion/index.h"

namespace nmc::baselines {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using motion::at;

constexpr double span_seconds = 8.0 / 120;  // between regular control points
constexpr double bridge_seconds = 0.3, path_seconds = 0.6, clip_seconds = 0.2, smooth_seconds = 0.06;
constexpr double similar = 0.4;           // of the mean distance: what is dimmer is dissimilar
constexpr double analysis_share = 0.95;   // of variance that the self-distance plot sees
constexpr Index most_plot = 1000;         // samples of the self-distance plot
constexpr double least_deviation = 3e-4;  // of behaviours' models, share of size
constexpr int mean_bits = 16;

double rate_of(const Head& head) {
  double rate = 0;
  for (const std::vector<float>& t : head.times) rate = std::max(rate, motion::sample_rate_hz(t));
  return rate > 0 ? rate : 120;
}

Index samples_in(double seconds, double rate, Index least) {
  return std::max(least, static_cast<Index>(std::lround(seconds * rate)));
}

/// Numbers in some bits over their own range.
void write_numbers(ByteWriter& bytes, ByteWriter& levels, const Eigen::Ref<const MatrixXd>& numbers, int bits) {
  const auto low = static_cast<double>(static_cast<float>(numbers.minCoeff()));
  const double range = static_cast<double>(static_cast<float>(1.000001 * (numbers.maxCoeff() - low) + 1e-12));
  bytes.f32(low);
  bytes.f32(range);
  for (const double x : numbers.reshaped()) levels.u16(quantize(x, low, range, bits));
}

void read_numbers(ByteReader& bytes, ByteReader& levels, Eigen::Ref<MatrixXd> numbers, int bits) {
  const double low = bytes.f32(), range = bytes.f32();
  for (double& x : numbers.reshaped()) x = dequantize(levels.u16(), low, range, bits);
}

/// References of a repeated clip at control points, straight between them.
std::vector<Index> reference_points(const ClipPart& clip, Index span) {
  std::vector<Index> points;
  for (std::size_t n = 0; n < clip.reference.size(); n += static_cast<std::size_t>(span))
    points.push_back(clip.reference[n]);
  if ((clip.reference.size() - 1) % static_cast<std::size_t>(span) != 0) points.push_back(clip.reference.back());
  return points;
}

std::vector<Index> references_between(const std::vector<Index>& points, Index length, Index span) {
  std::vector<Index> references;
  for (Index n = 0; n < length; ++n) {
    const auto k = static_cast<std::size_t>(n / span);
    const Index first = n / span * span, next = std::min(first + span, length - 1);
    const Index a = points[k], b = points[std::min(k + 1, points.size() - 1)];
    references.push_back(next == first ? a : a + (b - a) * (n - first) / (next - first));
  }
  return references;
}

/// Low-pass over `window` samples to each side of a seam, the frames nearest to it (section 5.5).
void smooth(MatrixXd& markers, const std::vector<Index>& seams, Index half) {
  const MatrixXd before = markers;
  for (const Index seam : seams)
    for (Index n = std::max<Index>(0, seam - half); n < std::min(markers.cols(), seam + half); ++n) {
      const Index reach = std::min({half, n, markers.cols() - 1 - n});
      markers.col(n) = before.middleCols(n - reach, 2 * reach + 1).rowwise().mean();
    }
}

/// The samples of some ranges (first, end), `count` in all, one behind the other.
MatrixXd samples_of(const std::vector<std::pair<Index, Index>>& ranges, const MatrixXd& all, Index count) {
  MatrixXd samples(all.rows(), count);
  Index next = 0;
  for (const auto& [first, end] : ranges) {
    samples.middleCols(next, end - first) = all.middleCols(first, end - first);
    next += end - first;
  }
  return samples;
}

/// A group as it stands in the bytes.
struct ReadGroup {
  std::vector<std::pair<Index, Index>> ranges;
  std::vector<ClipPart> clips;
  Index frames = 0;
};

void check_references(const ReadGroup& group) {
  std::vector<char> primary(static_cast<std::size_t>(group.frames), 0);
  for (const ClipPart& clip : group.clips)
    for (Index n = clip.first; clip.kind == ClipKind::primary && n < clip.end; ++n)
      primary[static_cast<std::size_t>(n)] = 1;
  for (const ClipPart& clip : group.clips)
    for (const Index n : clip.reference)
      if (n < 0 || n >= group.frames || !primary[static_cast<std::size_t>(n)])
        refuse_damaged("a clip refers to none that is primary");
}

ReadGroup read_group(ByteReader& layout, Index all, Index span) {
  ReadGroup group;
  const std::uint64_t ranges = layout.count(static_cast<std::uint64_t>(all));
  Index last = 0;
  for (std::uint64_t r = 0; r < ranges; ++r) {
    const Index first = last + static_cast<Index>(layout.count(static_cast<std::uint64_t>(all - last)));
    const Index end = first + static_cast<Index>(layout.count(static_cast<std::uint64_t>(all - first)));
    if (end == first) refuse_damaged("a segment is empty");
    group.ranges.emplace_back(first, end);
    group.frames += end - first;
    last = end;
  }
  for (Index n = 0; n < group.frames;) {
    ClipPart clip;
    const unsigned kind = layout.u8();
    if (kind > 2) refuse_damaged("a clip is of no kind");
    clip.kind = static_cast<ClipKind>(kind);
    clip.first = n;
    clip.end = n + static_cast<Index>(layout.count(static_cast<std::uint64_t>(group.frames - n)));
    if (clip.end == n) refuse_damaged("a clip is empty");
    if (clip.kind == ClipKind::repeated) {
      const Index length = clip.end - clip.first;
      std::vector<Index> points(static_cast<std::size_t>((length - 1 + span - 1) / span + 1));
      std::int64_t now = 0;
      for (Index& point : points) {
        now += layout.signed_count();
        point = static_cast<Index>(now);
        if (point < 0 || point >= group.frames) refuse_damaged("a clip refers to no frame");
      }
      clip.reference = references_between(points, length, span);
    }
    n = clip.end;
    group.clips.push_back(std::move(clip));
  }
  check_references(group);
  return group;
}

std::vector<Index> lengths_of(const std::vector<ClipPart>& clips, bool repeated) {
  std::vector<Index> lengths;
  for (const ClipPart& clip : clips)
    if ((clip.kind == ClipKind::repeated) == repeated) lengths.push_back(clip.end - clip.first);
  return lengths;
}

/// Puts the curves of one axis where their clips are; repeated ones onto the primary frames that they refer to.
void place_curves(Eigen::Ref<Eigen::RowVectorXd> row, const std::vector<ClipPart>& clips,
                  const std::vector<Eigen::VectorXd>& curves, bool repeated) {
  std::size_t next = 0;
  for (const ClipPart& clip : clips) {
    if ((clip.kind == ClipKind::repeated) != repeated) continue;
    const Eigen::VectorXd& curve = curves[next++];
    for (Index n = clip.first; n < clip.end; ++n) {
      row(n) = curve(n - clip.first);
      if (repeated) row(n) += row(clip.reference[static_cast<std::size_t>(n - clip.first)]);
    }
  }
}

/// The values of all clips before contacts.
std::vector<MatrixXd> read_body(ByteReader& bytes, const motion::Skeleton& skeleton, const Head& head, bool smoothed) {
  const MarkerRig rig = make_marker_rig(skeleton, head, MarkerSet::compact, static_cast<double>(bytes.f32()));
  const double rate = rate_of(head);
  const Index span = samples_in(span_seconds, rate, 2);
  std::vector<Index> frames, starts;
  Index all = 0;
  for (const std::vector<float>& times : head.times) {
    starts.push_back(all);
    frames.push_back(static_cast<Index>(times.size()));
    all += frames.back();
  }
  const std::vector<RootMotion> roots = read_roots(bytes, frames);
  const auto groups = static_cast<std::size_t>(bytes.count(static_cast<std::uint64_t>(all)));
  const auto axis_bits = static_cast<int>(bytes.count(16));
  Bytes parts[7];
  for (Bytes& part : parts) part = bytes.packed();
  ByteReader layout(parts[0]), models(parts[1]), numbers(parts[2]);
  CurveReaders curves{ByteReader(parts[3]), ByteReader(parts[4]), ByteReader(parts[5]), ByteReader(parts[6])};
  MatrixXd markers = MatrixXd::Zero(rig.rows(), all);
  std::vector<Index> seams;
  for (std::size_t g = 0; g < groups; ++g) {
    const ReadGroup group = read_group(layout, all, span);
    if (group.frames == 0) refuse_damaged("a group is empty");
    const auto axes = static_cast<Index>(models.count(static_cast<std::uint64_t>(rig.rows())));
    if (numbers.left() / 2 < static_cast<std::size_t>(rig.rows() * (axes + 1))) refuse_damaged("it ends too early");
    MatrixXd mean(rig.rows(), 1), basis(rig.rows(), axes), coefficients(axes, group.frames);
    read_numbers(models, numbers, mean, mean_bits);
    if (axes > 0) read_numbers(models, numbers, basis, axis_bits);
    for (const bool repeated : {false, true}) {
      const std::vector<Index> lengths = lengths_of(group.clips, repeated);
      for (Index k = 0; k < axes; ++k) {
        Eigen::RowVectorXd row = coefficients.row(k);
        place_curves(row, group.clips, read_curves(curves, lengths, span), repeated);
        coefficients.row(k) = row;
      }
    }
    Index next = 0;
    std::vector<Index> place(static_cast<std::size_t>(group.frames));
    for (const auto& [first, end] : group.ranges)
      for (Index n = first; n < end; ++n, ++next) {
        markers.col(n) = mean.col(0) + basis * coefficients.col(next);
        place[static_cast<std::size_t>(next)] = n;
      }
    for (const ClipPart& clip : group.clips) seams.push_back(place[static_cast<std::size_t>(clip.first)]);
  }
  std::vector<MatrixXd> values;
  const Index half = samples_in(smooth_seconds / 2, rate, 1);
  for (std::size_t c = 0; c < frames.size(); ++c) {
    MatrixXd own = markers.middleCols(starts[c], frames[c]);
    if (smoothed) {
      std::vector<Index> inside;
      for (const Index seam : seams)
        if (seam > starts[c] && seam < starts[c] + frames[c]) inside.push_back(seam - starts[c]);
      smooth(own, inside, half);
    }
    values.push_back(from_markers(rig, unalign(rig, roots[c], std::move(own))));
  }
  return values;
}

}  // namespace

RmaEncoder::RmaEncoder(const codec::Source& source) : source_(source), data_(motion_data(source)) {
  const MarkerRig rig = make_marker_rig(source.skeleton, data_.head, MarkerSet::compact, source.size);
  roots_ = find_roots(rig, data_.clips);
  Index all = 0;
  std::vector<Index> starts;
  for (const MatrixXd& values : data_.clips) {
    markers_.push_back(to_markers(rig, values));
    starts.push_back(all);
    frames_.push_back(values.cols());
    all += values.cols();
  }
  if (rig.rows() == 0) return;
  MatrixXd aligned(rig.rows(), all);
  for (std::size_t c = 0; c < markers_.size(); ++c)
    aligned.middleCols(starts[c], frames_[c]) = align(rig, roots_[c], markers_[c]);
  std::vector<Index> rows;
  for (const int marker : rig.origin_marker)
    for (Index a = 0; marker >= 0 && a < 3; ++a) rows.push_back(3 * marker + a);
  const MatrixXd joints = rows.empty() ? aligned : MatrixXd(aligned(rows, Eigen::all));
  const double rate = rate_of(data_.head), deviation = least_deviation * source.size;
  std::vector<Index> segments = behaviour_cuts_both_ways(joints, SegmentSettings::at_rate(rate), deviation * deviation);
  segments.insert(segments.end(), starts.begin(), starts.end());
  std::sort(segments.begin(), segments.end());
  segments.erase(std::unique(segments.begin(), segments.end()), segments.end());
  const std::vector<int> numbers = group_segments(joints, segments);
  groups_.resize(static_cast<std::size_t>(*std::max_element(numbers.begin(), numbers.end())) + 1);
  for (std::size_t s = 0; s < segments.size(); ++s)
    groups_[static_cast<std::size_t>(numbers[s])].ranges.emplace_back(segments[s],
                                                                      s + 1 < segments.size() ? segments[s + 1] : all);
  for (Group& group : groups_) {
    std::vector<Index> junctions;
    Index count = 0;
    for (const auto& [first, end] : group.ranges) {
      if (count > 0) junctions.push_back(count);
      count += end - first;
    }
    const MatrixXd own = samples_of(group.ranges, aligned, count);
    const PrincipalComponents pca = principal_components(own);
    const Index stride = (count + most_plot - 1) / most_plot;
    MatrixXd coarse(axes_for_share(pca, analysis_share), (count + stride - 1) / stride);
    const MatrixXd axes = pca.axes.leftCols(coarse.rows());
    for (Index n = 0; n < coarse.cols(); ++n) coarse.col(n) = axes.transpose() * (own.col(n * stride) - pca.mean);
    const double coarse_rate = rate / static_cast<double>(stride);
    const std::vector<PosturePath> paths =
        similar_posture_paths(self_distances(coarse), similar, samples_in(bridge_seconds, coarse_rate, 1),
                              samples_in(path_seconds, coarse_rate, 2));
    std::vector<Index> coarse_junctions;
    for (const Index j : junctions) coarse_junctions.push_back((j + stride - 1) / stride);
    group.clips = choose_clips(coarse, paths, coarse_junctions, samples_in(clip_seconds, coarse_rate, 1));
    // Back to all samples: clips end at junctions exactly.
    const auto fine = [&](Index n) {
      const auto exact = std::find(coarse_junctions.begin(), coarse_junctions.end(), n);
      if (exact != coarse_junctions.end()) return junctions[static_cast<std::size_t>(exact - coarse_junctions.begin())];
      return std::min(n * stride, count);
    };
    std::vector<ClipPart> clips;
    for (const ClipPart& clip : group.clips) {
      ClipPart made{clip.kind, fine(clip.first), clip.end == coarse.cols() ? count : fine(clip.end), {}};
      if (made.end > made.first) clips.push_back(std::move(made));
    }
    const auto primary_of = [&](Index n) {
      for (const ClipPart& clip : clips)
        if (clip.kind == ClipKind::primary && n >= clip.first && n < clip.end) return &clip;
      return static_cast<const ClipPart*>(nullptr);
    };
    for (ClipPart& clip : clips) {
      if (clip.kind != ClipKind::repeated) continue;
      const auto from = std::find_if(group.clips.begin(), group.clips.end(), [&](const ClipPart& c) {
        return c.kind == ClipKind::repeated && fine(c.first) == clip.first;
      });
      const ClipPart* primary = primary_of(fine(from->reference.front()));
      for (Index n = clip.first; primary && n < clip.end; ++n) {
        const double place = static_cast<double>(n) / static_cast<double>(stride) - static_cast<double>(from->first);
        const auto last = static_cast<double>(from->reference.size() - 1);
        const double bounded = std::clamp(place, 0.0, last);
        const auto k = static_cast<std::size_t>(bounded);
        const std::size_t after = std::min(k + 1, from->reference.size() - 1);
        const double part = bounded - static_cast<double>(k);
        const double reference =
            (1 - part) * static_cast<double>(from->reference[k]) + part * static_cast<double>(from->reference[after]);
        clip.reference.push_back(std::clamp(static_cast<Index>(std::lround(reference * static_cast<double>(stride))),
                                            primary->first, primary->end - 1));
      }
      if (!primary) clip.kind = ClipKind::unique;
    }
    group.clips = std::move(clips);
  }
}

Bytes RmaEncoder::encode(double knob) {
  const double bound = knob * source_.size;
  RmaSettings settings;
  settings.residual = 0.25 * bound;
  settings.curve = bound;
  settings.expected_primary = 0.15 * bound;
  settings.expected_repeated = 0.18 * bound;
  settings.root = 0.2 * bound;
  settings.contact_step = std::min(0.2 * bound, 0.025 / 1.6 / 8 * source_.size);
  settings.axis_bits = std::clamp(12 + static_cast<int>(std::ceil(std::log2(0.02 / knob))), 12, 16);
  return encode(settings);
}

Bytes RmaEncoder::encode(const RmaSettings& settings, RmaCounts* counts) const {
  RmaCounts used;
  ByteWriter bytes;
  write_head(bytes, data_.head);
  if (data_.head.rows() == 0) return bytes.take();
  const Bytes main = body(settings, used);
  // The seams are smoothed where that brings them nearer to the original.
  std::vector<MatrixXd> decoded[2];
  double errors[2] = {};
  const MarkerRig rig = make_marker_rig(source_.skeleton, data_.head, MarkerSet::compact, source_.size);
  for (const int smoothed : {0, 1}) {
    ByteReader reader(main);
    decoded[smoothed] = read_body(reader, source_.skeleton, data_.head, smoothed == 1);
    for (std::size_t c = 0; c < frames_.size(); ++c)
      errors[smoothed] =
          std::max(errors[smoothed], (to_markers(rig, decoded[smoothed][c]) - markers_[c]).cwiseAbs().maxCoeff());
  }
  const int best = errors[1] < errors[0] ? 1 : 0;
  bytes.u8(static_cast<unsigned>(best));
  bytes.raw(main);
  write_contacts(bytes, source_.skeleton, data_.head, data_.clips, decoded[best], source_.size, settings.contact_step);
  if (counts) *counts = used;
  return bytes.take();
}

Bytes RmaEncoder::body(const RmaSettings& settings, RmaCounts& counts) const {
  const MarkerRig rig = make_marker_rig(source_.skeleton, data_.head, MarkerSet::compact, source_.size);
  const double rate = rate_of(data_.head);
  const Index span = samples_in(span_seconds, rate, 2);
  ByteWriter bytes;
  bytes.f32(source_.size);
  const std::vector<RootMotion> roots = write_roots(bytes, roots_, source_.size, span, settings.root);
  Index all = 0;
  for (const Index count : frames_) all += count;
  MatrixXd aligned(rig.rows(), all);
  Index start = 0;
  for (std::size_t c = 0; c < frames_.size(); ++c) {
    aligned.middleCols(start, frames_[c]) = align(rig, roots[c], markers_[c]);
    start += frames_[c];
  }
  ByteWriter layout, models, numbers;
  CurveStreams curves;
  CurveCounts values[2];
  double frames_of[3] = {};
  for (const Group& group : groups_) {
    layout.count(group.ranges.size());
    Index last = 0, count = 0;
    for (const auto& [first, end] : group.ranges) {
      layout.count(static_cast<std::uint64_t>(first - last));
      layout.count(static_cast<std::uint64_t>(end - first));
      last = end;
      count += end - first;
    }
    std::vector<ClipPart> clips = group.clips;
    for (ClipPart& clip : clips) {
      frames_of[static_cast<int>(clip.kind)] += static_cast<double>(clip.end - clip.first);
      layout.u8(static_cast<unsigned>(clip.kind));
      layout.count(static_cast<std::uint64_t>(clip.end - clip.first));
      if (clip.kind != ClipKind::repeated) continue;
      const std::vector<Index> points = reference_points(clip, span);
      Index now = 0;
      for (const Index point : points) {
        layout.signed_count(point - now);
        now = point;
      }
      clip.reference = references_between(points, clip.end - clip.first, span);
    }
    const MatrixXd own = samples_of(group.ranges, aligned, count);
    const PrincipalComponents pca = principal_components(own);
    const double per_marker = static_cast<double>(rig.rows()) / 3;
    const Index axes = settings.covered > 0
                           ? axes_for_share(pca, settings.covered)
                           : axes_for_residual(pca, settings.residual * settings.residual * per_marker);
    counts.mean_axes += static_cast<double>(axes) * static_cast<double>(count) / static_cast<double>(all);
    models.count(static_cast<std::uint64_t>(axes));
    ByteWriter own_models, own_numbers;
    MatrixXd mean = pca.mean, basis = pca.axes.leftCols(axes);
    write_numbers(own_models, own_numbers, mean, mean_bits);
    if (axes > 0) write_numbers(own_models, own_numbers, basis, settings.axis_bits);
    models.raw(own_models.bytes());
    numbers.raw(own_numbers.bytes());
    ByteReader model_reader(own_models.bytes()), number_reader(own_numbers.bytes());
    read_numbers(model_reader, number_reader, mean, mean_bits);
    if (axes > 0) read_numbers(model_reader, number_reader, basis, settings.axis_bits);
    // Rounded axes are not quite orthonormal: the coefficients are those that serve them best.
    const MatrixXd coefficients =
        axes > 0 ? MatrixXd((basis.transpose() * basis).ldlt().solve(basis.transpose() * (own.colwise() - mean.col(0))))
                 : MatrixXd(0, count);
    MatrixXd decoded = MatrixXd::Zero(axes, count);
    const double widest =
        axes > 0 ? (coefficients.rowwise().maxCoeff() - coefficients.rowwise().minCoeff()).maxCoeff() : 0;
    for (const bool repeated : {false, true}) {
      CurveSettings fit;
      fit.span = span;
      fit.threshold = settings.curve;
      fit.expected = repeated ? settings.expected_repeated : settings.expected_primary;
      fit.base_bits = repeated ? 6 : 8;
      fit.uniform_bits = repeated ? settings.uniform_repeated : settings.uniform_primary;
      for (Index k = 0; k < axes; ++k) {
        std::vector<Eigen::VectorXd> targets;
        for (const ClipPart& clip : clips) {
          if ((clip.kind == ClipKind::repeated) != repeated) continue;
          Eigen::VectorXd target = coefficients.row(k).segment(clip.first, clip.end - clip.first).transpose();
          for (Index n = 0; repeated && n < target.size(); ++n)
            target(n) -= decoded(k, clip.reference[static_cast<std::size_t>(n)]);
          targets.push_back(std::move(target));
        }
        Eigen::RowVectorXd row = decoded.row(k);
        place_curves(row, clips, write_curves(curves, targets, fit, widest, values[repeated ? 1 : 0]), repeated);
        decoded.row(k) = row;
      }
    }
  }
  bytes.count(groups_.size());
  bytes.count(static_cast<std::uint64_t>(settings.axis_bits));
  for (const ByteWriter* part :
       {&layout, &models, &numbers, &curves.ranges, &curves.points, &curves.small, &curves.large})
    bytes.packed(part->bytes());
  const auto frames = static_cast<double>(all);
  counts.groups = static_cast<int>(groups_.size());
  counts.primary_share = frames_of[0] / frames;
  counts.repeated_share = frames_of[1] / frames;
  counts.unique_share = frames_of[2] / frames;
  counts.primary_bits = values[0].bits / std::max(1.0, static_cast<double>(values[0].values));
  counts.repeated_bits = values[1].bits / std::max(1.0, static_cast<double>(values[1].values));
  return bytes.take();
}

std::unique_ptr<Encoder> prepare_rma(const codec::Source& source, const EncodeSettings&) {
  return std::make_unique<RmaEncoder>(source);
}

std::vector<motion::Clip> decode_rma(std::span<const std::uint8_t> input, const motion::Skeleton& skeleton) {
  ByteReader bytes(input);
  const Head head = read_head(bytes, skeleton);
  std::vector<MatrixXd> values = no_values(head);
  if (head.rows() > 0) {
    const bool smoothed = bytes.u8() != 0;
    values = read_body(bytes, skeleton, head, smoothed);
    apply_contacts(bytes, skeleton, head, values);
  }
  bytes.expect_end();
  return to_clips(head, values);
}

}  // namespace nmc::baselines
