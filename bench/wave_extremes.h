#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flatspeckle::wave {

/// What an extreme case came to: a figure that must not exceed the limit, or a refusal.
struct Finding {
  double figure = 0;
  double limit = 0;
  std::string refusal;  ///< the message; empty where the case was solved
};

/// One row of the stability table of the wave solver. A case is right, its figure within the limit,
/// or it is refused with a message that holds `must_say`, where that is given.
struct ExtremeCase {
  std::string name;
  std::string invariant;
  std::string must_say;
  std::function<Finding()> run;
};

std::vector<ExtremeCase> extreme_cases();
/// Those that take a minute: for the table, not for the tests.
std::vector<ExtremeCase> large_cases();

/// Runs a case; a refusal is caught.
Finding examine(const ExtremeCase& extreme);
bool passes(const ExtremeCase& extreme, const Finding& finding);

}  // namespace flatspeckle::wave
