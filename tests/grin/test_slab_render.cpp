#include <doctest/doctest.h>

#include "bench/oracles/peierls_slab.h"
#include "tests/grin/slab_renders.h"

// Reflected and transmitted light of slabs against exact transport.

namespace flatspeckle::grin::tests::test_slab_render {

using namespace oracles;

/// Checks the share by a long run, shorter by day.
void check_long_share(const RenderScene& scene, RenderMethod method, double samples,
                      double expected, double largest_error) {
  const flatspeckle::tests::Effort effort = flatspeckle::tests::effort();
  check_share(scene, method, effort.samples * samples, expected, effort.errors * largest_error);
}

TEST_CASE("van de Hulst's slab: light and bidirectional tracing agree with published values") {
  for (const RenderMethod method : {RenderMethod::light, RenderMethod::bidirectional}) {
    check_long_share(van_de_hulst(Face::reflected), method, 200000, 0.09739, 1e-3);
    check_long_share(van_de_hulst(Face::transmitted), method, 200000, 0.66096, 1.5e-3);
  }
}

TEST_CASE("isotropic slabs: reflectance and transmittance agree with Peierls' equation") {
  for (const double albedo : {0.5, 0.95}) {
    const ScatteringMedium medium = isotropic(albedo);
    const SlabShares exact = isotropic_slab(2, albedo);
    for (const RenderMethod method : {RenderMethod::light, RenderMethod::bidirectional}) {
      check_long_share(slab(medium, 2, 100, Face::reflected), method, 100000, exact.reflected,
                       2e-3);
      check_long_share(slab(medium, 2, 100, Face::transmitted), method, 100000, exact.transmitted,
                       2e-3);
    }
  }
}

TEST_CASE("half-space: reflectance agrees with Chandrasekhar's H function") {
  const double albedo = 0.9;
  const ScatteringMedium medium = isotropic(albedo);
  check_long_share(slab(medium, 40, 100, Face::reflected), RenderMethod::bidirectional, 200000,
                   isotropic_half_space(albedo), 2e-3);
}

TEST_CASE("short runs in a thick slab: errors agree with a long run") {
  ScatteringMedium medium;
  medium.mu_s = 10;
  medium.mu_a = 0.01;
  medium.phase = {HgPhase{0.9}};
  const RenderScene scene = slab(medium, 10, 50, Face::reflected);
  const double area = 1e4;
  const Rendered exact = rendered(scene, RenderMethod::light, is_night ? 20000 : 8000);
  CHECK(area * exact.error() < 0.004);
  const int runs = is_night ? 20 : 8;
  int within = 0;
  double squares = 0;
  for (int seed = 1; seed <= runs; ++seed) {
    const Rendered run = rendered(scene, RenderMethod::bidirectional, 512, seed);
    const double off = (run.value() - exact.value()) / std::hypot(run.error(), exact.error());
    within += std::abs(off) < 2;
    squares += off * off / runs;
  }
  CHECK(within >= (is_night ? 16 : 5));
  CHECK(squares < (is_night ? 2 : 3));
}

TEST_CASE("nightly: van de Hulst's slab to 1e-4 by light tracing") {
  check_share_to(van_de_hulst(Face::reflected), RenderMethod::light, 0.09739, 1e-4);
  check_share_to(van_de_hulst(Face::transmitted), RenderMethod::light, 0.66096, 1e-4);
}

TEST_CASE("nightly: van de Hulst's slab to 1e-4 by bidirectional tracing") {
  check_share_to(van_de_hulst(Face::reflected), RenderMethod::bidirectional, 0.09739, 1e-4);
  check_share_to(van_de_hulst(Face::transmitted), RenderMethod::bidirectional, 0.66096, 1e-4);
}

}  // namespace flatspeckle::grin::tests::test_slab_render
