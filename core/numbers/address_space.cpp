#include "core/numbers/address_space.h"

#include <algorithm>
#include <atomic>
#include <fstream>
#include <limits>
#include <malloc.h>
#include <string>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include "core/error.h"

namespace flatspeckle {

namespace {

constexpr double unlimited = std::numeric_limits<double>::infinity();

double limit_of_address_space() {
  rlimit limit{};
  const bool known = getrlimit(RLIMIT_AS, &limit) == 0;
  return known && limit.rlim_cur != RLIM_INFINITY ? static_cast<double>(limit.rlim_cur) : unlimited;
}

// Starts this number of threads, which OpenMP then keeps for later parallel regions.
void start_threads(int threads) {
  std::atomic<int> started = 0;
#pragma omp parallel num_threads(threads)
  ++started;
}

}  // namespace

bool address_space_is_limited() {
  return limit_of_address_space() < unlimited;
}

double address_space_left() {
  const double limit = limit_of_address_space();
  if (limit == unlimited) return unlimited;
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return std::max(0.0, limit - pages * static_cast<double>(sysconf(_SC_PAGESIZE)));
}

bool address_space_holds(std::size_t bytes) {
  void* const mapped =
      mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (mapped == MAP_FAILED) return false;
  munmap(mapped, bytes);
  return true;
}

void require_address_space_of_threads(int threads) {
  constexpr std::size_t of_thread = std::size_t{10} << 20, rest = std::size_t{32} << 20;
  if (!address_space_holds(rest + static_cast<std::size_t>(threads) * of_thread))
    throw InputError("threads: ulimit -v does not leave 10 MiB of address space for each of " +
                     std::to_string(threads) + " threads plus 32 MiB; use fewer threads");
  if (!address_space_is_limited()) return;
  mallopt(M_ARENA_MAX, 1);  // for each thread that allocates, glibc would map 128 MiB
  start_threads(threads);
}

}  // namespace flatspeckle
