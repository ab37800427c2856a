#include <doctest/doctest.h>

#include "tests/grin/slab_renders.h"

using namespace flatspeckle;
using namespace flatspeckle::grin;
using namespace flatspeckle::grin::tests;

TEST_CASE("van de Hulst's slab to 1e-4 by light tracing") {
  check_share_to(van_de_hulst(Face::reflected), RenderMethod::light, 0.09739, 1e-4);
  check_share_to(van_de_hulst(Face::transmitted), RenderMethod::light, 0.66096, 1e-4);
}

TEST_CASE("van de Hulst's slab to 1e-4 by bidirectional tracing") {
  check_share_to(van_de_hulst(Face::reflected), RenderMethod::bidirectional, 0.09739, 1e-4);
  check_share_to(van_de_hulst(Face::transmitted), RenderMethod::bidirectional, 0.66096, 1e-4);
}
