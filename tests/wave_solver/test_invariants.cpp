// Checks invariants of every placement: energy conservation, reciprocity, and independence of the
// unit of length, the order of scatterers, and the choice of axes.

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "reference.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave::test_invariants {

namespace {

const SolveOptions quick{.sensors = {}, .diagnose = false};
const std::vector<double> lights{0.3, 2.0, -1.1};

std::vector<View> views_around(double turn = 0) {
  std::vector<View> views;
  for (int i = 0; i < 12; ++i) views.push_back(far_view(turn + two_pi * i / 12));
  return views;
}

std::vector<Placement> clusters(const std::vector<std::string>& kinds) {
  std::vector<Placement> placements;
  for (const auto& kind : kinds) {
    placements.push_back(reference_placement("g1", kind));
    placements.push_back(reference_placement("g10", kind));
  }
  return placements;
}

Placement points(double phase_shift, double albedo = 1) {
  Scatterer point;
  point.phase_shift = phase_shift;
  point.albedo = albedo;
  return read_placement(reference_path("p50/placement.csv"), point);
}

std::vector<Placement> lossless() {
  auto all = clusters({"D", "N", "TM15", "TE15"});
  all.push_back(points(std::numbers::pi / 2));
  all.push_back(points(0.3));
  return all;
}

struct Energy {
  double scattered, lost;
};

// Returns sigma_s, the integral of |A|^2, and sigma_e = -sqrt(8 pi / k) Re[e^{i pi/4} A(forward)],
// which is C9 with C6 for the cluster as a whole.
Energy energy(const Placement& placement, double angle) {
  const auto solution = solve(placement, two_pi, {angle}, quick);
  constexpr int directions = 256;  // for a field of angular orders below 2 k R = 60
  Energy energy{};
  for (int i = 0; i < directions; ++i)
    energy.scattered +=
        std::norm(solution.far_field(two_pi * i / directions)) * two_pi / directions;
  const Complex forward = solution.far_field(angle) * std::polar(1.0, std::numbers::pi / 4);
  energy.lost = -std::sqrt(8 * std::numbers::pi / two_pi) * forward.real();
  return energy;
}

std::vector<Complex> far_fields(const Placement& placement, double k = two_pi, double turn = 0) {
  std::vector<double> turned = lights;
  for (double& light : turned) light += turn;
  return solve(placement, k, turned, quick).fields(views_around(turn));
}

}  // namespace

TEST_CASE("lossless clusters: scattering cross section equals extinction") {
  for (const Placement& placement : lossless())
    for (const double light : lights) {
      const auto [scattered, lost] = energy(placement, light);
      CHECK(scattered == doctest::Approx(lost).epsilon(1e-12));
    }
}

TEST_CASE("absorbing clusters: extinction exceeds the scattering cross section") {
  auto absorbing = clusters({"TM15abs", "TE15abs"});
  absorbing.push_back(points(std::numbers::pi / 2, 0.8));
  for (const Placement& placement : absorbing)
    for (const double light : lights) {
      const auto [scattered, lost] = energy(placement, light);
      CHECK(lost > 1.05 * scattered);
      CHECK(scattered > 0);
    }
}

TEST_CASE("reciprocity: far fields are unchanged if light and view are exchanged") {
  auto all = lossless();
  for (auto& placement : clusters({"TM15abs", "TE15abs"})) all.push_back(placement);
  const double pi = std::numbers::pi;
  for (const Placement& placement : all) {
    const auto solution = solve(placement, two_pi, {0.3, 1.4 + pi}, quick);
    const Complex there = solution.far_field(1.4, 0), back = solution.far_field(0.3 + pi, 1);
    CHECK(std::abs(there - back) < 1e-12 * std::abs(there));
  }
}

TEST_CASE("far fields: independent of the unit of length") {
  const double unit = 3.7e4;
  for (Placement placement : lossless()) {
    const auto expected = far_fields(placement);
    for (auto& [position, scatterer] : placement) {
      position = unit * position;
      scatterer.radius *= unit;
    }
    auto found = far_fields(placement, two_pi / unit);
    for (Complex& a : found) a /= std::sqrt(unit);  // A is the square root of a length (C4)
    CHECK(relative_distance(found, expected) < 1e-12);
  }
}

TEST_CASE("far fields: independent of the order of scatterers") {
  for (Placement placement : lossless()) {
    const auto expected = far_fields(placement);
    std::reverse(placement.begin(), placement.end());
    std::swap(placement.front(), placement[placement.size() / 2]);
    CHECK(relative_distance(far_fields(placement), expected) < 1e-12);
  }
}

TEST_CASE("far fields: rotate with the scene") {
  const double turn = 0.83;
  for (Placement placement : lossless()) {
    const auto expected = far_fields(placement);
    for (auto& placed : placement)
      placed.position = length(placed.position) * direction(angle_of(placed.position) + turn);
    CHECK(relative_distance(far_fields(placement, two_pi, turn), expected) < 1e-12);
  }
}

TEST_CASE(
    "far fields: a translation of the scene multiplies them by the phases of light and view") {
  const Vec shift{3.1, -7.7};
  for (Placement placement : lossless()) {
    auto expected = far_fields(placement);
    const auto views = views_around();
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const Vec change =
          direction(lights[i / views.size()]) - direction(views[i % views.size()].angle);
      expected[i] *= std::polar(1.0, two_pi * dot(change, shift));
    }
    for (auto& placed : placement) placed.position = placed.position + shift;
    CHECK(relative_distance(far_fields(placement), expected) < 1e-12);
  }
}

TEST_CASE("near field: converges to the far field at large distance") {
  const auto solution = solve(reference_placement("g10", "TE15"), two_pi, {0.3}, quick);
  for (const double angle : {0.0, 1.0, 4.0}) {
    const double r = 1e7;
    const Complex expected = solution.far_field(angle) *
                             std::polar(1 / std::sqrt(r), std::remainder(two_pi * r, two_pi));
    const Complex found = solution.near_field(r * direction(angle));
    CHECK(std::abs(found - expected) < 1e-5 * std::abs(expected));
  }
}

}  // namespace flatspeckle::wave::test_invariants
