#include <doctest/doctest.h>

#include "tests/grin/furnace_scenes.h"

namespace flatspeckle::grin::tests::test_render_furnace {

// The white furnace (conventions, C24) in short runs; nightly tests below have errors of 0.1 %.

namespace {

/// Returns fewer samples for blobs and a spline, whose rays are ten times as expensive.
double affordable(const NamedRender& named, double samples) {
  return named.name == "blobs and spline" ? samples / 4 : samples;
}

const Vec3 furnace_camera(0.2, -0.1, -0.8);

/// Returns the paths for errors of about 1 % by day; light tracing hits faces rarely and cameras
/// hardly ever.
double sample_count(RenderMethod method) {
  return is_night || method == RenderMethod::light ? 10000 : 2500;
}

}  // namespace

TEST_CASE(
    "white furnace without scattering: uniform radiance, in every field and by every estimator") {
  for (const NamedRender& named : furnaces({})) {
    CAPTURE(named.name);
    for (const RenderMethod method : unbiased_methods) {
      CHECK(check_furnace_face(named.scene, method, affordable(named, sample_count(method))) <
            0.05);
      // light tracing rarely samples collisions near a pinhole, and then with high weights
      if (method != RenderMethod::light) {
        // rays that are reflected many times are rare, and carry less than 1e-3
        CHECK(check_furnace_camera(named.scene, method, affordable(named, is_night ? 20000 : 4000),
                                   furnace_camera, is_night ? 1e-9 : 1e-3) < 0.02);
      }
    }
  }
}

TEST_CASE(
    "white furnace with scattering: uniform radiance, in every field and by every estimator") {
  for (const NamedRender& named : furnaces(fog(1, 0, 0.85))) {
    CAPTURE(named.name);
    for (const RenderMethod method : unbiased_methods) {
      CHECK(check_furnace_face(named.scene, method, affordable(named, sample_count(method))) <
            0.06);
      if (method != RenderMethod::light) {
        CHECK(check_furnace_camera(named.scene, method, affordable(named, is_night ? 8000 : 4000)) <
              0.06);
      }
    }
  }
}

TEST_CASE("white furnace with nested, adjacent and touching bodies: uniform radiance") {
  for (const ScatteringMedium& medium : {ScatteringMedium(), fog(1, 0, 0.85)})
    for (const NamedRender& named : furnaces_of_bodies(medium)) {
      CAPTURE(named.name);
      for (const RenderMethod method : unbiased_methods)
        CHECK(check_furnace_face(named.scene, method, sample_count(method)) < 0.1);
    }
}

TEST_CASE("white furnace with a camera in a body: uniform radiance") {
  const Vec3 inner(0.15, 0.05, 0.12), outer(-0.1, 0.2, -0.1);
  for (const NamedRender& named : furnaces_of_bodies(fog(1, 0, 0.85))) {
    CAPTURE(named.name);
    for (const RenderMethod method : {RenderMethod::path, RenderMethod::bidirectional})
      for (const Vec3& at : {inner, outer})  // by day one of them for each method
        if (is_night || (at == inner) == (method == RenderMethod::path))
          CHECK(check_furnace_camera(named.scene, method, 8000, at) < 0.1);
  }
}

// The white furnace to an error of 0.1 %: about an hour of CPU time.

namespace {

constexpr double wanted = 1e-3;

/// Repeats a check until its error is the wanted one; each run determines the samples of the next.
template <class Check>
void check_to_error(const Check& check, double samples) {
  constexpr double margin = 1.2;
  for (int run = 0; run < 4; ++run) {
    const double missing = check(samples) / wanted;
    if (missing <= 1) return;
    samples *= margin * missing * missing;
  }
  FAIL_CHECK("the error does not fall with the number of samples");
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

TEST_CASE("nightly: white furnace without scattering: uniform radiance to 0.1 %") {
  check_furnaces({});
}

TEST_CASE("nightly: white furnace with scattering: uniform radiance to 0.1 %") {
  check_furnaces(fog(1, 0, 0.85));
}

}  // namespace flatspeckle::grin::tests::test_render_furnace
