#include "baselines/marker_pca.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>

#include "baselines/behaviour_segments.h"
#include "baselines/principal_components.h"
#include "baselines/splines.h"
#include "motion/clip.h"
#include "motion/index.h"

namespace nmc::baselines {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Rows = std::vector<Index>;
using motion::at;

constexpr double feet_share = 1.0 / 3, spline_share = 1.0 / 3, normalization_share = 1.0 / 30;
constexpr double blend_seconds = 16.0 / 120;  // h
constexpr double least_deviation = 3e-4;      // of the segments' models, share of size

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

bool has(const std::string& name, std::initializer_list<const char*> parts) {
  return std::any_of(parts.begin(), parts.end(), [&](const char* p) { return name.find(p) != std::string::npos; });
}

/// The three markers of the body's frame and the rows of feet and of the rest.
struct Roles {
  std::array<int, 3> normalization{};  ///< origin, left, right
  Rows feet, others;
};

/// Neck and shoulders by their names; without them the root's own markers.
Roles find_roles(const MarkerRig& rig) {
  Roles roles;
  int neck = -1, left = -1, right = -1;
  for (std::size_t m = 0; m < rig.markers.size(); ++m) {
    if (rig.markers[m].offset != glm::dvec3(0.0)) continue;
    const std::string name = lower(rig.skeleton->names[at(rig.markers[m].node)]);
    const bool shoulder = has(name, {"shoulder", "arm", "clavicle", "humerus"}) && !has(name, {"fore", "armature"});
    if (neck < 0 && has(name, {"neck"})) neck = static_cast<int>(m);
    if (left < 0 && shoulder && has(name, {"left", "l_", ".l", "_l", "lsh", "lhu", "lcl"})) left = static_cast<int>(m);
    if (right < 0 && shoulder && has(name, {"right", "r_", ".r", "_r", "rsh", "rhu", "rcl"}))
      right = static_cast<int>(m);
  }
  if (neck >= 0 && left >= 0 && right >= 0 && left != right) {
    roles.normalization = {neck, left, right};
  } else if (rig.root >= 0) {
    roles.normalization = {rig.origin_marker[at(rig.root)], 0, 0};
    for (const MarkedJoint& joint : rig.joints) {
      if (roles.normalization[1] != roles.normalization[2]) break;
      roles.normalization[1] = joint.bone_marker;
      roles.normalization[2] = joint.side_marker;
    }
  }
  for (std::size_t m = 0; m < rig.markers.size(); ++m) {
    const auto& used = roles.normalization;
    if (std::find(used.begin(), used.end(), static_cast<int>(m)) != used.end()) continue;
    const std::string name = lower(rig.skeleton->names[at(rig.markers[m].node)]);
    Rows& rows = has(name, {"foot", "toe", "ankle"}) ? roles.feet : roles.others;
    for (Index a = 0; a < 3; ++a) rows.push_back(3 * static_cast<Index>(m) + a);
  }
  for (Index row = rig.marker_rows(); row < rig.rows(); ++row) roles.others.push_back(row);
  return roles;
}

/// The frame of the body in each sample: an origin and the direction of x in the horizontal plane; y stays up.
struct BodyFrames {
  MatrixXd origin;  ///< 3 x samples
  Eigen::VectorXd cosine, sine;
};

BodyFrames body_frames(const MatrixXd& normalization) {
  BodyFrames frames{normalization.topRows(3), Eigen::VectorXd::Ones(normalization.cols()),
                    Eigen::VectorXd::Zero(normalization.cols())};
  for (Index n = 0; n < normalization.cols(); ++n) {
    const double x = normalization(6, n) - normalization(3, n), z = normalization(8, n) - normalization(5, n);
    const double length = std::hypot(x, z);
    if (length > 1e-9) {
      frames.cosine(n) = x / length;
      frames.sine(n) = z / length;
    } else if (n > 0) {
      frames.cosine(n) = frames.cosine(n - 1);
      frames.sine(n) = frames.sine(n - 1);
    }
  }
  return frames;
}

/// World to body (direction 1) or back (-1); rows beyond the markers stay.
void change_frame(MatrixXd& markers, Index marker_rows, const BodyFrames& frames, int direction) {
  for (Index n = 0; n < markers.cols(); ++n)
    for (Index row = 0; row < marker_rows; row += 3) {
      Eigen::Vector3d p = markers.block<3, 1>(row, n);
      const double c = frames.cosine(n), s = direction * frames.sine(n);
      if (direction > 0) p -= frames.origin.col(n);
      p = Eigen::Vector3d(c * p.x() + s * p.z(), p.y(), c * p.z() - s * p.x());
      if (direction < 0) p += frames.origin.col(n);
      markers.block<3, 1>(row, n) = p;
    }
}

MatrixXd select(const MatrixXd& from, const Rows& rows) {
  MatrixXd made(static_cast<Index>(rows.size()), from.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) made.row(static_cast<Index>(i)) = from.row(rows[i]);
  return made;
}

Rows normalization_rows(const Roles& roles) {
  Rows rows;
  for (const int marker : roles.normalization)
    for (Index a = 0; a < 3; ++a) rows.push_back(3 * marker + a);
  return rows;
}

/// The part of a segment in one clip, with the frames beside it that are blended with its neighbours.
struct Piece {
  std::size_t segment = 0;
  std::size_t clip = 0;
  Index first = 0, end = 0;  ///< in the clip
  Index from = 0, to = 0;    ///< with what is blended
};

std::vector<Piece> make_pieces(const std::vector<Index>& segments, const std::vector<Index>& frames, Index half) {
  std::vector<Piece> pieces;
  Index start = 0;
  for (std::size_t clip = 0; clip < frames.size(); ++clip) {
    const Index end = start + frames[clip];
    for (std::size_t s = 0; s < segments.size(); ++s) {
      const Index first = std::max(start, segments[s]);
      const Index last = std::min(end, s + 1 < segments.size() ? segments[s + 1] : end);
      if (first >= last) continue;
      Piece piece{s, clip, first - start, last - start, 0, 0};
      piece.from = std::max<Index>(0, piece.first - half);
      piece.to = std::min(frames[clip], piece.end + half);
      pieces.push_back(piece);
    }
    start = end;
  }
  return pieces;
}

/// Paper, section 3.5: the share of the frames around t that belong to the piece.
double blend_weight(const Piece& piece, Index t, Index frames, Index half) {
  const Index low = std::max<Index>(0, t - half), high = std::min(frames - 1, t + half);
  const Index own = std::min(high, piece.end - 1) - std::max(low, piece.first) + 1;
  return static_cast<double>(std::max<Index>(0, own)) / static_cast<double>(high - low + 1);
}

Index blend_half(const std::vector<std::vector<float>>& times) {
  double rate = 0;
  for (const std::vector<float>& t : times) rate = std::max(rate, motion::sample_rate_hz(t));
  return std::max<Index>(1, std::lround(blend_seconds * rate / 2));
}

double rate_of(const Head& head) {
  double rate = 0;
  for (const std::vector<float>& t : head.times) rate = std::max(rate, motion::sample_rate_hz(t));
  return rate;
}

void write_keys(ByteWriter& bytes, const std::vector<Index>& keys, const MatrixXd& curve) {
  bytes.count(keys.size());
  for (std::size_t k = 1; k < keys.size(); ++k) bytes.count(static_cast<std::uint64_t>(keys[k] - keys[k - 1]));
  for (const Index key : keys)
    for (Index row = 0; row < curve.rows(); ++row) bytes.f32(curve(row, key));
}

MatrixXd read_keys(ByteReader& bytes, Index rows, Index frames) {
  std::vector<Index> keys(static_cast<std::size_t>(bytes.count(static_cast<std::uint64_t>(frames))));
  if (keys.empty()) refuse_damaged("a curve has no keys");
  keys[0] = 0;
  for (std::size_t k = 1; k < keys.size(); ++k) {
    keys[k] = keys[k - 1] + static_cast<Index>(bytes.count(static_cast<std::uint64_t>(frames)));
    if (keys[k] <= keys[k - 1]) refuse_damaged("keys do not increase");
  }
  if (keys.back() != frames - 1) refuse_damaged("a curve has another length");
  if (bytes.left() / 4 < keys.size() * static_cast<std::size_t>(rows)) refuse_damaged("it ends too early");
  MatrixXd values(rows, static_cast<Index>(keys.size()));
  for (Index k = 0; k < values.cols(); ++k)
    for (Index row = 0; row < rows; ++row) values(row, k) = bytes.f32();
  return cubic_spline(keys, values);
}

/// Mean and axes as the decoder has them.
struct Model {
  Eigen::VectorXd mean;
  MatrixXd axes;
};

void write_model(ByteWriter& bytes, const Model& model) {
  bytes.count(static_cast<std::uint64_t>(model.axes.cols()));
  for (const double x : model.mean) bytes.f32(x);
  for (Index k = 0; k < model.axes.cols(); ++k)
    for (const double x : model.axes.col(k)) bytes.f32(x);
}

Model read_model(ByteReader& bytes, Index rows) {
  Model model;
  const auto count = static_cast<Index>(bytes.count(static_cast<std::uint64_t>(rows)));
  if (bytes.left() / 4 < static_cast<std::size_t>((count + 1) * rows)) refuse_damaged("it ends too early");
  model.mean.resize(rows);
  for (double& x : model.mean) x = bytes.f32();
  model.axes.resize(rows, count);
  for (Index k = 0; k < count; ++k)
    for (double& x : model.axes.col(k)) x = bytes.f32();
  return model;
}

MatrixXd frames_of_segment(const std::vector<MatrixXd>& clips, const std::vector<Piece>& pieces, std::size_t segment) {
  Index count = 0;
  for (const Piece& piece : pieces)
    if (piece.segment == segment) count += piece.to - piece.from;
  MatrixXd frames(clips.front().rows(), count);
  Index next = 0;
  for (const Piece& piece : pieces) {
    if (piece.segment != segment) continue;
    frames.middleCols(next, piece.to - piece.from) = clips[piece.clip].middleCols(piece.from, piece.to - piece.from);
    next += piece.to - piece.from;
  }
  return frames;
}

double per_marker(Index rows) { return std::sqrt(std::max(1.0, static_cast<double>(rows) / 3)); }

}  // namespace

