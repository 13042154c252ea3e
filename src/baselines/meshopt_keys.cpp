// Keys as EXT_meshopt_compression stores them, those of all clips and channels of one kind together.
#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <map>

#include "base/parallel.h"
#include "baselines/bounded_search.h"
#include "baselines/motion_data.h"
#include "baselines/simple_methods.h"
#include "motion/error.h"
#include "motion/index.h"

namespace nmc::baselines {
namespace {

using motion::at;

constexpr int fewest_bits = 4, most_bits = 16;            // of a rotation
constexpr int extra_bits = 4;                             // of the others, as 16 to 12 in gltfpack
constexpr int strides[] = {1, 2, 3, 4, 5, 6, 8, 12, 16};  // keys kept: each, every second, ...
constexpr std::size_t most_width = 64;                    // floats of one vertex

/// Every stride-th key and the last.
std::vector<Eigen::Index> kept_keys(Eigen::Index frames, int stride) {
  std::vector<Eigen::Index> keys;
  for (Eigen::Index n = 0; n < frames; n += stride) keys.push_back(n);
  if (keys.back() != frames - 1) keys.push_back(frames - 1);
  return keys;
}

/// What is packed together, as the bufferViews of a file are: rotations, and everything else by its width.
struct Kind {
  bool rotation = false;
  int width = 0;
  auto operator<=>(const Kind&) const = default;

  std::size_t vertex_bytes() const { return rotation ? 8 : 4 * at(width); }
};

/// Calls use(channel, its first value, kind) for all streams of keys.
template <typename Use>
void for_streams(const Head& head, const Use& use) {
  for (const Channel& channel : head.channels) {
    if (!channel.moves) continue;
    const bool rotation = channel.target.path == Path::rotation;
    for (int first = 0; first < channel.target.width; first += static_cast<int>(most_width))
      use(channel, first, Kind{rotation, std::min(static_cast<int>(most_width), channel.target.width - first)});
  }
}

Bytes filtered_keys(const Kind& kind, const std::vector<float>& keys, int bits) {
  const std::size_t count = keys.size() / at(kind.width), size = kind.vertex_bytes();
  Bytes filtered(count * size);
  if (kind.rotation)
    meshopt_encodeFilterQuat(filtered.data(), count, size, bits, keys.data());
  else
    meshopt_encodeFilterExp(filtered.data(), count, size, std::min(24, bits + extra_bits), keys.data());
  return filtered;
}

/// Whether no number differs from the first key's by more than the step that the filter rounds to.
bool is_one_key(const Kind& kind, const std::vector<float>& keys, int bits) {
  float largest = 1, spread = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!kind.rotation) largest = std::max(largest, std::abs(keys[i]));
    spread = std::max(spread, std::abs(keys[i] - keys[i % at(kind.width)]));
  }
  return spread <= std::ldexp(largest, 1 - (kind.rotation ? bits : bits + extra_bits));
}

/// Some clips' keys after the filters.
struct Keys {
  std::vector<int> strides;    ///< per clip
  std::vector<bool> constant;  ///< per clip and stream: one key stands for all
  std::map<Kind, Bytes> vertices;

  void add(const Keys& clip) {
    strides.insert(strides.end(), clip.strides.begin(), clip.strides.end());
    constant.insert(constant.end(), clip.constant.begin(), clip.constant.end());
    for (const auto& [kind, bytes] : clip.vertices)
      vertices[kind].insert(vertices[kind].end(), bytes.begin(), bytes.end());
  }
};

Keys keys_of_clip(const Head& head, const Eigen::MatrixXd& values, int stride, int bits) {
  Keys clip;
  clip.strides.push_back(stride);
  const std::vector<Eigen::Index> all = kept_keys(values.cols(), stride);
  for_streams(head, [&](const Channel& channel, int first, const Kind& kind) {
    std::vector<float> keys;
    for (const Eigen::Index n : all)
      for (int a = 0; a < kind.width; ++a) keys.push_back(static_cast<float>(values(channel.first + first + a, n)));
    clip.constant.push_back(is_one_key(kind, keys, bits));
    if (clip.constant.back()) keys.resize(at(kind.width));
    const Bytes filtered = filtered_keys(kind, keys, bits);
    Bytes& vertices = clip.vertices[kind];
    vertices.insert(vertices.end(), filtered.begin(), filtered.end());
  });
  return clip;
}

/// Strides, a bit for each stream, and for each kind the length and the bytes of its vertices.
Bytes write_keys(const Keys& keys) {
  ByteWriter bytes;
  for (const int stride : keys.strides) bytes.u8(static_cast<unsigned>(stride));
  for (std::size_t i = 0; i < keys.constant.size(); i += 8) {
    unsigned byte = 0;
    for (std::size_t k = i; k < std::min(i + 8, keys.constant.size()); ++k)
      byte |= keys.constant[k] ? 1U << (k - i) : 0;
    bytes.u8(byte);
  }
  for (const auto& [kind, vertices] : keys.vertices) {
    const std::size_t size = kind.vertex_bytes(), count = vertices.size() / size;
    Bytes encoded(meshopt_encodeVertexBufferBound(count, size));
    encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), vertices.data(), count, size));
    bytes.count(encoded.size());
    bytes.raw(encoded);
  }
  return bytes.take();
}

