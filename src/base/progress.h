// How long work tells what it is doing without knowing whether anyone looks.
#pragma once

#include <functional>
#include <string_view>

namespace nmc {

/// Called with a fraction in [0, 1] and what is being done now. May be empty. Called from one thread at a time.
using Progress = std::function<void(double fraction, std::string_view what)>;

}  // namespace nmc
