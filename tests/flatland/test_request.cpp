#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/error.h"
#include "flatland/request/request.h"

namespace flatspeckle::test_request {

namespace {
constexpr double k = 2 * std::numbers::pi, pi = std::numbers::pi;
}

TEST_CASE("memory effect: matched views keep the transverse momentum and the side of the medium") {
  const std::vector<double> views = {0.1, 0.8, -0.5, pi, -3.0, 2.5, -2.6};
  const auto request = memory_effect_request(k, 0.2, views, {0, 0.04, -0.1, 0.1});
  CHECK(request.tilt_q[0] == 0);
  for (std::size_t t = 0; t < 4; ++t) {
    for (std::size_t v = 0; v < views.size(); ++v) {
      const auto [a, b] = request.entries[request.tilted_entry(t, v)];
      const auto one = request.channels[a], two = request.channels[b];
      const double i1 = request.lights[one.light].angle, i2 = request.lights[two.light].angle;
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
  // Tilt 0 adds no channels.
  CHECK(request.channels.size() == 4 * views.size());
}

TEST_CASE("memory effect: tilts beyond the horizon are rejected for light and view") {
  CHECK_THROWS_AS(memory_effect_request(k, 1.5, {0}, {0.1}), InputError);
  CHECK_THROWS_AS(memory_effect_request(k, 0, {1.5}, {0.1}), InputError);
  CHECK_NOTHROW(memory_effect_request(k, 0, {1.4}, {-0.1}));
}

TEST_CASE("requests: intensity, pairs and full have entries in the documented order") {
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

TEST_CASE("full covariance: rejected if it exceeds the memory") {
  CHECK_THROWS_AS(full_request(std::vector<double>(2000), std::vector<View>(1000)), InputError);
}

TEST_CASE("tilt-shift: all pairs of tilt and shift, then matched views; each channel once") {
  const std::vector<View> views = {far_view(0.3), far_view(2.5)};
  const auto request = tilt_shift_request(k, plane_wave(0.2), views, {0, 0.05}, {0, -0.4, 0.7});
  CHECK(request.moves == 2 * 3 + 2);
  CHECK(request.entries.size() == 8 * 2 + 2 + 8 * 2);
  for (std::size_t t = 0; t < 2; ++t) {
    for (std::size_t s = 0; s < 3; ++s) {
      for (std::size_t v = 0; v < 2; ++v) {
        const auto [a, b] = request.entries[request.tilted_entry(3 * t + s, v)];
        const auto one = request.channels[a], two = request.channels[b];
        CHECK(one == Channel{0, static_cast<std::uint32_t>(v)});
        CHECK(request.lights[two.light].angle == doctest::Approx(0.2 + request.tilts[t]));
        const double from = views[v].angle, to = request.views[two.view].angle;
        CHECK(k * (std::sin(to) - std::sin(from)) == doctest::Approx(request.shifts[s]));
        CHECK(std::cos(to) * std::cos(from) > 0);
        CHECK(request.entries[request.tilted_intensity(3 * t + s, v)].a == b);
      }
    }
    const auto matched = request.channels[request.entries[request.tilted_entry(6 + t, 0)].b];
    CHECK(k * (std::sin(request.views[matched.view].angle) - std::sin(0.3)) ==
          doctest::Approx(request.tilt_q[t]));
  }
  for (std::size_t a = 0; a < request.channels.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) CHECK(request.channels[a] != request.channels[b]);
  CHECK(request.channels.size() == 2 * (6 + 1));
  CHECK_THROWS_AS(tilt_shift_request(k, plane_wave(0), views, {0}, {0, 5}), InputError);
}

TEST_CASE("translation: moves the light and near sensors, not far views") {
  const std::vector<View> views = {near_sensor({1, 5}), far_view(0.3)};
  const auto request = translation_request(gaussian_beam(0.1, {2, 3}, 4), views, {0, 1.5});
  CHECK(request.moves == 2);
  const auto near = request.channels[request.entries[request.tilted_entry(1, 0)].b],
             far = request.channels[request.entries[request.tilted_entry(1, 1)].b];
  CHECK(request.lights[near.light] == gaussian_beam(0.1, {3.5, 3}, 4));
  CHECK(request.views[near.view] == near_sensor({2.5, 5}));
  CHECK(request.lights[far.light] == request.lights[near.light]);
  CHECK(request.views[far.view] == far_view(0.3));
}

}  // namespace flatspeckle::test_request
