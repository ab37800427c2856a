#include "apps/blas_kernel.h"

#include <cstdlib>
#include <string_view>
#include <unistd.h>

#include "core/numbers/address_space.h"
#include "core/numbers/blas.h"

namespace flatspeckle::apps {

namespace {

/// nullptr: as it is.
const char* better_kernel() {
  constexpr std::string_view oldest = "Prescott";
  if (openblas_get_corename() != oldest) return nullptr;
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    return "SkylakeX";
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
#endif
  return nullptr;
}

/// Whether it changed: not where the variable is set already, or to nullptr.
bool set(const char* variable, const char* value) {
  return value != nullptr && std::getenv(variable) == nullptr && ::setenv(variable, value, 0) == 0;
}

}  // namespace

void prepare_blas(char** argv) {
  const bool kernel = set("OPENBLAS_CORETYPE", better_kernel());
  const bool threads = set("OPENBLAS_NUM_THREADS", address_space_is_limited() ? "1" : nullptr);
  if (kernel || threads) ::execv("/proc/self/exe", argv);  // does not return, unless it fails
}

}  // namespace flatspeckle::apps
