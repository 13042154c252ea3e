#include "baselines/motion_data.h"

#include <algorithm>
#include <cmath>

#include "motion/index.h"

namespace nmc::baselines {
namespace {

using motion::at;

constexpr std::uint64_t most_samples = std::uint64_t{1} << 22;
constexpr std::uint64_t most_values = std::uint64_t{1} << 26;
constexpr std::uint64_t most_targets = 1u << 16;

/// Turned by up to rounding, or the opposite sign of a quaternion.
bool is_same(const std::vector<float>& a, std::span<const float> b, Path path) {
  constexpr float rounding = 1e-6f;
  for (const float sign : {1.0f, -1.0f}) {
    bool same = true;
    for (std::size_t i = 0; i < a.size(); ++i)
      if (!(std::abs(a[i] - sign * b[i]) <= rounding * (1 + std::abs(a[i])))) same = false;
    if (same) return true;
    if (path != Path::rotation) break;
  }
  return false;
}

bool moves(const codec::Source& source, Channel& channel) {
  bool is_first = true;
  for (const codec::ClipSource& clip : source.clips) {
    const motion::Track* track = codec::find_track(clip.clip, channel.target);
    if (track && !track->constant()) return true;
    const std::vector<float> value = track ? track->values : rest_value(source.skeleton, channel.target);
    if (is_first) channel.value = value;
    if (!is_same(channel.value, value, channel.target.path)) return true;
    is_first = false;
  }
  return false;
}

void fill(Eigen::MatrixXd& values, const Channel& channel, std::span<const float> rows) {
  const Eigen::Index width = channel.target.width;
  const bool constant = rows.size() == at(channel.target.width);
  for (Eigen::Index n = 0; n < values.cols(); ++n)
    for (Eigen::Index a = 0; a < width; ++a)
      values(channel.first + a, n) = rows[static_cast<std::size_t>((constant ? 0 : n * width) + a)];
}

struct Grid {
  double first = 0, step = 0;
  bool fits = true;
};

Grid fit_grid(const std::vector<float>& times) {
  Grid grid;
  grid.first = times.front();
  if (times.size() > 1)
    grid.step = (static_cast<double>(times.back()) - grid.first) / static_cast<double>(times.size() - 1);
  for (std::size_t n = 0; n < times.size(); ++n) {
    const double t = grid.first + static_cast<double>(n) * grid.step;
    if (std::abs(t - static_cast<double>(times[n])) > 1e-6 + 2.4e-7 * std::abs(t)) grid.fits = false;
  }
  return grid;
}

void write_times(ByteWriter& bytes, const std::vector<float>& times) {
  bytes.count(times.size());
  const Grid grid = fit_grid(times);
  bytes.u8(grid.fits ? 1 : 0);
  if (grid.fits) {
    bytes.f32(grid.first);
    bytes.f64(grid.step);
    return;
  }
  for (const float t : times) bytes.f32(t);
}

std::vector<float> read_times(ByteReader& bytes) {
  std::vector<float> times(static_cast<std::size_t>(bytes.count(most_samples)));
  if (times.empty()) refuse_damaged("a clip has no samples");
  if (bytes.u8()) {
    const double first = bytes.f32(), step = bytes.f64();
    for (std::size_t n = 0; n < times.size(); ++n) times[n] = static_cast<float>(first + static_cast<double>(n) * step);
  } else {
    for (float& t : times) t = bytes.f32();
  }
  for (std::size_t n = 1; n < times.size(); ++n)
    if (!(times[n] > times[n - 1]) || !std::isfinite(times[n])) refuse_damaged("times do not increase");
  return times;
}

}  // namespace

std::vector<float> rest_value(const motion::Skeleton& skeleton, const codec::NodeTarget& target) {
  const motion::Transform& rest = skeleton.rest[at(target.node)];
  const auto f = [](double x) { return static_cast<float>(x); };
  switch (target.path) {
    case Path::translation:
      return {f(rest.translation.x), f(rest.translation.y), f(rest.translation.z)};
    case Path::rotation:
      return {f(rest.rotation.x), f(rest.rotation.y), f(rest.rotation.z), f(rest.rotation.w)};
    case Path::scale:
      return {f(rest.scale.x), f(rest.scale.y), f(rest.scale.z)};
    case Path::weights:
      break;
  }
  std::vector<float> value(at(target.width), 0.0f);
  const std::vector<double>& weights = skeleton.rest_weights[at(target.node)];
  for (std::size_t i = 0; i < std::min(value.size(), weights.size()); ++i) value[i] = f(weights[i]);
  return value;
}

int Head::rows() const {
  int rows = 0;
  for (const Channel& channel : channels)
    if (channel.moves) rows += channel.target.width;
  return rows;
}

MotionData motion_data(const codec::Source& source) {
  MotionData data;
  std::vector<const motion::Clip*> clips;
  for (const codec::ClipSource& clip : source.clips) clips.push_back(&clip.clip);
  int rows = 0;
  for (const codec::NodeTarget& target : codec::common_targets(source.skeleton, clips)) {
    Channel channel{target, false, -1, {}};
    channel.moves = moves(source, channel);
    if (channel.moves) {
      channel.value.clear();
      channel.first = rows;
      rows += target.width;
    } else if (is_same(channel.value, rest_value(source.skeleton, target), target.path)) {
      continue;
    }
    data.head.channels.push_back(std::move(channel));
  }
  for (const motion::Clip* clip : clips) {
    data.head.times.push_back(clip->times);
    Eigen::MatrixXd values(rows, static_cast<Eigen::Index>(clip->times.size()));
    for (const Channel& channel : data.head.channels) {
      if (!channel.moves) continue;
      const motion::Track* track = codec::find_track(*clip, channel.target);
      fill(values, channel, track ? track->values : rest_value(source.skeleton, channel.target));
    }
    data.clips.push_back(std::move(values));
  }
  return data;
}

std::vector<Eigen::MatrixXd> no_values(const Head& head) {
  std::vector<Eigen::MatrixXd> values;
  for (const std::vector<float>& times : head.times) values.emplace_back(0, static_cast<Eigen::Index>(times.size()));
  return values;
}

void write_target(ByteWriter& bytes, const codec::NodeTarget& target) {
  bytes.count(static_cast<std::uint64_t>(target.node));
  bytes.u8(static_cast<unsigned>(target.path));
  if (target.path == Path::weights) bytes.count(static_cast<std::uint64_t>(target.width));
}

codec::NodeTarget read_target(ByteReader& bytes, const motion::Skeleton& skeleton) {
  codec::NodeTarget target;
  if (skeleton.size() == 0) refuse_damaged("there are no nodes");
  target.node = static_cast<int>(bytes.count(skeleton.size() - 1));
  const unsigned path = bytes.u8();
  if (path > 3) refuse_damaged("a property is unknown");
  target.path = static_cast<Path>(path);
  target.width = target.path == Path::rotation ? 4 : 3;
  if (target.path == Path::weights)
    target.width = static_cast<int>(bytes.count(skeleton.rest_weights[at(target.node)].size()));
  if (target.width == 0) refuse_damaged("a node has no morph weights");
  return target;
}

void write_head(ByteWriter& bytes, const Head& head) {
  ByteWriter part;
  part.count(head.channels.size());
  for (const Channel& channel : head.channels) write_target(part, channel.target);
  for (const Channel& channel : head.channels) part.u8(channel.moves ? 1 : 0);
  for (const Channel& channel : head.channels)
    for (const float value : channel.value) part.f32(value);
  part.count(head.times.size());
  for (const std::vector<float>& times : head.times) write_times(part, times);
  bytes.packed(part.bytes());
}

Head read_head(ByteReader& bytes, const motion::Skeleton& skeleton) {
  const Bytes unpacked = bytes.packed();
  ByteReader part(unpacked);
  Head head;
  head.channels.resize(static_cast<std::size_t>(part.count(std::min<std::uint64_t>(most_targets, part.left()))));
  for (Channel& channel : head.channels) channel.target = read_target(part, skeleton);
  int rows = 0;
  for (Channel& channel : head.channels) {
    channel.moves = part.u8() != 0;
    if (!channel.moves) continue;
    channel.first = rows;
    rows += channel.target.width;
    if (static_cast<std::uint64_t>(rows) > most_values) refuse_damaged("too many values");
  }
  for (Channel& channel : head.channels)
    for (int a = 0; !channel.moves && a < channel.target.width; ++a) channel.value.push_back(part.f32());
  head.times.resize(static_cast<std::size_t>(part.count(part.left())));
  std::uint64_t samples = 0;
  for (std::vector<float>& times : head.times) {
    times = read_times(part);
    samples += times.size();
    if (samples > most_samples || samples * static_cast<std::uint64_t>(std::max(rows, 1)) > most_values)
      refuse_damaged("too many samples");
  }
  part.expect_end();
  return head;
}

motion::Clip to_clip(const Head& head, std::size_t index, const Eigen::MatrixXd& values) {
  motion::Clip clip;
  clip.times = head.times[index];
  for (const Channel& channel : head.channels) {
    motion::Track track{channel.target.node, channel.target.path, channel.target.width, channel.value};
    for (Eigen::Index n = 0; channel.moves && n < values.cols(); ++n) {
      Eigen::VectorXd value = values.block(channel.first, n, channel.target.width, 1);
      if (!value.allFinite()) value.setZero();
      if (track.path == Path::rotation) {
        if (value.norm() > 1e-12)
          value.normalize();
        else
          value = Eigen::Vector4d(0, 0, 0, 1);
      }
      for (Eigen::Index a = 0; a < value.size(); ++a) track.values.push_back(static_cast<float>(value(a)));
    }
    clip.tracks.push_back(std::move(track));
  }
  return clip;
}

std::vector<motion::Clip> to_clips(const Head& head, const std::vector<Eigen::MatrixXd>& values) {
  std::vector<motion::Clip> clips;
  for (std::size_t i = 0; i < head.times.size(); ++i) clips.push_back(to_clip(head, i, values[i]));
  return clips;
}

}  // namespace nmc::baselines
