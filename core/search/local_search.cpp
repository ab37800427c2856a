#include "core/search/local_search.h"

#include <exception>
#include <memory>
#include <nlopt.h>

namespace flatspeckle {

namespace {

/// No exception may pass through the library, which is C.
struct Call {
  const std::function<std::optional<double>(const UnitPlace&)>& value;
  nlopt_opt optimiser = nullptr;
  std::exception_ptr failure = {};
};

double called(unsigned size, const double* at, double*, void* data) {
  Call& call = *static_cast<Call*>(data);
  try {
    if (const auto found = call.value(UnitPlace(at, at + size))) return *found;
  } catch (...) {
    call.failure = std::current_exception();
  }
  nlopt_force_stop(call.optimiser);
  return 0;
}

}  // namespace

void local_search(const UnitPlace& start, double first, double last, int most,
                  const std::function<std::optional<double>(const UnitPlace&)>& value) {
  const auto size = static_cast<unsigned>(start.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> made(
      nlopt_create(size == 1 ? NLOPT_LN_NELDERMEAD : NLOPT_LN_BOBYQA, size), nlopt_destroy);
  nlopt_opt optimiser = made.get();
  Call call{value, optimiser};
  nlopt_set_max_objective(optimiser, called, &call);
  nlopt_set_lower_bounds1(optimiser, 0);
  nlopt_set_upper_bounds1(optimiser, 1);
  nlopt_set_initial_step1(optimiser, first);
  nlopt_set_xtol_abs1(optimiser, last);
  nlopt_set_maxeval(optimiser, most);
  UnitPlace at = start;
  double found = 0;
  nlopt_optimize(optimiser, at.data(), &found);  // whatever ends it, values are known by then
  if (call.failure) std::rethrow_exception(call.failure);
}

}  // namespace flatspeckle
