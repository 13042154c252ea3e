// Bytes that nobody wrote: the decoder says what is wrong or opens something it can play, and never takes long.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <random>
#include <string>

#include "base/error.h"
#include "codec/reference_codec.h"
#include "made_set.h"

namespace nmc::test {
namespace {

using codec::Basis;
using codec::State;
using Bytes = std::vector<std::uint8_t>;

void repair(Bytes& bytes) {
  if (bytes.size() < 8) return;
  const std::uint32_t sum = nmc_checksum(bytes.data() + 8, bytes.size() - 8);
  for (std::size_t i = 0; i < 4; ++i) bytes[4 + i] = static_cast<std::uint8_t>(sum >> (8 * i));
}

/// Reads, opens and, where that is possible, plays. The bytes lie in a block of exactly their size, and so does the
/// workspace, for the sanitizers to see a step outside.
nmc_result open_and_play(const Bytes& hostile) {
  const std::unique_ptr<std::uint8_t[]> bytes(new std::uint8_t[hostile.size()]);
  std::copy(hostile.begin(), hostile.end(), bytes.get());
  nmc_info info;
  if (const nmc_result result = nmc_read_info(bytes.get(), hostile.size(), &info); result != NMC_OK) return result;
  EXPECT_LT(info.workspace_bytes, 64u << 20) << "for a stream of " << hostile.size() << " bytes";
  std::vector<std::uint64_t> workspace((info.workspace_bytes + 7) / 8);
  nmc_set set;
  const nmc_result result =
      nmc_open(&set, bytes.get(), hostile.size(), workspace.data(), workspace.size() * sizeof(std::uint64_t));
  if (result != NMC_OK) return result;
  std::vector<std::uint64_t> scratch((info.scratch_bytes + 7) / 8);
  std::vector<float> pose(info.slots);
  for (std::uint32_t clip = 0; clip < std::min(info.clips, 4u); ++clip) {
    const float* times = nmc_times(&set, clip);
    const std::uint32_t samples = set.clips[clip].samples;
    for (const std::uint32_t n : {0u, samples / 2, samples - 1})
      EXPECT_EQ(nmc_sample(&set, clip, n, pose.data(), scratch.data()), NMC_OK);
    for (const double t : {-1e300, 0.0, times[0] + 0.01, static_cast<double>(times[samples - 1]) - 0.01, 1e300})
      for (const int mode : {NMC_CLAMP, NMC_LOOP})
        EXPECT_EQ(nmc_evaluate(&set, clip, t, mode, pose.data(), scratch.data()), NMC_OK);
  }
  return NMC_OK;
}

/// Small streams that hold everything between them.
std::vector<Bytes> good_streams() {
  SetShape windows{Basis::sine, {4, 5, 2}, 2};
  windows.features = 3;
  SetShape network{Basis::cosine, {9}, 1, true, true, false, 2};
  SetShape exact{Basis::cosine, {5}, 1, false, false, true, 2};
  SetShape floats{Basis::periodic, {6}, 1, true, false, false, 2};
  std::vector<Bytes> streams;
  for (const SetShape& shape : {windows, network, exact, floats})
    streams.push_back(write_clip_set(SetMaker().make(shape)));
  return streams;
}

void put_varint(Bytes& bytes, std::uint64_t value) {
  for (; value >= 128; value >>= 7) bytes.push_back(static_cast<std::uint8_t>(value | 128u));
  bytes.push_back(static_cast<std::uint8_t>(value));
}

/// A header with these counts (slots, targets, clips, samples, windows, anchors, weights, atoms, features, dense,
/// hidden0, hidden1, frequencies) and a payload.
Bytes stream_of(const std::vector<std::uint64_t>& counts, const Bytes& payload) {
  Bytes bytes{'N', 'M', 'C', NMC_VERSION, 0, 0, 0, 0};
  for (const std::uint64_t count : counts) put_varint(bytes, count);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  repair(bytes);
  return bytes;
}

TEST(Hostile, TheGoodStreamsAreGood) {
  for (const Bytes& stream : good_streams()) EXPECT_EQ(open_and_play(stream), NMC_OK);
}

TEST(Hostile, TruncationAtEveryLength) {
  for (const Bytes& stream : good_streams()) {
    for (std::size_t size = 0; size < stream.size(); ++size) {
      Bytes cut(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(size));
      const nmc_result result = open_and_play(cut);
      EXPECT_TRUE(result == NMC_ERROR_TRUNCATED || result == NMC_ERROR_CHECKSUM || result == NMC_ERROR_LIMIT) << size;
      repair(cut);
      open_and_play(cut);  // a code whose last bytes are missing may still mean something
    }
  }
}

TEST(Hostile, EveryByteChanged) {
  for (const Bytes& stream : good_streams()) {
    for (std::size_t i = 0; i < stream.size(); ++i)
      for (const int mask : {0x01, 0x80, 0xff}) {
        Bytes changed = stream;
        changed[i] = static_cast<std::uint8_t>(changed[i] ^ mask);
        EXPECT_NE(open_and_play(changed), NMC_OK) << "byte " << i;
        if (i < 8) continue;
        repair(changed);
        open_and_play(changed);
      }
  }
}

TEST(Hostile, RandomPayloads) {
  std::mt19937 random(7);
  std::size_t opened = 0;
  for (const Bytes& stream : good_streams()) {
    nmc_info info;
    ASSERT_EQ(nmc_read_info(stream.data(), stream.size(), &info), NMC_OK);
    for (int round = 0; round < 150; ++round) {
      Bytes bytes = stream;
      // From a random place on: what comes before it still leads deep into the payload.
      const std::size_t from = info.header_bytes + random() % (bytes.size() - info.header_bytes);
      for (std::size_t i = from; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(random());
      repair(bytes);
      opened += open_and_play(bytes) == NMC_OK ? 1 : 0;
    }
  }
  EXPECT_LT(opened, 600u) << "the counts of the header bind the payload";
}

TEST(Hostile, RandomHeaders) {
  std::mt19937 random(11);
  for (int round = 0; round < 2000; ++round) {
    std::vector<std::uint64_t> counts;
    for (int i = 0; i < 13; ++i) counts.push_back(random() >> (random() % 32));
    Bytes payload(random() % 64);
    for (std::uint8_t& byte : payload) byte = static_cast<std::uint8_t>(random());
    const Bytes bytes = stream_of(counts, payload);
    nmc_info info;
    if (nmc_read_info(bytes.data(), bytes.size(), &info) == NMC_OK && info.workspace_bytes < 4u << 20)
      open_and_play(bytes);
  }
}

/// Counts that would need much more memory or time than so few bytes can stand for.
TEST(Hostile, AbsurdCounts) {
  const std::vector<std::uint64_t> modest{6, 2, 1, 10, 1, 6, 0, 0, 0, 0};
  nmc_info info;
  const Bytes plain = stream_of(modest, Bytes(8));
  ASSERT_EQ(nmc_read_info(plain.data(), plain.size(), &info), NMC_OK);
  for (std::size_t field = 0; field < modest.size(); ++field)
    for (const std::uint64_t count : {0x08000000ULL, 0x7fffffffULL, 0xffffffffULL, 0x123456789ULL, 0x7ffffffffULL}) {
      std::vector<std::uint64_t> counts = modest;
      counts[field] = count;
      if (field == 9) counts.insert(counts.end(), {10, 10, 3});
      const Bytes bytes = stream_of(counts, Bytes(8));
      EXPECT_EQ(nmc_read_info(bytes.data(), bytes.size(), &info), NMC_ERROR_LIMIT) << field << ": " << count;
    }
  for (const std::vector<std::uint64_t>& counts :
       {std::vector<std::uint64_t>{65535, 65535, 65535, 100, 1, 0, 0, 0, 0, 0},
        {65535, 1, 1, 100, 1, 0, 0, 0, 65535, 0},
        {65535, 65535, 1, 60000, 60000, 0, 0, 0, 0, 0},
        {3, 1, 1, 10, 1, 3, 0, 0, 0, 100, 5000, 4, 1},
        {3, 1, 1, 10, 1, 3, 0, 0, 0, 100, 4, 5000, 1},
        {3, 1, 1, 10, 1, 3, 0, 0, 0, 100, 4, 4, 70000},
        {3, 4, 1, 10, 1, 3, 0, 0, 0, 0},
        {3, 1, 1, 10, 11, 3, 0, 0, 0, 0}}) {
    const Bytes bytes = stream_of(counts, Bytes(8));
    EXPECT_EQ(nmc_read_info(bytes.data(), bytes.size(), &info), NMC_ERROR_LIMIT);
  }
}

/// A payload of equal bytes is the cheapest way to many decisions.
TEST(Hostile, LongRunsOfOneByteEndSoon) {
  for (const int byte : {0x00, 0xff}) {
    const Bytes payload(4096, static_cast<std::uint8_t>(byte));
    for (const std::vector<std::uint64_t>& counts :
         {std::vector<std::uint64_t>{3000, 1000, 100, 3000, 1000, 3000, 3000, 3000, 10, 0},
          {3, 1, 60000, 60000, 60000, 180000, 100000, 100000, 3, 0},
          {3, 1, 1, 200000, 100000, 300000, 300000, 300000, 100, 0},
          {3, 1, 1, 10, 1, 3, 0, 0, 0, 100000, 300, 300, 5}})
      EXPECT_NE(open_and_play(stream_of(counts, payload)), NMC_OK);
  }
}

TEST(Hostile, EveryErrorHasItsCause) {
  const Bytes good = good_streams().front();
  nmc_info info;
  const auto read = [&](const Bytes& bytes) { return nmc_read_info(bytes.data(), bytes.size(), &info); };
  EXPECT_EQ(read({}), NMC_ERROR_TRUNCATED);
  EXPECT_EQ(read({'N', 'M', 'C'}), NMC_ERROR_TRUNCATED);
  EXPECT_EQ(read(Bytes(good.begin(), good.begin() + 9)), NMC_ERROR_TRUNCATED);
  EXPECT_EQ(read({'g', 'l', 'T', 'F', 2, 0, 0, 0, 0}), NMC_ERROR_MAGIC);
  Bytes bytes = good;
  bytes[3] = NMC_VERSION + 1;
  EXPECT_EQ(read(bytes), NMC_ERROR_VERSION);
  bytes = good;
  bytes.back() ^= 1;
  EXPECT_EQ(open_and_play(bytes), NMC_ERROR_CHECKSUM);
  EXPECT_EQ(open_and_play(stream_of({70000, 1, 1, 10, 1, 3, 0, 0, 0, 0}, Bytes(8))), NMC_ERROR_LIMIT);
  EXPECT_EQ(open_and_play(stream_of({5, 2, 1, 10, 1, 6, 0, 0, 0, 0}, Bytes(8))), NMC_ERROR_CORRUPT);

  ASSERT_EQ(read(good), NMC_OK);
  std::vector<std::uint64_t> workspace(info.workspace_bytes / 8 + 2);
  nmc_set set;
  const auto open_at = [&](void* memory, std::size_t size) {
    return nmc_open(&set, good.data(), good.size(), memory, size);
  };
  EXPECT_EQ(open_at(workspace.data(), info.workspace_bytes - 1), NMC_ERROR_ARGUMENT);
  EXPECT_EQ(open_at(reinterpret_cast<std::uint8_t*>(workspace.data()) + 4, info.workspace_bytes), NMC_ERROR_ARGUMENT);
  EXPECT_EQ(open_at(nullptr, info.workspace_bytes), NMC_ERROR_ARGUMENT);
  EXPECT_EQ(open_at(workspace.data(), info.workspace_bytes), NMC_OK);
  for (int code = NMC_OK; code <= NMC_ERROR_ARGUMENT; ++code)
    EXPECT_STRNE(nmc_message(static_cast<nmc_result>(code)), "unknown result");
}

/// An atom corrects what moves. On anything else it would need a channel with more than two keys. The encoder goes
/// through the same checks as the decoder, so it cannot write one either.
TEST(Hostile, AnAtomOnWhatDoesNotMove) {
  codec::ClipSet set = SetMaker().make({Basis::cosine, {9}});
  codec::LevelClip& clip = set.clips[0];
  int first = 0;
  std::vector<std::pair<int, State>> parameters;
  for (std::size_t t = 0; t < set.targets.size(); ++t)
    for (int a = codec::parameter_count(set.targets[t], clip.states[t]); a > 0; --a)
      parameters.push_back({first++, clip.states[t]});
  for (const auto& [parameter, state] : parameters) {
    clip.atoms = {{4, parameter, 1, 5}};
    if (state == State::fixed)
      EXPECT_THROW(write_clip_set(set), Error) << parameter;
    else
      EXPECT_EQ(open_and_play(write_clip_set(set)), NMC_OK) << parameter;
  }
}

/// The worst a float may be, where the format holds raw floats: the decoder's arithmetic has to bear it.
TEST(Hostile, HugeStepsAndWeights) {
  codec::ClipSet set = SetMaker().make({Basis::cosine, {9}, 1, true, true, false, 2});
  set.base_step = 3e38f;
  for (std::vector<float>* tensor : {&set.clips[0].layer.w0, &set.clips[0].layer.b0, &set.shared.w1, &set.shared.w2})
    tensor->back() = 3e38f;
  for (auto& target : set.targets) target.reference.assign(target.reference.size(), 0);
  EXPECT_EQ(open_and_play(write_clip_set(set)), NMC_OK);
}

}  // namespace
}  // namespace nmc::test