std::vector<float> decode_vertices(const Kind& kind, std::span<const std::uint8_t> bytes, std::size_t count) {
  const std::size_t size = kind.vertex_bytes();
  std::vector<float> keys(count * at(kind.width));
  if (!kind.rotation) {
    if (meshopt_decodeVertexBuffer(keys.data(), count, size, bytes.data(), bytes.size()) != 0)
      refuse_damaged("keys cannot be unpacked");
    meshopt_decodeFilterExp(keys.data(), count, size);
    return keys;
  }
  std::vector<std::int16_t> packed(count * 4);
  if (meshopt_decodeVertexBuffer(packed.data(), count, size, bytes.data(), bytes.size()) != 0)
    refuse_damaged("keys cannot be unpacked");
  meshopt_decodeFilterQuat(packed.data(), count, size);
  for (std::size_t i = 0; i < packed.size(); ++i) keys[i] = static_cast<float>(packed[i]) / 32767.0f;
  return keys;
}

/// Reads what write_keys wrote of clips with these key times.
std::vector<motion::Clip> read_keys(const Head& head, const std::vector<std::vector<float>>& times, ByteReader& bytes) {
  std::vector<std::vector<Eigen::Index>> kept;
  for (const std::vector<float>& clip : times) {
    const auto stride = static_cast<int>(bytes.u8());
    if (stride == 0) refuse_damaged("no keys are kept");
    kept.push_back(kept_keys(static_cast<Eigen::Index>(clip.size()), stride));
  }
  std::size_t streams = 0;
  for_streams(head, [&](const Channel&, int, const Kind&) { ++streams; });
  const auto flags = bytes.take((streams * times.size() + 7) / 8);
  std::map<Kind, std::size_t> counts;
  std::vector<std::size_t> stream_keys;  // per clip and stream
  for (const std::vector<Eigen::Index>& keys : kept)
    for_streams(head, [&](const Channel&, int, const Kind& kind) {
      const std::size_t k = stream_keys.size();
      stream_keys.push_back((flags[k / 8] >> (k % 8)) & 1U ? 1 : keys.size());
      counts[kind] += stream_keys.back();
    });
  std::map<Kind, std::vector<float>> vertices;
  for (const auto& [kind, count] : counts) {
    const auto length = static_cast<std::size_t>(bytes.count(bytes.left()));
    vertices[kind] = decode_vertices(kind, bytes.take(length), count);
  }
  std::map<Kind, std::size_t> used;
  std::vector<motion::Clip> clips;
  std::size_t stream = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    Eigen::MatrixXd values(head.rows(), static_cast<Eigen::Index>(kept[i].size()));
    for_streams(head, [&](const Channel& channel, int first, const Kind& kind) {
      const std::size_t count = stream_keys[stream++];
      const float* keys = vertices[kind].data() + used[kind] * at(kind.width);
      used[kind] += count;
      for (Eigen::Index k = 0; k < values.cols(); ++k)
        for (int a = 0; a < kind.width; ++a)
          values(channel.first + first + a, k) =
              static_cast<double>(keys[(count == 1 ? 0 : static_cast<std::size_t>(k)) * at(kind.width) + at(a)]);
    });
    Head sparse;
    sparse.channels = head.channels;
    sparse.times.resize(1);
    for (const Eigen::Index n : kept[i]) sparse.times[0].push_back(times[i][static_cast<std::size_t>(n)]);
    clips.push_back(to_clip(sparse, 0, values));
  }
  return clips;
}

class MeshoptEncoder : public Encoder {
 public:
  MeshoptEncoder(const codec::Source& source, const EncodeSettings& settings)
      : source_(source), threads_(settings.threads), data_(motion_data(source)) {}

  Bytes encode(double knob) override {
    const motion::ErrorMeter meter(source_.skeleton, source_.all_points);
    std::vector<Keys> clips(data_.clips.size());
    parallel_for(clips.size(), threads_, [&](std::size_t i) { clips[i] = best(meter, i, knob * source_.size); });
    Keys all;
    for (const Keys& clip : clips) all.add(clip);
    ByteWriter bytes;
    write_head(bytes, data_.head);
    bytes.raw(write_keys(all));
    return bytes.take();
  }

 private:
  /// All keys at the most bits where nothing is within the bound.
  Keys best(const motion::ErrorMeter& meter, std::size_t i, double bound) const {
    const auto keys = [&](int stride, int bits) { return keys_of_clip(data_.head, data_.clips[i], stride, bits); };
    const auto holds = [&](int stride, int bits) {
      const Bytes bytes = write_keys(keys(stride, bits));
      ByteReader reader(bytes);
      return largest_error(source_, meter, i, read_keys(data_.head, {data_.head.times[i]}, reader).front()) <= bound;
    };
    Keys smallest = keys(1, most_bits);
    std::size_t least = write_keys(smallest).size();
    for (const int stride : strides) {
      if (stride > 1 && stride >= data_.clips[i].cols()) break;
      if (!holds(stride, most_bits)) break;
      Keys made = keys(stride, coarsest_setting(fewest_bits, most_bits, [&](int b) { return holds(stride, b); }));
      const std::size_t size = write_keys(made).size();
      if (size >= least) continue;
      least = size;
      smallest = std::move(made);
    }
    return smallest;
  }

  const codec::Source& source_;
  int threads_;
  MotionData data_;
};

}  // namespace

std::unique_ptr<Encoder> prepare_meshopt(const codec::Source& source, const EncodeSettings& settings) {
  return std::make_unique<MeshoptEncoder>(source, settings);
}

std::vector<motion::Clip> decode_meshopt(std::span<const std::uint8_t> input, const motion::Skeleton& skeleton) {
  ByteReader bytes(input);
  const Head head = read_head(bytes, skeleton);
  std::vector<motion::Clip> clips = read_keys(head, head.times, bytes);
  bytes.expect_end();
  return clips;
}

}  // namespace nmc::baselines
