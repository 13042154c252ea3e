// Any bytes as a stream: the C decoder refuses them, or opens something that plays with finite numbers. The checksum is
// repaired, so that what lies behind it is reached.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "codec/reference_codec.h"
#include "fuzz/require.h"

namespace {

/// Most steps of work that one input may ask for: what makes all keys has a limit of its own (gltf_ext/README.md,
/// Cost).
constexpr std::uint64_t most_work = 1 << 22;

void play(const nmc_set& set, const nmc_info& info) {
  std::vector<std::uint64_t> scratch(info.scratch_bytes / 8 + 1);
  std::vector<float> pose(info.slots);
  const std::uint64_t pose_work = info.slots + std::uint64_t{info.weights} + info.atoms + info.dense + 1;
  std::uint64_t work = 0;
  for (std::uint32_t clip = 0; clip < info.clips; ++clip) {
    const float* times = nmc_times(&set, clip);
    const std::uint32_t samples = set.clips[clip].samples;
    for (std::uint32_t n = 0; n < samples; ++n) nmc::fuzz::require(std::isfinite(times[n]), "times are finite");
    for (const std::uint32_t n : {0u, samples / 2, samples - 1}) {
      if ((work += pose_work) > most_work) return;
      nmc::fuzz::require(nmc_sample(&set, clip, n, pose.data(), scratch.data()) == NMC_OK, "a sample can be had");
    }
    for (const double t : {-1e300, 0.5 * (times[0] + times[samples - 1]), 1e300}) {
      for (const int mode : {NMC_CLAMP, NMC_LOOP}) {
        if ((work += 2 * pose_work) > most_work) return;
        nmc::fuzz::require(nmc_evaluate(&set, clip, t, mode, pose.data(), scratch.data()) == NMC_OK, "any time plays");
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // A block of exactly this size, for the sanitizer to see a step outside.
  const std::unique_ptr<std::uint8_t[]> bytes(new std::uint8_t[size]);
  std::copy_n(data, size, bytes.get());
  if (size >= 8) {
    const std::uint32_t sum = nmc_checksum(bytes.get() + 8, size - 8);
    for (std::size_t i = 0; i < 4; ++i) bytes[4 + i] = static_cast<std::uint8_t>(sum >> (8 * i));
  }
  nmc_info info;
  if (nmc_read_info(bytes.get(), size, &info) != NMC_OK) return 0;
  nmc::fuzz::require(info.workspace_bytes < (std::uint64_t{1} << 30), "memory is bounded by the size of the stream");
  std::vector<std::uint64_t> workspace((info.workspace_bytes + 7) / 8);
  nmc_set set;
  if (nmc_open(&set, bytes.get(), size, workspace.data(), workspace.size() * 8) == NMC_OK) play(set, info);
  return 0;
}