MarkerPcaEncoder::MarkerPcaEncoder(const codec::Source& source, MarkerPcaKind kind)
    : source_(source), kind_(kind), data_(motion_data(source)) {
  const MarkerRig rig = make_marker_rig(source.skeleton, data_.head, MarkerSet::compact, source.size);
  const Roles roles = find_roles(rig);
  for (const MatrixXd& values : data_.clips) markers_.push_back(to_markers(rig, values));
  segments_ = {0};
  if (kind == MarkerPcaKind::global || rig.markers.empty()) return;
  Rows joints;
  for (const int marker : rig.origin_marker)
    for (Index a = 0; marker >= 0 && a < 3; ++a) joints.push_back(3 * marker + a);
  Index frames = 0;
  for (const MatrixXd& markers : markers_) frames += markers.cols();
  MatrixXd poses(static_cast<Index>(joints.size()), frames);
  Index next = 0;
  for (MatrixXd markers : markers_) {
    change_frame(markers, rig.marker_rows(), body_frames(select(markers, normalization_rows(roles))), 1);
    poses.middleCols(next, markers.cols()) = select(markers, joints);
    next += markers.cols();
  }
  const double deviation = least_deviation * source.size;
  for (const Index cut : behaviour_cuts(poses, SegmentSettings::at_rate(rate_of(data_.head)), deviation * deviation))
    segments_.push_back(cut);
}

