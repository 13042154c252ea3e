#include "codec/decoded_set.h"

#include <numeric>

#include "base/error.h"
#include "codec/reference_codec.h"

namespace nmc::codec {

struct DecodedSet::State {
  std::vector<std::uint64_t> workspace;
  nmc_set set{};
  std::vector<double> bits;  ///< NMC_PARTS for the whole set, then for each clip
};

namespace {

[[noreturn]] void fail(const std::string& name, nmc_result result) {
  throw Error(ErrorCode::invalid_input, name + ": " + nmc_message(result) + "; compress the original file again");
}

}  // namespace

DecodedSet::DecodedSet(std::span<const std::uint8_t> stream, const std::string& name)
    : state_(std::make_unique<State>()) {
  nmc_info info;
  if (const nmc_result result = nmc_read_info(stream.data(), stream.size(), &info); result != NMC_OK)
    fail(name, result);
  state_->workspace.resize(info.workspace_bytes / 8 + 1);
  state_->bits.assign((static_cast<std::size_t>(info.clips) + 1) * NMC_PARTS, 0.0);
  const nmc_result result = nmc_open_counting(&state_->set, stream.data(), stream.size(), state_->workspace.data(),
                                              state_->workspace.size() * 8, state_->bits.data());
  if (result != NMC_OK) fail(name, result);
}

DecodedSet::~DecodedSet() = default;
DecodedSet::DecodedSet(DecodedSet&&) noexcept = default;
DecodedSet& DecodedSet::operator=(DecodedSet&&) noexcept = default;

std::size_t DecodedSet::clip_count() const { return state_->set.info.clips; }
std::size_t DecodedSet::target_count() const { return state_->set.info.targets; }
Path DecodedSet::path(std::size_t target) const { return static_cast<Path>(state_->set.targets[target].path); }
int DecodedSet::width(std::size_t target) const { return state_->set.targets[target].width; }
const nmc_set& DecodedSet::raw() const { return state_->set; }

PartBits DecodedSet::bits() const {
  PartBits sum;
  for (std::size_t row = 0; row <= clip_count(); ++row) {
    const double* b = state_->bits.data() + row * NMC_PARTS;
    sum.header += b[NMC_PART_HEADER];
    sum.references += b[NMC_PART_REFERENCES];
    sum.times += b[NMC_PART_TIMES];
    sum.states += b[NMC_PART_STATES];
    sum.anchors += b[NMC_PART_ANCHORS];
    sum.weights += b[NMC_PART_WEIGHTS];
    sum.atoms += b[NMC_PART_ATOMS];
    sum.network += b[NMC_PART_NETWORK];
  }
  return sum;
}

double DecodedSet::clip_bits(std::size_t index) const {
  const double* b = state_->bits.data() + (index + 1) * NMC_PARTS;
  return std::accumulate(b, b + NMC_PARTS, 0.0);
}

motion::Clip DecodedSet::clip(std::size_t index, std::span<const int> nodes) const {
  const nmc_set& set = state_->set;
  const auto number = static_cast<std::uint32_t>(index);
  const std::uint32_t samples = set.clips[index].samples;
  motion::Clip clip;
  clip.times.assign(nmc_times(&set, number), nmc_times(&set, number) + samples);
  std::vector<std::size_t> targets;
  for (std::uint32_t t = 0; t < set.info.targets; ++t) {
    const int state = nmc_state(&set, number, t);
    if (state == NMC_ABSENT) continue;
    motion::Track track{nodes[t], static_cast<Path>(set.targets[t].path), set.targets[t].width, {}};
    track.values.reserve(static_cast<std::size_t>(track.width) * (state == NMC_STATIC ? 1 : samples));
    clip.tracks.push_back(std::move(track));
    targets.push_back(t);
  }
  std::vector<std::uint64_t> scratch(set.info.scratch_bytes / 8 + 1);
  std::vector<float> pose(set.info.slots);
  for (std::uint32_t n = 0; n < samples; ++n) {
    nmc_sample(&set, number, n, pose.data(), scratch.data());
    for (std::size_t i = 0; i < targets.size(); ++i) {
      motion::Track& track = clip.tracks[i];
      if (n > 0 && nmc_state(&set, number, static_cast<std::uint32_t>(targets[i])) == NMC_STATIC) continue;
      const float* value = pose.data() + set.targets[targets[i]].offset;
      // Neighbouring quaternions keep one sign, as glTF exporters write them.
      float sign = 1;
      if (track.path == Path::rotation && n > 0) {
        const float* last = track.values.data() + track.values.size() - 4;
        sign = last[0] * value[0] + last[1] * value[1] + last[2] * value[2] + last[3] * value[3] < 0 ? -1.0f : 1.0f;
      }
      for (int a = 0; a < track.width; ++a) track.values.push_back(sign * value[a]);
    }
  }
  return clip;
}

}  // namespace nmc::codec
