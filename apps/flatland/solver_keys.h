#pragma once

#include <string>

#include "core/keys/keys.h"
#include "core/result/invariant.h"
#include "wave_solver/solutions/equation_solver.h"

namespace flatspeckle::apps {

/// Values of the keys of the exact solver.
struct SolverKeys {
  double tolerance = wave::SolveOptions().tolerance;
  std::string solver = "auto";
  double period_phase = 0;
};

void add_solver_keys(Keys& keys, SolverKeys& values);
void add_period_phase_key(Keys& keys, SolverKeys& values);

/// Returns the method that a value of the key `solver` names.
wave::Method solver_method(const std::string& solver);
/// Reads the keys of add_solver_keys().
wave::SolveOptions solve_options(const Keys& keys, const SolverKeys& values);

/// Returns the printed error of reciprocity of a periodic cell, or that it was not checked.
std::string error_of_reciprocity(const Invariant& reciprocity);

}  // namespace flatspeckle::apps
