#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/error.h"
#include "flatland/request.h"

using namespace flatspeckle;

namespace {
constexpr double k = 2 * std::numbers::pi, pi = std::numbers::pi;
}

TEST_CASE("matched views keep the transverse momentum and the side of the medium") {
  const std::vector<double> views = {0.1, 0.8, -0.5, pi, -3.0, 2.5, -2.6};
  const auto request = memory_effect_request(k, 0.2, views, {0, 0.04, -0.1, 0.1});
  CHECK(request.tilt_q[0] == 0);
  for (std::size_t t = 0; t < 4; ++t) {
    for (std::size_t v = 0; v < views.size(); ++v) {
      const auto [a, b] = request.entries[request.tilted_entry(t, v)];
      const auto one = request.channels[a], two = request.channels[b];
      const double i1 = request.lights[one.light], i2 = request.lights[two.light];
      const double v1 = request.views[one.view].angle, v2 = request.views[two.view].angle;
      CHECK(i1 == 0.2);
      CHECK(v1 == views[v]);
      CHECK(i2 == doctest::Approx(0.2 + request.tilts[t]));
      CHECK(k * (std::sin(i2) - std::sin(i1)) == doctest::Approx(request.tilt_q[t]));
      CHECK(std::sin(i2) - std::sin(v2) == doctest::Approx(std::sin(i1) - std::sin(v1)));
      CHECK(std::cos(v1) * std::cos(v2) > 0);
      const auto reference = request.entries[request.reference_intensity(v)];
      const auto tilted = request.entries[request.tilted_intensity(t, v)];
      CHECK(reference.a == a);
      CHECK(reference.b == a);
      CHECK(tilted.a == b);
      CHECK(tilted.b == b);
    }
  }
  // Tilt 0 adds no channel of its own.
  CHECK(request.channels.size() == 4 * views.size());
}

TEST_CASE("tilts past the horizon are refused, for the light and for the view") {
  CHECK_THROWS_AS(memory_effect_request(k, 1.5, {0}, {0.1}), InputError);
  CHECK_THROWS_AS(memory_effect_request(k, 0, {1.5}, {0.1}), InputError);
  CHECK_NOTHROW(memory_effect_request(k, 0, {1.4}, {-0.1}));
}

TEST_CASE("intensity, pairs and full list the entries in their stated order") {
  const auto intensity = intensity_request({0, 1}, {far_view(2), far_view(3), far_view(4)});
  CHECK(intensity.entries.size() == 6);
  CHECK(intensity.channels[4] == Channel{1, 1});
  CHECK(intensity.entries[4].a == 4);
  CHECK(intensity.entries[4].b == 4);
  const auto full = full_request({0, 1}, {far_view(2)});
  CHECK(full.entries.size() == 3);
  CHECK(full.entries[1].a == 1);
  CHECK(full.entries[1].b == 0);
  const auto pairs = pairs_request({{0, 1, 0.5, 1.5}, {0.5, 1.5, 0, 1}});
  CHECK(pairs.channels.size() == 2);
  CHECK(pairs.entries[1].a == pairs.entries[0].b);
}

TEST_CASE("a full covariance that cannot fit is refused") {
  CHECK_THROWS_AS(full_request(std::vector<double>(2000), std::vector<View>(1000)), InputError);
}
