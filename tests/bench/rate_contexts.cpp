#include "rate_contexts.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <stdexcept>
#include <vector>

#include "codec/decoded_set.h"
#include "codec/reference_codec.h"
#include "gltf/edit.h"
#include "rate_codec.h"

namespace nmc::bench {
namespace {

/// A plain model (gltf_ext/README.md, A.2).
class Model {
 public:
  /// The bits that a decision costs; learns it.
  double code(bool bit) {
    const double cost = -std::log2((bit ? p_ : 65536.0 - p_) / 65536.0);
    const std::uint32_t rate = 131072 / (2 * n_ + 3);
    p_ = bit ? p_ + (((65535 - p_) * rate) >> 16) : p_ - ((p_ * rate) >> 16);
    p_ = std::clamp(p_, 32u, 65503u);
    n_ = std::min(n_ + 1, 30u);
    return cost;
  }

 private:
  std::uint32_t p_ = 32768, n_ = 0;
};

/// The numbers of one kind: bit length in unary, the bits below the first, the sign, as A.2 has them with one run.
class Run {
 public:
  double unsigned_number(std::uint32_t value) {
    const auto length = static_cast<std::size_t>(std::bit_width(value));
    double bits = 0;
    for (std::size_t k = 0; k <= length; ++k) bits += unary_[std::min(k, unary_.size() - 1)].code(k < length);
    if (length < 2) return bits;
    std::array<Model, 3>& below = below_[length - 1];
    const bool first = (value >> (length - 2) & 1u) != 0;
    bits += below[0].code(first);
    if (length > 2) bits += below[first ? 2 : 1].code((value >> (length - 3) & 1u) != 0);
    return bits + static_cast<double>(length > 3 ? length - 3 : 0);
  }

  double signed_number(std::int64_t value) {
    const double bits = unsigned_number(static_cast<std::uint32_t>(std::abs(value)));
    return value == 0 ? bits : bits + sign_.code(value < 0);
  }

 private:
  std::array<Model, 12> unary_;
  std::array<std::array<Model, 3>, 32> below_;
  Model sign_;
};

std::int64_t level_of(float value, double step) {
  const double steps = static_cast<double>(value) / step;
  if (std::abs(steps - std::round(steps)) > 0.1) throw std::logic_error("a value that is no whole number of steps");
  return std::llround(steps);
}

/// Walks over an opened set as the decoder does, one run for each kind of number.
class Counter {
 public:
  explicit Counter(const nmc_set& set) : set_(set), pose_(set.info.slots) {}

  double bits() {
    double sum = references();
    for (std::uint32_t c = 0; c < set_.info.clips; ++c) sum += states(c) + anchors(c) + weights(c);
    return sum;
  }

 private:
  double slot_step(std::uint32_t slot) const {
    return static_cast<double>(set_.base_step) * std::exp2(-set_.step_exponents[slot] / 2.0);
  }
  double anchor_step(std::uint32_t slot) const { return slot_step(slot) * std::exp2(-set_.anchor_exponent / 4.0); }

  std::uint8_t state(std::uint32_t clip, std::uint32_t target) const {
    return set_.states[std::size_t{clip} * set_.info.targets + target];
  }

  std::uint32_t parameters(std::uint32_t clip, std::uint32_t t) const {
    if (state(clip, t) == NMC_ABSENT) return 0;
    return set_.targets[t].path == NMC_ROTATION && state(clip, t) != NMC_QUATERNION ? 3 : set_.targets[t].width;
  }

  double references() {
    double bits = 0;
    std::int32_t before = 0;
    for (std::uint32_t t = 0; t < set_.info.targets; ++t) {
      const nmc_target& target = set_.targets[t];
      const std::uint32_t coded = target.path == NMC_ROTATION ? 3 : target.width;
      for (std::uint32_t slot = target.offset; slot < target.offset + coded; ++slot) {
        bits += exponent_.signed_number(set_.step_exponents[slot] - before);
        before = set_.step_exponents[slot];
        bits += reference_.signed_number(level_of(set_.references[slot], anchor_step(slot)));
      }
    }
    return bits;
  }

  double states(std::uint32_t clip) {
    double bits = 0;
    for (std::uint32_t t = 0; t < set_.info.targets; ++t) bits += state_.unsigned_number(state(clip, t));
    return bits;
  }

