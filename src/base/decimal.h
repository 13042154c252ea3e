// Decimal numbers out of text and into it, also where the standard library knows only whole ones (older versions of
// libc++).
#pragma once

#include <charconv>

namespace nmc {

/// std::from_chars for double: the longest beginning of [first, last) that is a number of its general format, correctly
/// rounded, in every locale.
std::from_chars_result read_decimal(const char* first, const char* last, double& value);

/// std::to_chars in its scientific format: the shortest decimal that reads back as `value`, such as "-1.5e+01". There
/// must be room for 24 characters and a zero. Returns its end.
char* write_decimal(char* first, char* last, double value);

/// The value of the shortest decimal that reads back as `value`: 0.1 of 0.1F.
double as_decimal(float value);

}  // namespace nmc
