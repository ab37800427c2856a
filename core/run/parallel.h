#pragma once

#include <atomic>
#include <cstddef>
#include <exception>

#include <omp.h>

namespace flatspeckle {

/// Calls body(i) for i = 0 .. count - 1, distributed over the threads of OpenMP. Within a parallel
/// region of OpenMP, even one with a single thread, all calls are made in order by the calling
/// thread. Each thread takes the next index when it is free. The first exception thrown by body is
/// rethrown to the caller; calls that have not begun by then are skipped.
template <typename Body>
void parallel_for(std::size_t count, const Body& body) {
  std::exception_ptr failure;
  std::atomic<bool> failed = false;
#pragma omp parallel for schedule(dynamic, 1) if (count > 1 && omp_get_level() == 0)
  for (std::size_t i = 0; i < count; ++i) {
    if (failed.load(std::memory_order_relaxed)) continue;
    try {
      body(i);
    } catch (...) {
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

/// Calls body(i) for i = 0 .. count - 1, in parallel as the function above if use_threads is true,
/// otherwise in order on the calling thread.
template <typename Body>
void parallel_for(std::size_t count, bool use_threads, const Body& body) {
  if (use_threads) return parallel_for(count, body);
  for (std::size_t i = 0; i < count; ++i) body(i);
}

}  // namespace flatspeckle
