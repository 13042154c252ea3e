// Draco's keyframe animations.
#include <draco/animation/keyframe_animation.h>
#include <draco/animation/keyframe_animation_decoder.h>
#include <draco/animation/keyframe_animation_encoder.h>

#include "base/error.h"
#include "base/parallel.h"
#include "baselines/bounded_search.h"
#include "baselines/motion_data.h"
#include "baselines/simple_methods.h"
#include "motion/error.h"

namespace nmc::baselines {
namespace {

constexpr int fewest_bits = 2, most_bits = 24;
constexpr unsigned most_components = 127;  // of one Draco attribute

/// Runs of a channel's values that fit one attribute.
template <typename Use>
void for_parts(const Head& head, const Use& use) {
  for (const Channel& channel : head.channels) {
    if (!channel.moves) continue;
    const auto width = static_cast<unsigned>(channel.target.width);
    for (unsigned first = 0; first < width; first += most_components)
      use(channel.first + static_cast<int>(first), static_cast<int>(std::min(most_components, width - first)));
  }
}

/// The frame's number stands for its time, which the head has.
Bytes encode_clip(const Head& head, const Eigen::MatrixXd& values, int bits) {
  draco::KeyframeAnimation animation;
  std::vector<float> numbers;
  for (Eigen::Index n = 0; n < values.cols(); ++n) numbers.push_back(static_cast<float>(n));
  animation.SetTimestamps(numbers);
  draco::EncoderOptions options = draco::EncoderOptions::CreateDefaultOptions();
  options.SetSpeed(0, 0);
  int attributes = 0;
  options.SetAttributeInt(attributes++, "quantization_bits", 16);
  for_parts(head, [&](int first, int width) {
    std::vector<float> keys;
    for (Eigen::Index n = 0; n < values.cols(); ++n)
      for (int a = 0; a < width; ++a) keys.push_back(static_cast<float>(values(first + a, n)));
    animation.AddKeyframes(draco::DT_FLOAT32, static_cast<unsigned>(width), keys);
    options.SetAttributeInt(attributes++, "quantization_bits", bits);
  });
  draco::EncoderBuffer buffer;
  draco::KeyframeAnimationEncoder encoder;
  if (const draco::Status status = encoder.EncodeKeyframeAnimation(animation, options, &buffer); !status.ok())
    throw Error(ErrorCode::unsupported, "Draco does not take an animation: " + status.error_msg_string());
  const auto* data = reinterpret_cast<const std::uint8_t*>(buffer.data());
  return {data, data + buffer.size()};
}

Eigen::MatrixXd decode_clip(const Head& head, std::size_t clip, std::span<const std::uint8_t> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::KeyframeAnimation animation;
  draco::KeyframeAnimationDecoder decoder;
  const auto frames = static_cast<Eigen::Index>(head.times[clip].size());
  if (!decoder.Decode(draco::DecoderOptions(), &buffer, &animation).ok()) refuse_damaged("Draco does not read it");
  if (animation.num_frames() != frames) refuse_damaged("Draco gives another number of frames");
  Eigen::MatrixXd values(head.rows(), frames);
  int attribute = 1;
  for_parts(head, [&](int first, int width) {
    const draco::PointAttribute* keys =
        attribute < animation.num_attributes() ? animation.attribute(attribute) : nullptr;
    ++attribute;
    if (!keys || keys->num_components() != width) refuse_damaged("Draco gives other channels");
    std::vector<float> row(static_cast<std::size_t>(width));
    for (Eigen::Index n = 0; n < frames; ++n) {
      const draco::AttributeValueIndex index = keys->mapped_index(draco::PointIndex(static_cast<std::uint32_t>(n)));
      if (index.value() >= keys->size() ||
          !keys->ConvertValue<float>(index, static_cast<std::int8_t>(width), row.data()))
        refuse_damaged("Draco gives no values");
      for (int a = 0; a < width; ++a) values(first + a, n) = static_cast<double>(row[static_cast<std::size_t>(a)]);
    }
  });
  return values;
}

class DracoEncoder : public Encoder {
 public:
  DracoEncoder(const codec::Source& source, const EncodeSettings& settings)
      : source_(source), threads_(settings.threads), data_(motion_data(source)) {}

  Bytes encode(double knob) override {
    const motion::ErrorMeter meter(source_.skeleton, source_.all_points);
    std::vector<Bytes> clips(data_.clips.size());
    parallel_for(clips.size(), threads_, [&](std::size_t i) {
      const int bits = coarsest_setting(fewest_bits, most_bits, [&](int b) {
        const Bytes bytes = encode_clip(data_.head, data_.clips[i], b);
        const motion::Clip decoded = to_clip(data_.head, i, decode_clip(data_.head, i, bytes));
        return largest_error(source_, meter, i, decoded) <= knob * source_.size;
      });
      clips[i] = encode_clip(data_.head, data_.clips[i], bits);
    });
    ByteWriter bytes;
    write_head(bytes, data_.head);
    if (data_.head.rows() == 0) return bytes.take();
    for (const Bytes& clip : clips) {
      bytes.count(clip.size());
      bytes.raw(clip);
    }
    return bytes.take();
  }

 private:
  const codec::Source& source_;
  int threads_;
  MotionData data_;
};

}  // namespace

std::unique_ptr<Encoder> prepare_draco(const codec::Source& source, const EncodeSettings& settings) {
  return std::make_unique<DracoEncoder>(source, settings);
}

std::vector<motion::Clip> decode_draco(std::span<const std::uint8_t> input, const motion::Skeleton& skeleton) {
  ByteReader bytes(input);
  const Head head = read_head(bytes, skeleton);
  std::vector<Eigen::MatrixXd> clips;
  for (std::size_t i = 0; i < head.times.size(); ++i) {
    if (head.rows() == 0) {
      clips.emplace_back(0, static_cast<Eigen::Index>(head.times[i].size()));
      continue;
    }
    const auto part = bytes.take(static_cast<std::size_t>(bytes.count(bytes.left())));
    clips.push_back(decode_clip(head, i, part));
  }
  bytes.expect_end();
  return to_clips(head, clips);
}

}  // namespace nmc::baselines
