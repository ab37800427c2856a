#pragma once

#include <functional>
#include <string>
#include <vector>

namespace flatspeckle::bench {

/// Result of an extreme case: a figure that must not exceed the limit, or an error message.
struct Finding {
  double figure = 0;
  double limit = 0;
  std::string refusal = {};  ///< the error message; empty where the case was solved
};

/// One row of the stability table. A case passes if its figure is within the limit or, if
/// `must_say` is given, if it is rejected with a message that contains that text.
struct ExtremeCase {
  std::string module_name, name, invariant, must_say;
  std::function<Finding()> run;
  bool slow = false;  ///< takes more than about a second; omitted from the quick tests
};

/// Returns all rows, module by module. The cases are independent and may run concurrently. Within a
/// parallel region of OpenMP, each uses only its own thread.
std::vector<ExtremeCase> extreme_cases();

/// Runs a case. If it throws, the error message is stored in the result.
Finding examine(const ExtremeCase& extreme);
bool passes(const ExtremeCase& extreme, const Finding& finding);

}  // namespace flatspeckle::bench
