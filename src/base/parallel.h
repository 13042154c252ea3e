// A loop over independent items on several threads; results must not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>

namespace nmc {

/// The number of hardware threads, at least 1.
int hardware_threads();

/// Calls body(i) once for each i in [0, count), on at most `threads` threads (0: all). Items are handed out in order.
/// The first exception (by item number) is rethrown after all threads have stopped.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

}  // namespace nmc