Bytes MarkerPcaEncoder::encode(double knob) {
  const double bound = knob * source_.size;
  return encode({bound, feet_share * bound, spline_share * bound, normalization_share * bound});
}

Bytes MarkerPcaEncoder::encode(const MarkerPcaSettings& settings, MarkerPcaCounts* counts) const {
  const MarkerRig rig = make_marker_rig(source_.skeleton, data_.head, MarkerSet::compact, source_.size);
  const Roles roles = find_roles(rig);
  ByteWriter bytes;
  write_head(bytes, data_.head);
  bytes.u8(static_cast<unsigned>(kind_));
  bytes.f32(source_.size);
  if (rig.rows() == 0) return bytes.take();
  bytes.count(segments_.size());
  for (std::size_t s = 1; s < segments_.size(); ++s)
    bytes.count(static_cast<std::uint64_t>(segments_[s] - segments_[s - 1]));
  std::vector<MatrixXd> body;
  std::vector<Index> frames;
  for (MatrixXd markers : markers_) {
    frames.push_back(markers.cols());
    if (!rig.markers.empty()) {
      const MatrixXd three = select(markers, normalization_rows(roles));
      const std::vector<Index> keys = choose_keys(three, settings.normalization * per_marker(three.rows()));
      write_keys(bytes, keys, three);
      const MatrixXd rounded = columns_at(three, keys).cast<float>().cast<double>();
      change_frame(markers, rig.marker_rows(), body_frames(cubic_spline(keys, rounded)), 1);
    }
    body.push_back(std::move(markers));
  }
  const std::vector<Piece> pieces =
      make_pieces(segments_, frames, segments_.size() > 1 ? blend_half(data_.head.times) : 0);
  MarkerPcaCounts used;
  used.segments = static_cast<int>(segments_.size());
  for (const Rows* rows : {&roles.others, &roles.feet}) {
    if (rows->empty()) continue;
    const double scale = per_marker(static_cast<Index>(rows->size()));
    const double bound = (rows == &roles.feet ? settings.feet : settings.others) * scale;
    std::vector<MatrixXd> selected;
    for (const MatrixXd& clip : body) selected.push_back(select(clip, *rows));
    for (std::size_t s = 0; s < segments_.size(); ++s) {
      const PrincipalComponents pca = principal_components(frames_of_segment(selected, pieces, s));
      const Model model{pca.mean, pca.axes.leftCols(axes_for_residual(pca, bound * bound))};
      write_model(bytes, model);
      if (rows == &roles.others) used.mean_axes += static_cast<double>(model.axes.cols()) / used.segments;
      for (const Piece& piece : pieces) {
        if (piece.segment != s) continue;
        const MatrixXd curve =
            model.axes.transpose() *
            (selected[piece.clip].middleCols(piece.from, piece.to - piece.from).colwise() - model.mean);
        if (kind_ == MarkerPcaKind::segment) {
          const std::vector<Index> keys = choose_keys(curve, settings.spline * scale);
          write_keys(bytes, keys, curve);
          if (rows == &roles.others) used.key_frames += static_cast<int>(keys.size());
        } else {
          for (const double x : curve.reshaped()) bytes.f32(x);
        }
      }
    }
  }
  if (counts) *counts = used;
  return bytes.take();
}

