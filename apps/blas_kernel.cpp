#include "apps/blas_kernel.h"

#include <cstdlib>
#include <string_view>
#include <unistd.h>

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

}  // namespace

void use_fast_blas(char** argv) {
  constexpr const char* variable = "OPENBLAS_CORETYPE";
  if (std::getenv(variable) != nullptr) return;
  const char* const kernel = better_kernel();
  if (kernel == nullptr) return;
  ::setenv(variable, kernel, 0);
  ::execv("/proc/self/exe", argv);  // does not return, unless it fails
}

}  // namespace flatspeckle::apps
