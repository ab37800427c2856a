#pragma once

#include <atomic>
#include <cstddef>
#include <exception>

#include <omp.h>

namespace flatspeckle {

/// body(i) for i = 0 .. count - 1 over the threads of OpenMP, or in order on this thread within
/// a parallel region, also one of a single thread. Indices are handed out one by one. The first
/// exception is thrown again here, and what has not begun by then is left out.
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

/// The same, in order on this thread unless that is `worthwhile`.
template <typename Body>
void parallel_for(std::size_t count, bool worthwhile, const Body& body) {
  if (worthwhile) return parallel_for(count, body);
  for (std::size_t i = 0; i < count; ++i) body(i);
}

}  // namespace flatspeckle
