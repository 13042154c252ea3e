// What a fuzzer expects to hold, in every build.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace nmc::fuzz {

/// Ends the process, which libFuzzer reports as a crash, where `holds` is false.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

}  // namespace nmc::fuzz
