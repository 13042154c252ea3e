// Decimal numbers out of text, also where the standard library reads only whole ones (libc++ before 20).
#pragma once

#include <charconv>

namespace nmc {

/// std::from_chars for double: the longest beginning of [first, last) that is a number of its general format, correctly
/// rounded, in every locale.
std::from_chars_result read_decimal(const char* first, const char* last, double& value);

}  // namespace nmc
