// The stability table of the wave solver: extreme cases, the invariant each was held to, and how
// far it was off. Exit status 1 if a row fails.

#include <cstdio>
#include <utility>

#include "wave_extremes.h"

int main() {
  using namespace flatspeckle::wave;
  bool all = true;
  std::printf("%-52s %-44s %10s %10s\n", "case (gaps in radii)", "invariant", "figure", "limit");
  auto cases = extreme_cases();
  for (auto& large : large_cases()) cases.push_back(std::move(large));
  for (const ExtremeCase& extreme : cases) {
    const Finding finding = examine(extreme);
    const bool good = passes(extreme, finding);
    all = all && good;
    std::printf("%-52s %-44s ", extreme.name.c_str(), extreme.invariant.c_str());
    if (finding.refusal.empty())
      std::printf("%10.1e %10.1e %s\n", finding.figure, finding.limit, good ? "passed" : "FAILED");
    else
      std::printf("%s: %s\n", good ? "refused" : "FAILED, refused", finding.refusal.c_str());
    std::fflush(stdout);
  }
  return all ? 0 : 1;
}
