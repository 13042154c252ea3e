#include "codec/clip_set.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "codec/key_times.h"
#include "codec/reference_codec.h"

namespace nmc::codec {
namespace {

static_assert(LevelAtom::jump_width == NMC_JUMP);

using Bytes = std::vector<std::uint8_t>;

[[noreturn]] void too_large(const char* what) {
  throw Error(ErrorCode::unsupported, std::string("the animations have too many ") + what +
                                          " for one clip set; split the file or exclude some animations");
}

std::uint32_t checked(std::uint64_t count, std::uint64_t most, const char* what) {
  if (count > most) too_large(what);
  return static_cast<std::uint32_t>(count);
}

int clip_parameters(const ClipSet& set, const LevelClip& clip) {
  int count = 0;
  for (std::size_t t = 0; t < set.targets.size(); ++t) count += parameter_count(set.targets[t], clip.states[t]);
  return count;
}

nmc_info counts_of(const ClipSet& set) {
  nmc_info info{};
  std::uint64_t slots = 0, samples = 0, windows = 0, anchors = 0, weights = 0, atoms = 0, features = 0, dense = 0,
                frequencies = 0;
  for (const SetTarget& target : set.targets) slots += static_cast<std::uint64_t>(target.width);
  for (const LevelClip& clip : set.clips) {
    samples += clip.times.size();
    windows += clip.windows.size();
    anchors += clip.anchors.size();
    atoms += clip.atoms.size();
    dense += clip.layer.half_cycles.size() + clip.layer.w0.size() + clip.layer.b0.size();
    frequencies = std::max<std::uint64_t>(frequencies, clip.layer.half_cycles.size());
    for (const LevelWindow& window : clip.windows) {
      weights += window.weights.size();
      for (const LevelWeight& weight : window.weights)
        features = std::max<std::uint64_t>(features, static_cast<std::uint64_t>(weight.feature));
    }
  }
  if (set.has_network)
    dense += set.shared.w1.size() + set.shared.b1.size() + set.shared.w2.size() + set.shared.b2.size();
  constexpr std::uint64_t most = 0x7fffffff;
  info.slots = checked(slots, 65535, "parameters");
  info.targets = checked(set.targets.size(), 65535, "targets");
  info.clips = checked(set.clips.size(), 65535, "clips");
  info.samples = checked(samples, 1u << 27, "keys");
  info.windows = checked(windows, most, "windows");
  info.anchors = checked(anchors, most, "anchor poses");
  info.weights = checked(weights, most, "weights");
  info.atoms = checked(atoms, most, "corrections");
  info.max_features = checked(features, 65535, "frequencies");
  info.dense = checked(dense, most, "network weights");
  info.hidden0 = static_cast<std::uint32_t>(set.shared.hidden0);
  info.hidden1 = static_cast<std::uint32_t>(set.shared.hidden1);
  info.max_frequencies = static_cast<std::uint32_t>(frequencies);
  nmc_measure(&info);
  return info;
}

/// The C structure with its memory.
struct Filled {
  std::vector<std::uint64_t> workspace;
  nmc_set set{};
};

/// Levels are whole numbers that a float holds.
float level_as_float(std::int32_t level) {
  if (level > -(1 << 23) && level < 1 << 23) return static_cast<float>(level);
  throw Error(ErrorCode::unsupported,
              "the tolerance is finer than the format's 23 bits can follow the motion; allow a larger error");
}

void fill_targets(const ClipSet& from, nmc_set& to) {
  std::uint32_t offset = 0;
  for (std::size_t t = 0; t < from.targets.size(); ++t) {
    const SetTarget& target = from.targets[t];
    to.targets[t] = {static_cast<std::uint8_t>(target.path), static_cast<std::uint16_t>(target.width), offset};
    for (int a = 0; a < target.width; ++a, ++offset) {
      const auto i = static_cast<std::size_t>(a);
      if (i < target.step_exponents.size()) to.step_exponents[offset] = target.step_exponents[i];
      if (from.exact_references)
        to.references[offset] = target.exact_reference[i];
      else if (i < target.reference.size())
        to.references[offset] = level_as_float(target.reference[i]);
    }
  }
}

void fill_times(const LevelClip& from, nmc_clip& to, float* times) {
  set_formula(fit_times(from.times), to);
  std::copy(from.times.begin(), from.times.end(), times);
}

struct Cursor {
  std::uint32_t time = 0, window = 0, anchor = 0, weight = 0, atom = 0, dense = 0;
};

void append(nmc_set& to, Cursor& at, std::span<const float> values) {
  std::copy(values.begin(), values.end(), to.dense + at.dense);
  at.dense += static_cast<std::uint32_t>(values.size());
}

void fill_clip(const ClipSet& set, const LevelClip& from, std::size_t index, nmc_set& to, Cursor& at) {
  nmc_clip& clip = to.clips[index];
  clip.samples = static_cast<std::uint32_t>(from.times.size());
  clip.first_time = at.time;
  clip.first_window = at.window;
  clip.windows = static_cast<std::uint32_t>(from.windows.size());
  clip.first_anchor = at.anchor;
  clip.first_atom = at.atom;
  clip.atoms = static_cast<std::uint32_t>(from.atoms.size());
  clip.parameters = static_cast<std::uint32_t>(clip_parameters(set, from));
  clip.anchor_rows = clip.parameters ? static_cast<std::uint32_t>(from.anchors.size()) / clip.parameters : 0;
  clip.frequencies = static_cast<std::uint32_t>(from.layer.half_cycles.size());
  clip.reference = from.reference;
  clip.step_exponent = from.step_exponent;
  clip.basis = static_cast<std::uint8_t>(from.basis);
  fill_times(from, clip, to.times + at.time);
  at.time += clip.samples;
  for (std::size_t t = 0; t < set.targets.size(); ++t)
    to.states[index * set.targets.size() + t] = static_cast<std::uint8_t>(from.states[t]);
  for (const std::int32_t level : from.anchors) to.anchors[at.anchor++] = level_as_float(level);
  for (const LevelWindow& window : from.windows) {
    to.windows[at.window++] = {window.begin, window.length, at.weight,
                               static_cast<std::uint32_t>(window.weights.size()), 0};
    for (const LevelWeight& weight : window.weights)
      to.weights[at.weight++] = {static_cast<std::uint16_t>(weight.feature),
                                 static_cast<std::uint16_t>(weight.parameter), level_as_float(weight.level)};
  }
  for (const LevelAtom& atom : from.atoms)
    to.atoms[at.atom++] = {atom.sample, static_cast<std::uint16_t>(atom.parameter),
                           static_cast<std::uint16_t>(atom.width), level_as_float(atom.level)};
  if (!set.has_network) return;
  clip.first_dense = at.dense;
  for (const int k : from.layer.half_cycles) to.dense[at.dense++] = static_cast<float>(k);
  append(to, at, from.layer.w0);
  append(to, at, from.layer.b0);
}

Filled fill(const ClipSet& set) {
  Filled filled;
  filled.set.info = counts_of(set);
  filled.workspace.resize(filled.set.info.workspace_bytes / 8 + 1);
  if (nmc_carve(&filled.set, filled.workspace.data(), filled.workspace.size() * 8) != NMC_OK)
    throw Error(ErrorCode::internal, "the clip set's memory does not fit; please report this");
  filled.set.exact_references = set.exact_references;
  filled.set.has_network = set.has_network;
  filled.set.quantized_network = set.quantized_network;
  filled.set.base_step = set.base_step;
  filled.set.anchor_exponent = set.anchor_exponent;
  fill_targets(set, filled.set);
  Cursor at;
  for (std::size_t i = 0; i < set.clips.size(); ++i) fill_clip(set, set.clips[i], i, filled.set, at);
  if (!set.has_network) return filled;
  filled.set.outputs = static_cast<std::uint32_t>(set.shared.outputs);
  filled.set.first_shared = at.dense;
  for (const std::vector<float>* tensor : {&set.shared.w1, &set.shared.b1, &set.shared.w2, &set.shared.b2})
    append(filled.set, at, *tensor);
  return filled;
}

void put_varint(Bytes& bytes, std::uint32_t value) {
  for (; value >= 128; value >>= 7) bytes.push_back(static_cast<std::uint8_t>(value | 128u));
  bytes.push_back(static_cast<std::uint8_t>(value));
}

void run(Filled& filled, nmc_sink& sink) {
  if (const nmc_result result = nmc_write_payload(&filled.set, &sink); result != NMC_OK)
    throw Error(ErrorCode::internal, std::string("the encoder made a clip set that cannot be written (") +
                                         nmc_message(result) + "); please report this");
}

PartBits parts_of(const double (&bits)[NMC_PARTS]) {
  return {bits[NMC_PART_HEADER],  bits[NMC_PART_REFERENCES], bits[NMC_PART_TIMES], bits[NMC_PART_STATES],
          bits[NMC_PART_ANCHORS], bits[NMC_PART_WEIGHTS],    bits[NMC_PART_ATOMS], bits[NMC_PART_NETWORK]};
}

double power_of_quarters(int exponent) { return std::exp2(-exponent / 4.0); }

}  // namespace

int parameter_count(const SetTarget& target, State state) {
  if (state == State::absent) return 0;
  return target.path == Path::rotation && state != State::quaternion ? 3 : target.width;
}

std::vector<std::uint8_t> write_clip_set(const ClipSet& set) {
  Filled filled = fill(set);
  const nmc_info& info = filled.set.info;
  Bytes bytes{'N', 'M', 'C', NMC_VERSION, 0, 0, 0, 0};
  for (const std::uint32_t count : {info.slots, info.targets, info.clips, info.samples, info.windows, info.anchors,
                                    info.weights, info.atoms, info.max_features, info.dense})
    put_varint(bytes, count);
  if (info.dense > 0)
    for (const std::uint32_t count : {info.hidden0, info.hidden1, info.max_frequencies}) put_varint(bytes, count);
  nmc_sink sink{};
  sink.user = &bytes;
  sink.put = [](void* user, std::uint8_t byte) { static_cast<Bytes*>(user)->push_back(byte); };
  run(filled, sink);
  const std::uint32_t sum = nmc_checksum(bytes.data() + 8, bytes.size() - 8);
  for (std::size_t i = 0; i < 4; ++i) bytes[4 + i] = static_cast<std::uint8_t>(sum >> (8 * i));
  nmc_info read;
  if (nmc_read_info(bytes.data(), bytes.size(), &read) == NMC_ERROR_LIMIT) too_large("keys for their content");
  return bytes;
}

PartBits count_bits(const ClipSet& set) {
  Filled filled = fill(set);
  nmc_sink sink{};
  run(filled, sink);
  return parts_of(sink.bits);
}

double slot_step(const ClipSet& set, const SetTarget& target, int axis) {
  return set.base_step * std::exp2(-target.step_exponents[static_cast<std::size_t>(axis)] / 2.0);
}

double anchor_step(const ClipSet& set, const SetTarget& target, int axis) {
  return slot_step(set, target, axis) * power_of_quarters(set.anchor_exponent);
}

}  // namespace nmc::codec