  /// Puts the last anchor pose of a clip into pose_, by slots; targets it lacks are 0.
  void recall(std::int32_t index) {
    std::fill(pose_.begin(), pose_.end(), 0);
    if (index < 0) return;
    const auto clip = static_cast<std::uint32_t>(index);
    const nmc_clip& from = set_.clips[clip];
    const float* row = set_.anchors + from.first_anchor + std::size_t{from.anchor_rows - 1} * from.parameters;
    for (std::uint32_t t = 0; t < set_.info.targets; row += parameters(clip, t), ++t) {
      if (state(clip, t) == NMC_QUATERNION) continue;
      const std::uint32_t offset = set_.targets[t].offset;
      for (std::uint32_t a = 0; a < parameters(clip, t); ++a)
        pose_[offset + a] = level_of(row[a], anchor_step(offset + a));
    }
  }

  double anchors(std::uint32_t clip) {
    const nmc_clip& from = set_.clips[clip];
    double bits = back_.unsigned_number(static_cast<std::uint32_t>(static_cast<int>(clip) - from.reference - 1));
    recall(from.reference);
    const float* value = set_.anchors + from.first_anchor;
    for (std::uint32_t r = 0; r < from.anchor_rows; ++r)
      for (std::uint32_t t = 0; t < set_.info.targets; ++t)
        for (std::uint32_t a = 0; a < parameters(clip, t); ++a, ++value) {
          const std::uint32_t slot = set_.targets[t].offset + a;
          const std::int64_t guess = r == 0 && state(clip, t) == NMC_QUATERNION ? 0 : pose_[slot];
          const std::int64_t level = level_of(*value, anchor_step(slot));
          if (r == 0 || state(clip, t) >= NMC_MOVING) bits += anchor_.signed_number(level - guess);
          pose_[slot] = level;
        }
    return bits;
  }

  double weights(std::uint32_t clip) {
    const nmc_clip& from = set_.clips[clip];
    double bits = clip_exponent_.signed_number(from.step_exponent);
    if (set_.info.max_features == 0) return bits;
    for (std::uint32_t w = 0; w < from.windows; ++w) {
      const nmc_window& window = set_.windows[from.first_window + w];
      std::span<const nmc_weight> left(set_.weights + window.first_weight, window.weights);
      std::uint32_t parameter = 0;
      for (std::uint32_t t = 0; t < set_.info.targets; ++t)
        for (std::uint32_t a = 0; a < parameters(clip, t); ++a, ++parameter)
          if (state(clip, t) >= NMC_MOVING)
            bits += row(parameter, weight_step(from, window, set_.targets[t].offset + a), left);
    }
    return bits;
  }

  double weight_step(const nmc_clip& clip, const nmc_window& window, std::uint32_t slot) const {
    return slot_step(slot) * std::exp2(-clip.step_exponent / 4.0) * std::sqrt(2.0 / window.length);
  }

  /// The weights of one parameter, taken off the front of `left`.
  double row(std::uint32_t parameter, double step, std::span<const nmc_weight>& left) {
    std::size_t size = 0;
    while (size < left.size() && left[size].parameter == parameter) ++size;
    const std::span<const nmc_weight> own = left.first(size);
    left = left.subspan(size);
    double bits = count_.unsigned_number(own.empty() ? 0 : own.back().feature);
    std::uint32_t feature = 1;
    for (const nmc_weight& weight : own) {
      for (; feature < weight.feature; ++feature) bits += weight_.signed_number(0);
      bits += weight_.signed_number(level_of(weight.value, step));
      ++feature;
    }
    return bits;
  }

  const nmc_set& set_;
  std::vector<std::int64_t> pose_;
  Run exponent_, reference_, state_, back_, anchor_, clip_exponent_, count_, weight_;
};

/// By how many bytes a stream would be longer.
double added_bytes(std::span<const std::uint8_t> stream) {
  const codec::DecodedSet decoded(stream, "the stream");
  const codec::PartBits bits = decoded.bits();
  return (Counter(decoded.raw()).bits() - (bits.references + bits.states + bits.anchors + bits.weights)) / 8;
}

}  // namespace

Measurement measure_without_contexts(const std::filesystem::path& path, const codec::CompressOptions& options) {
  const gltf::Document made = codec::compress(gltf::read_document(path), options).document;
  Measurement row;
  row.method = "without contexts";
  row.reached = true;
  row.note = "counted, not written";
  measure_result(Reference(path), made, row);
  double added = 0;
  for (const gltf::ClipSetBytes& set : gltf::read_compression(made).clip_sets) added += added_bytes(set.stream);
  row.key_bytes += static_cast<std::size_t>(std::llround(added));
  return row;
}

}  // namespace nmc::bench
