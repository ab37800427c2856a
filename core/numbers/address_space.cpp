#include "core/numbers/address_space.h"

#include <string>
#include <sys/mman.h>

#include "core/error.h"

namespace flatspeckle {

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
                     std::to_string(threads) + " threads and 32 MiB; fewer need less");
}

}  // namespace flatspeckle
