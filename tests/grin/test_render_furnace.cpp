#include <doctest/doctest.h>

#include "tests/grin/furnace_scenes.h"

namespace flatspeckle::grin::tests::test_render_furnace {

// The white furnace (conventions, C24), shortly; test_render_furnace_full.cpp is for errors of
// 0.1 %.

namespace {

/// Rays through many blobs and a spline cost ten times as much.
double affordable(const NamedRender& named, double samples) {
  return named.name == "blobs and spline" ? samples / 4 : samples;
}

const Vec3 furnace_camera(0.2, -0.1, -0.8);

/// Paths for errors of about 1 % by day; light tracing finds faces rarely and cameras hardly ever.
double some(RenderMethod method) {
  return is_night || method == RenderMethod::light ? 10000 : 2500;
}

}  // namespace

TEST_CASE("light stays uniform without scattering, in every field and by every estimator") {
  for (const NamedRender& named : furnaces({})) {
    CAPTURE(named.name);
    for (const RenderMethod method : unbiased_methods) {
      CHECK(check_furnace_face(named.scene, method, affordable(named, some(method))) < 0.05);
      // what is near a pinhole is seen by light tracing but seldom, and then brightly
      if (method != RenderMethod::light) {
        // rays that are reflected many times are rare, and carry less than 1e-3
        CHECK(check_furnace_camera(named.scene, method, affordable(named, is_night ? 20000 : 4000),
                                   furnace_camera, is_night ? 1e-9 : 1e-3) < 0.02);
      }
    }
  }
}

TEST_CASE("light stays uniform where it scatters, in every field and by every estimator") {
  for (const NamedRender& named : furnaces(fog(1, 0, 0.85))) {
    CAPTURE(named.name);
    for (const RenderMethod method : unbiased_methods) {
      CHECK(check_furnace_face(named.scene, method, affordable(named, some(method))) < 0.06);
      if (method != RenderMethod::light) {
        CHECK(check_furnace_camera(named.scene, method, affordable(named, is_night ? 8000 : 4000)) < 0.06);
      }
    }
  }
}

TEST_CASE("light stays uniform where bodies lie in each other, side by side, and touch") {
  for (const ScatteringMedium& medium : {ScatteringMedium(), fog(1, 0, 0.85)})
    for (const NamedRender& named : furnaces_of_bodies(medium)) {
      CAPTURE(named.name);
      for (const RenderMethod method : unbiased_methods)
        CHECK(check_furnace_face(named.scene, method, some(method)) < 0.1);
    }
}

TEST_CASE("light is uniform for a camera inside a body, too") {
  const Vec3 inner(0.15, 0.05, 0.12), outer(-0.1, 0.2, -0.1);
  for (const NamedRender& named : furnaces_of_bodies(fog(1, 0, 0.85))) {
    CAPTURE(named.name);
    for (const RenderMethod method : {RenderMethod::path, RenderMethod::bidirectional})
      for (const Vec3& at : {inner, outer})  // by day one of them for each method
        if (is_night || (at == inner) == (method == RenderMethod::path))
          CHECK(check_furnace_camera(named.scene, method, 8000, at) < 0.1);
  }
}

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

TEST_CASE("nightly: light stays uniform to 0.1 % without scattering") {
  check_furnaces({});
}

TEST_CASE("nightly: light stays uniform to 0.1 % where it scatters") {
  check_furnaces(fog(1, 0, 0.85));
}

}  // namespace flatspeckle::grin::tests::test_render_furnace
