#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flatspeckle::bench {

/// What an extreme case came to: a figure that must not exceed the limit, or a refusal.
struct Finding {
  double figure = 0;
  double limit = 0;
  std::string refusal = {};  ///< the message; empty where the case was solved
};

/// One row of the stability table. A case is right, its figure within the limit, or it is refused
/// with a message that holds `must_say`, where that is given.
struct ExtremeCase {
  std::string room, name, invariant, must_say;
  std::function<Finding()> run;
  bool slow = false;  ///< takes more than about a second: for the table, not for the quick tests
};

/// All rows, room by room. They do not depend on each other and may run side by side; within a
/// parallel region of OpenMP each keeps to its thread.
std::vector<ExtremeCase> extreme_cases();

/// Runs a case; a refusal is caught.
Finding examine(const ExtremeCase& extreme);
bool passes(const ExtremeCase& extreme, const Finding& finding);

}  // namespace flatspeckle::bench
