#include <doctest/doctest.h>

#include "tests/grin/render_agreement.h"

namespace flatspeckle::grin::tests {

// Path tracing joins to where a beam scatters by 1/r^2 alone: rare paths carry much, so that it
// needs many.
TEST_CASE("path tracing and bidirectional agree under a beam") {
  for (const auto& [name, scene] : beam_scenes()) {
    CAPTURE(name);
    check_agreement(scene, bidirectional_mean(scene), RenderMethod::path, 20 * agreement_samples);
  }
}

}  // namespace flatspeckle::grin::tests
