// Keys as EXT_meshopt_compression stores them.
#include <meshoptimizer.h>

#include <algorithm>

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

std::size_t vertex_size(const Channel& channel, int width) {
  return channel.target.path == Path::rotation ? 8 : 4 * at(width);
}

template <typename Use>
void for_streams(const Head& head, const Use& use) {
  for (const Channel& channel : head.channels) {
    if (!channel.moves) continue;
    for (int first = 0; first < channel.target.width; first += static_cast<int>(most_width))
      use(channel, first, std::min(static_cast<int>(most_width), channel.target.width - first));
  }
}

Bytes encode_stream(const Channel& channel, const std::vector<float>& keys, std::size_t count, int width, int bits) {
  const std::size_t size = vertex_size(channel, width);
  Bytes filtered(count * size);
  if (channel.target.path == Path::rotation)
    meshopt_encodeFilterQuat(filtered.data(), count, size, bits, keys.data());
  else
    meshopt_encodeFilterExp(filtered.data(), count, size, std::min(24, bits + extra_bits), keys.data());
  Bytes encoded(meshopt_encodeVertexBufferBound(count, size));
  encoded.resize(meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), filtered.data(), count, size));
  return encoded;
}

std::vector<float> decode_stream(const Channel& channel, std::span<const std::uint8_t> bytes, std::size_t count,
                                 int width) {
  const std::size_t size = vertex_size(channel, width);
  std::vector<float> keys(count * at(width));
  if (channel.target.path != Path::rotation) {
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

bool is_constant(const Channel& channel, const Eigen::MatrixXd& values) {
  const auto rows = values.middleRows(channel.first, channel.target.width);
  return (rows.colwise() - rows.col(0)).isZero(0);
}

/// One clip: the stride, then for each stream whether it has one key, its length and its bytes.
Bytes encode_clip(const Head& head, const Eigen::MatrixXd& values, int stride, int bits) {
  ByteWriter bytes;
  bytes.u8(static_cast<unsigned>(stride));
  const std::vector<Eigen::Index> all = kept_keys(values.cols(), stride);
  for_streams(head, [&](const Channel& channel, int first, int width) {
    const std::size_t count = is_constant(channel, values) ? 1 : all.size();
    std::vector<float> keys;
    for (std::size_t k = 0; k < count; ++k)
      for (int a = 0; a < width; ++a) keys.push_back(static_cast<float>(values(channel.first + first + a, all[k])));
    const Bytes encoded = encode_stream(channel, keys, count, width, bits);
    bytes.count(2 * encoded.size() + (count == 1 ? 1 : 0));
    bytes.raw(encoded);
  });
  return bytes.take();
}

motion::Clip decode_clip(const Head& head, std::size_t index, ByteReader& bytes) {
  const auto stride = static_cast<int>(bytes.u8());
  if (stride == 0) refuse_damaged("no keys are kept");
  const std::vector<Eigen::Index> kept = kept_keys(static_cast<Eigen::Index>(head.times[index].size()), stride);
  Eigen::MatrixXd values(head.rows(), static_cast<Eigen::Index>(kept.size()));
  for_streams(head, [&](const Channel& channel, int first, int width) {
    const std::uint64_t length = bytes.count(2 * bytes.left() + 1);
    const std::size_t count = length % 2 ? 1 : kept.size();
    const std::vector<float> keys =
        decode_stream(channel, bytes.take(static_cast<std::size_t>(length / 2)), count, width);
    for (Eigen::Index k = 0; k < values.cols(); ++k)
      for (int a = 0; a < width; ++a)
        values(channel.first + first + a, k) =
            static_cast<double>(keys[(count == 1 ? 0 : static_cast<std::size_t>(k)) * at(width) + at(a)]);
  });
  Head sparse;
  sparse.channels = head.channels;
  sparse.times.resize(1);
  for (const Eigen::Index n : kept) sparse.times[0].push_back(head.times[index][static_cast<std::size_t>(n)]);
  return to_clip(sparse, 0, values);
}

class MeshoptEncoder : public Encoder {
 public:
  MeshoptEncoder(const codec::Source& source, const EncodeSettings& settings)
      : source_(source), threads_(settings.threads), data_(motion_data(source)) {}

  Bytes encode(double knob) override {
    const motion::ErrorMeter meter(source_.skeleton, source_.all_points);
    std::vector<Bytes> clips(data_.clips.size());
    parallel_for(clips.size(), threads_, [&](std::size_t i) { clips[i] = best(meter, i, knob * source_.size); });
    ByteWriter bytes;
    write_head(bytes, data_.head);
    for (const Bytes& clip : clips) bytes.raw(clip);
    return bytes.take();
  }

 private:
  /// All keys at the most bits where nothing is within the bound.
  Bytes best(const motion::ErrorMeter& meter, std::size_t i, double bound) const {
    const auto holds = [&](const Bytes& bytes) {
      ByteReader reader(bytes);
      return largest_error(source_, meter, i, decode_clip(data_.head, i, reader)) <= bound;
    };
    Bytes smallest = encode_clip(data_.head, data_.clips[i], 1, most_bits);
    for (const int stride : strides) {
      if (stride > 1 && stride >= data_.clips[i].cols()) break;
      Bytes finest = encode_clip(data_.head, data_.clips[i], stride, most_bits);
      if (!holds(finest)) break;
      const int bits = coarsest_setting(
          fewest_bits, most_bits, [&](int b) { return holds(encode_clip(data_.head, data_.clips[i], stride, b)); });
      Bytes made = encode_clip(data_.head, data_.clips[i], stride, bits);
      if (made.size() < smallest.size()) smallest = std::move(made);
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
  std::vector<motion::Clip> clips;
  for (std::size_t i = 0; i < head.times.size(); ++i) clips.push_back(decode_clip(head, i, bytes));
  bytes.expect_end();
  return clips;
}

}  // namespace nmc::baselines
