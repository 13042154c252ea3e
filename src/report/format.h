// Numbers and names as people read them: bytes, lengths, shares, times, and text that is safe to print.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace nmc::report {

/// Whole bytes with thousands separators: 1234567 -> "1,234,567".
std::string format_bytes(std::size_t bytes);

/// A share as per cent with three significant digits: 0.00123 -> "0.123%".
std::string format_percent(double fraction);

/// A length in metres with three significant digits: below one metre in millimetres.
std::string format_length(double metres);

/// "1.23 s".
std::string format_seconds(double seconds);

/// How many times smaller `after` is than `before`: "12.3x"; "-" where there is nothing to compare.
std::string format_ratio(std::size_t before, std::size_t after);

/// Text from a file made safe for a terminal: control characters become '?'.
std::string printable(std::string_view text);

/// Columns that UTF-8 text takes in a terminal: wide (East Asian) characters count 2, combining marks 0.
std::size_t display_width(std::string_view text);

/// `text` cut to at most `width` columns; a cut is marked by an ellipsis.
std::string shorten(std::string_view text, std::size_t width);

}  // namespace nmc::report
