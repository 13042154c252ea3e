// What the platform that a program is built for has and has not.
#pragma once

#include <string>

namespace nmc {

/// Whether std::thread can start a thread. WebAssembly has them only where it is built for them.
#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)
inline constexpr bool has_threads = false;
#else
inline constexpr bool has_threads = true;
#endif

/// The file that the running program is in.
std::string program_path();

}  // namespace nmc
