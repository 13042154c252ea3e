#include "report/format.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace nmc::report {
namespace {

struct CodePoint {
  std::uint32_t value = 0;
  std::size_t bytes = 1;
};

/// The code point at the start of `text` (not empty); a broken sequence reads as one byte.
CodePoint first_code_point(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])); };
  const std::uint32_t lead = byte(0);
  const std::size_t bytes = lead < 0x80 ? 1 : lead >> 5 == 0x6 ? 2 : lead >> 4 == 0xe ? 3 : lead >> 3 == 0x1e ? 4 : 1;
  if (bytes == 1 || bytes > text.size()) return {lead, 1};
  std::uint32_t value = lead & (0xffU >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if (byte(i) >> 6 != 0x2) return {lead, 1};
    value = (value << 6) | (byte(i) & 0x3f);
  }
  return {value, bytes};
}

struct Range {
  std::uint32_t first, last;
};

bool in_any(std::uint32_t value, const auto& ranges) {
  return std::any_of(ranges.begin(), ranges.end(), [&](const Range& r) { return value >= r.first && value <= r.last; });
}

/// Columns of one code point (the common blocks of Unicode's East_Asian_Width and of combining marks).
std::size_t columns(std::uint32_t value) {
  static constexpr std::array<Range, 6> combining{
      {{0x300, 0x36f}, {0x483, 0x489}, {0x591, 0x5bd}, {0x200b, 0x200f}, {0x20d0, 0x20ff}, {0xfe00, 0xfe0f}}};
  static constexpr std::array<Range, 9> wide{{{0x1100, 0x115f},
                                              {0x2e80, 0x303e},
                                              {0x3041, 0xa4cf},
                                              {0xac00, 0xd7a3},
                                              {0xf900, 0xfaff},
                                              {0xfe30, 0xfe6f},
                                              {0xff00, 0xff60},
                                              {0x1f300, 0x1faff},
                                              {0x20000, 0x3fffd}}};
  if (in_any(value, combining)) return 0;
  return in_any(value, wide) ? 2 : 1;
}

}  // namespace

std::string format_bytes(std::size_t bytes) {
  const std::string digits = std::to_string(bytes);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string format_percent(double fraction) { return fmt::format("{:.3g}%", 100 * fraction); }

std::string format_length(double metres) {
  return std::abs(metres) < 1 ? fmt::format("{:.3g} mm", 1000 * metres) : fmt::format("{:.4g} m", metres);
}

std::string format_seconds(double seconds) { return fmt::format("{:.2f} s", seconds); }

std::string format_ratio(std::size_t before, std::size_t after) {
  if (before == 0 || after == 0) return "-";
  return fmt::format("{:.1f}x", static_cast<double>(before) / static_cast<double>(after));
}

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const CodePoint c = first_code_point(text);
    const bool control = c.value < 0x20 || (c.value >= 0x7f && c.value < 0xa0);
    const bool broken = c.bytes == 1 && c.value >= 0x80;
    if (control || broken) {
      out += '?';
    } else {
      out += text.substr(0, c.bytes);
    }
    text.remove_prefix(c.bytes);
  }
  return out;
}

std::size_t display_width(std::string_view text) {
  std::size_t width = 0;
  while (!text.empty()) {
    const CodePoint c = first_code_point(text);
    width += columns(c.value);
    text.remove_prefix(c.bytes);
  }
  return width;
}

std::string shorten(std::string_view text, std::size_t width) {
  if (display_width(text) <= width) return std::string(text);
  std::size_t used = 0;
  std::size_t bytes = 0;
  while (bytes < text.size()) {
    const CodePoint c = first_code_point(text.substr(bytes));
    if (used + columns(c.value) + 1 > width) break;
    used += columns(c.value);
    bytes += c.bytes;
  }
  return std::string(text.substr(0, bytes)) + "\u2026";
}

}  // namespace nmc::report
