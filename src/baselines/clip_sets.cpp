#include "baselines/clip_sets.h"

#include <string>

#include "baselines/motion_data.h"
#include "codec/decoded_set.h"
#include "motion/index.h"

namespace nmc::baselines {
namespace {

constexpr std::uint64_t most = 65535;

void check_fits(const codec::DecodedSet& set, const std::vector<codec::NodeTarget>& targets) {
  if (set.target_count() != targets.size()) refuse_damaged("a stream has other targets");
  for (std::size_t t = 0; t < targets.size(); ++t)
    if (set.path(t) != targets[t].path || set.width(t) != targets[t].width)
      refuse_damaged("a stream has other targets");
}

}  // namespace

Bytes write_sets(std::span<const codec::EncodedSet> sets, std::size_t clips) {
  ByteWriter bytes;
  ByteWriter targets;
  bytes.count(clips);
  bytes.count(sets.size());
  for (const codec::EncodedSet& set : sets) {
    targets.count(set.clips.size());
    for (const std::size_t clip : set.clips) targets.count(clip);
    targets.count(set.targets.size());
    for (const codec::NodeTarget& target : set.targets) write_target(targets, target);
  }
  bytes.packed(targets.bytes());
  for (const codec::EncodedSet& set : sets) {
    bytes.count(set.stream.size());
    bytes.raw(set.stream);
  }
  return bytes.take();
}

std::vector<motion::Clip> decode_sets(std::span<const std::uint8_t> input, const motion::Skeleton& skeleton) {
  ByteReader bytes(input);
  std::vector<motion::Clip> clips(static_cast<std::size_t>(bytes.count(most)));
  const auto sets = static_cast<std::size_t>(bytes.count(most));
  const Bytes unpacked = bytes.packed();
  ByteReader part(unpacked);
  for (std::size_t s = 0; s < sets; ++s) {
    std::vector<std::size_t> places(static_cast<std::size_t>(part.count(clips.size())));
    for (std::size_t& place : places) {
      if (clips.empty()) refuse_damaged("there are no clips");
      place = static_cast<std::size_t>(part.count(clips.size() - 1));
    }
    std::vector<codec::NodeTarget> targets(
        static_cast<std::size_t>(part.count(std::min<std::uint64_t>(most, part.left()))));
    std::vector<int> nodes;
    for (codec::NodeTarget& target : targets) {
      target = read_target(part, skeleton);
      nodes.push_back(target.node);
    }
    const auto stream = bytes.take(static_cast<std::size_t>(bytes.count(bytes.left())));
    const codec::DecodedSet set(stream, "the encoded motion");
    check_fits(set, targets);
    if (set.clip_count() != places.size()) refuse_damaged("a stream has other clips");
    for (std::size_t i = 0; i < places.size(); ++i) clips[places[i]] = set.clip(i, nodes);
  }
  part.expect_end();
  bytes.expect_end();
  return clips;
}

}  // namespace nmc::baselines
