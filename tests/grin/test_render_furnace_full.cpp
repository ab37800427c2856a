#include <doctest/doctest.h>

#include "tests/grin/furnace.h"

namespace flatspeckle::grin::tests {

// The white furnace to an error of 0.1 %: about an hour of a processor.

namespace {

constexpr double wanted = 1e-3;

/// To an error of what is wanted; each run tells how many samples the next takes.
template <class Check>
void check_to_error(const Check& check, double samples) {
  constexpr double margin = 1.2;
  for (int run = 0; run < 4; ++run) {
    const double missing = check(samples) / wanted;
    if (missing <= 1) return;
    samples *= margin * missing * missing;
  }
  FAIL_CHECK("the error does not fall as the samples say");
}

void check_furnaces(const ScatteringMedium& medium) {
  for (const auto& furnace : furnaces(medium)) {
    CAPTURE(furnace.name);
    for (const RenderMethod method : unbiased_methods) {
      check_to_error(
          [&](double samples) { return check_furnace_face(furnace.scene, method, samples); }, 2e4);
      if (method != RenderMethod::light)
        check_to_error(
            [&](double samples) { return check_furnace_camera(furnace.scene, method, samples); },
            2e4);
    }
  }
}

}  // namespace

TEST_CASE("light stays uniform to 0.1 % without scattering") {
  check_furnaces({});
}

TEST_CASE("light stays uniform to 0.1 % where it scatters") {
  check_furnaces(fog(1, 0, 0.85));
}

}  // namespace flatspeckle::grin::tests