std::vector<motion::Clip> decode_marker_pca(std::span<const std::uint8_t> input, const motion::Skeleton& skeleton) {
  ByteReader bytes(input);
  const Head head = read_head(bytes, skeleton);
  const unsigned kind = bytes.u8();
  if (kind > 2) refuse_damaged("its kind is unknown");
  const double size = bytes.f32();
  const MarkerRig rig = make_marker_rig(skeleton, head, MarkerSet::compact, size);
  const Roles roles = find_roles(rig);
  std::vector<Index> frames;
  Index all = 0;
  for (const std::vector<float>& times : head.times) {
    frames.push_back(static_cast<Index>(times.size()));
    all += frames.back();
  }
  if (rig.rows() == 0) {
    bytes.expect_end();
    return to_clips(head, no_values(head));
  }
  std::vector<MatrixXd> clips;
  std::vector<Index> segments(static_cast<std::size_t>(bytes.count(bytes.left())));
  if (segments.empty()) refuse_damaged("there are no segments");
  segments[0] = 0;
  for (std::size_t s = 1; s < segments.size(); ++s) {
    segments[s] = segments[s - 1] + static_cast<Index>(bytes.count(static_cast<std::uint64_t>(all)));
    if (segments[s] <= segments[s - 1] || segments[s] >= all) refuse_damaged("segments do not increase");
  }
  std::vector<MatrixXd> normalization;
  for (const Index count : frames) {
    if (!rig.markers.empty()) normalization.push_back(read_keys(bytes, 9, count));
    clips.emplace_back(MatrixXd::Zero(rig.rows(), count));
  }
  const Index half = segments.size() > 1 ? blend_half(head.times) : 0;
  const std::vector<Piece> pieces = make_pieces(segments, frames, half);
  for (const Rows* rows : {&roles.others, &roles.feet}) {
    if (rows->empty()) continue;
    const auto count = static_cast<Index>(rows->size());
    for (std::size_t s = 0; s < segments.size(); ++s) {
      const Model model = read_model(bytes, count);
      for (const Piece& piece : pieces) {
        if (piece.segment != s) continue;
        MatrixXd curve(model.axes.cols(), piece.to - piece.from);
        if (kind == static_cast<unsigned>(MarkerPcaKind::segment))
          curve = read_keys(bytes, model.axes.cols(), piece.to - piece.from);
        else
          for (double& x : curve.reshaped()) x = bytes.f32();
        const MatrixXd made = (model.axes * curve).colwise() + model.mean;
        for (Index t = piece.from; t < piece.to; ++t) {
          const double weight = blend_weight(piece, t, frames[piece.clip], half);
          for (Index row = 0; row < count; ++row)
            clips[piece.clip]((*rows)[static_cast<std::size_t>(row)], t) += weight * made(row, t - piece.from);
        }
      }
    }
  }
  bytes.expect_end();
  std::vector<MatrixXd> values;
  for (std::size_t c = 0; c < clips.size(); ++c) {
    if (!rig.markers.empty()) {
      change_frame(clips[c], rig.marker_rows(), body_frames(normalization[c]), -1);
      const Rows three = normalization_rows(roles);
      for (std::size_t i = 0; i < three.size(); ++i)
        clips[c].row(three[i]) = normalization[c].row(static_cast<Index>(i));
    }
    values.push_back(from_markers(rig, clips[c]));
  }
  return to_clips(head, values);
}

std::unique_ptr<Encoder> prepare_pca(const codec::Source& source, const EncodeSettings&) {
  return std::make_unique<MarkerPcaEncoder>(source, MarkerPcaKind::global);
}

std::unique_ptr<Encoder> prepare_pca_piecewise(const codec::Source& source, const EncodeSettings&) {
  return std::make_unique<MarkerPcaEncoder>(source, MarkerPcaKind::piecewise);
}

std::unique_ptr<Encoder> prepare_pca_segment(const codec::Source& source, const EncodeSettings&) {
  return std::make_unique<MarkerPcaEncoder>(source, MarkerPcaKind::segment);
}

}  // namespace nmc::baselines
