// What a user who mistyped a word most likely meant.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace nmc::cli {

/// The candidate with the fewest inserted, left out, changed or swapped letters; "" where none is near (more than a
/// third of the word differs).
std::string nearest(std::string_view word, std::span<const std::string> candidates);

/// " (did you mean 'NEAREST'?)", or nothing.
std::string did_you_mean(std::string_view word, std::span<const std::string> candidates);

}  // namespace nmc::cli
