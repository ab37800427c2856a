#include <doctest/doctest.h>

#include "tests/grin/render_agreement.h"

namespace flatspeckle::grin::tests {

// Path tracing joins to where a beam scatters by 1/r^2 alone: rare paths carry much, so that it
// needs many.
TEST_CASE("path tracing and bidirectional agree under a beam") {
  for (const NamedRender& named : beam_scenes()) {
    CAPTURE(named.name);
    check_agreement(named.scene, bidirectional_mean(named.scene), RenderMethod::path,
                    20 * agreement_samples);
  }
}

}  // namespace flatspeckle::grin::tests
