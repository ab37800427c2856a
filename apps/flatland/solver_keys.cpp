#include "apps/flatland/solver_keys.h"

#include <cstdio>
#include <vector>

#include "core/keys/chosen.h"

namespace flatspeckle::apps {

namespace {

const std::vector<std::string> solver_words = {"auto", "dense", "fast", "krylov"};

}  // namespace

void add_solver_keys(Keys& keys, SolverKeys& values) {
  keys.group("Solver");
  keys.add("tolerance", values.tolerance, "Relative accuracy of the fields").between(0, 1);
  keys.add(
          "solver", values.solver,
          "fast: direct, for thousands of unknowns or more; krylov: iterative, for weak scattering")
      .one_of(solver_words);
}

void add_period_phase_key(Keys& keys, SolverKeys& values) {
  keys.add("period_phase", values.period_phase,
           "Phase of the field from one period to the next (Bloch phase)")
      .angle();
}

wave::Method solver_method(const std::string& solver) {
  return chosen<wave::Method>(solver_words, solver);
}

wave::SolveOptions solve_options(const Keys& keys, const SolverKeys& values) {
  wave::SolveOptions options{.tolerance = keys.read(values.tolerance), .sensors = {}};
  options.method = solver_method(keys.read(values.solver));
  return options;
}

std::string error_of_reciprocity(const Invariant& reciprocity) {
  if (!(reciprocity.limit > 0)) return "reciprocity is not checked (period_phase)";
  char text[40];
  std::snprintf(text, sizeof text, "of reciprocity %.1e", reciprocity.off);
  return text;
}

}  // namespace flatspeckle::apps
