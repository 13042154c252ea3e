// Bytes of the methods that we compare with: a writer, a reader that never leaves its bytes, and the lossless back end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace nmc::baselines {

using Bytes = std::vector<std::uint8_t>;

/// Little endian, without padding.
class ByteWriter {
 public:
  void u8(unsigned value) { bytes_.push_back(static_cast<std::uint8_t>(value)); }
  void u16(unsigned value);
  void f32(double value);
  void f64(double value);
  void count(std::uint64_t value);        ///< seven bits a byte, lowest first
  void signed_count(std::int64_t value);  ///< small magnitudes of both signs are short
  void raw(std::span<const std::uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  /// A length and the bytes, compressed by zstd where that is shorter.
  void packed(std::span<const std::uint8_t> bytes);

  const Bytes& bytes() const { return bytes_; }
  Bytes take() { return std::move(bytes_); }

 private:
  Bytes bytes_;
};

/// Reads what ByteWriter wrote. Everything throws Error (invalid_input) instead of reading beyond the end or returning
/// a number outside its range.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  unsigned u8() { return take(1)[0]; }
  unsigned u16();
  float f32();                              ///< finite
  double f64();                             ///< finite
  std::uint64_t count(std::uint64_t most);  ///< at most `most`
  std::int64_t signed_count();              ///< within 2^40 of zero
  std::span<const std::uint8_t> take(std::size_t bytes);
  Bytes packed();  ///< at most 256 MiB
  std::size_t left() const { return bytes_.size(); }
  void expect_end() const;

 private:
  std::span<const std::uint8_t> bytes_;
};

/// Throws Error (invalid_input): the encoded motion is damaged.
[[noreturn]] void refuse_damaged(const char* what);

}  // namespace nmc::baselines
