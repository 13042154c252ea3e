#include "baselines/bytes.h"

#include <zstd.h>

#include <cmath>
#include <string>

#include "base/bits.h"
#include "base/error.h"

namespace nmc::baselines {
namespace {

constexpr std::uint64_t most_unpacked = std::uint64_t{1} << 28;
constexpr std::int64_t most_signed = std::int64_t{1} << 40;
constexpr int zstd_level = 19;

template <typename Word>
void put(Bytes& bytes, Word word) {
  for (std::size_t i = 0; i < sizeof(Word); ++i) bytes.push_back(static_cast<std::uint8_t>(word >> (8 * i)));
}

template <typename Word>
Word get(std::span<const std::uint8_t> bytes) {
  Word word = 0;
  for (std::size_t i = 0; i < sizeof(Word); ++i)
    word = static_cast<Word>(word | static_cast<Word>(bytes[i]) << (8 * i));
  return word;
}

}  // namespace

void refuse_damaged(const char* what) {
  throw Error(ErrorCode::invalid_input, std::string("the encoded motion is damaged: ") + what + "; encode it again");
}

void ByteWriter::u16(unsigned value) { put(bytes_, static_cast<std::uint16_t>(value)); }
void ByteWriter::f32(double value) { put(bytes_, bit_cast<std::uint32_t>(static_cast<float>(value))); }
void ByteWriter::f64(double value) { put(bytes_, bit_cast<std::uint64_t>(value)); }

void ByteWriter::count(std::uint64_t value) {
  for (; value >= 128; value >>= 7) u8(static_cast<unsigned>(value & 127u) | 128u);
  u8(static_cast<unsigned>(value));
}

void ByteWriter::signed_count(std::int64_t value) {
  count(value < 0 ? static_cast<std::uint64_t>(-value) * 2 - 1 : static_cast<std::uint64_t>(value) * 2);
}

void ByteWriter::packed(std::span<const std::uint8_t> bytes) {
  Bytes small(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(small.data(), small.size(), bytes.data(), bytes.size(), zstd_level);
  const bool stored = ZSTD_isError(size) || size >= bytes.size();
  count(bytes.size());
  count(stored ? 0 : size);
  raw(stored ? bytes : std::span<const std::uint8_t>(small.data(), size));
}

std::span<const std::uint8_t> ByteReader::take(std::size_t bytes) {
  if (bytes > bytes_.size()) refuse_damaged("it ends too early");
  const auto taken = bytes_.first(bytes);
  bytes_ = bytes_.subspan(bytes);
  return taken;
}

unsigned ByteReader::u16() { return get<std::uint16_t>(take(2)); }

float ByteReader::f32() {
  const float value = bit_cast<float>(get<std::uint32_t>(take(4)));
  if (!std::isfinite(value)) refuse_damaged("a number is not finite");
  return value;
}

double ByteReader::f64() {
  const double value = bit_cast<double>(get<std::uint64_t>(take(8)));
  if (!std::isfinite(value)) refuse_damaged("a number is not finite");
  return value;
}

std::uint64_t ByteReader::count(std::uint64_t most) {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 63; shift += 7) {
    const unsigned byte = u8();
    value |= static_cast<std::uint64_t>(byte & 127u) << shift;
    if (byte < 128) {
      if (value > most) refuse_damaged("a count is out of range");
      return value;
    }
  }
  refuse_damaged("a count is out of range");
}

std::int64_t ByteReader::signed_count() {
  const std::uint64_t value = count(2 * static_cast<std::uint64_t>(most_signed));
  const auto half = static_cast<std::int64_t>(value / 2);
  return value % 2 ? -half - 1 : half;
}

Bytes ByteReader::packed() {
  const std::uint64_t size = count(most_unpacked);
  const std::uint64_t stored = count(most_unpacked);
  const auto bytes = take(static_cast<std::size_t>(stored == 0 ? size : stored));
  if (stored == 0) return {bytes.begin(), bytes.end()};
  if (ZSTD_getFrameContentSize(bytes.data(), bytes.size()) != size) refuse_damaged("a packed part has a wrong length");
  Bytes unpacked(static_cast<std::size_t>(size));
  if (ZSTD_decompress(unpacked.data(), unpacked.size(), bytes.data(), bytes.size()) != size)
    refuse_damaged("a packed part cannot be unpacked");
  return unpacked;
}

void ByteReader::expect_end() const {
  if (!bytes_.empty()) refuse_damaged("bytes are left over");
}

}  // namespace nmc::baselines
