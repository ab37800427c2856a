#include <cmath>

#include <doctest/doctest.h>

#include "core/error.h"
#include "reference.h"
#include "wave_solver/basis_order.h"
#include "wave_solver/wave_solution.h"

namespace flatspeckle::wave {

namespace {

std::vector<View> views_around() {
  std::vector<View> views;
  for (int i = 0; i < 24; ++i) views.push_back(far_view(two_pi * i / 24));
  return views;
}

WaveSolution solved(const Placement& placement, double tolerance, bool diagnose = false) {
  return solve(placement, two_pi, {0, 1, 2.5},
               {.tolerance = tolerance, .sensors = {}, .diagnose = diagnose});
}

// Two equal disks of size parameter ka; gap in radii.
Placement pair(const std::string& kind, double ka, double gap) {
  Scatterer disk = reference_scatterer(kind);
  disk.radius = ka / two_pi;
  const double distance = (2 + gap) * disk.radius;
  return {{{0, 0}, disk}, {{0.6 * distance, 0.8 * distance}, disk}};
}

void check_convergence(const Placement& placement) {
  const auto exact = solved(placement, 1e-15).fields(views_around());
  for (const double tolerance : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const auto fields = solved(placement, tolerance).fields(views_around());
    CAPTURE(tolerance);
    CHECK(relative_distance(fields, exact) < tolerance);
  }
}

double energy_defect(const WaveSolution& solution) {
  double scattered = 0;
  for (int i = 0; i < 256; ++i)
    scattered += std::norm(solution.far_field(two_pi * i / 256)) * two_pi / 256;
  const Complex forward = solution.far_field(0) * std::polar(1.0, std::numbers::pi / 4);
  return std::abs(scattered / (-2 * forward.real()) - 1);
}

}  // namespace

TEST_CASE("Images accumulate at the focus of bipolar coordinates") {
  const double a = 0.4, b = 0.25, d = 0.7;
  // The image in b of a point at distance s from the centre of a, and back into a, is at a^2/s.
  double s = 1e3;
  for (int i = 0; i < 200; ++i) s = d - b * b / (d - a * a / s);
  CHECK(nearest_image(a, b, d) == doctest::Approx(s).epsilon(1e-13));
  CHECK(nearest_image(a, 0, d) == doctest::Approx(d).epsilon(1e-14));
}

TEST_CASE("Far fields are within the tolerance") {
  for (const std::string kind : {"D", "N", "TM15", "TE15", "TM15abs"}) {
    CAPTURE(kind);
    for (const std::string folder : {"g2", "g10"})
      check_convergence(reference_placement(folder, kind));
    for (const double ka : {0.01, 1.0, 10.0})
      for (const double gap : {0.3, 0.01}) {
        CAPTURE(ka);
        CAPTURE(gap);
        check_convergence(pair(kind, ka, gap));
      }
  }
}

TEST_CASE("Near fields at stated sensors are within the tolerance, in the gap and on a rim too") {
  for (const std::string kind : {"D", "N", "TM15", "TE15"}) {
    const Placement two = pair(kind, 1, 0.1);
    const Vec2 middle = 0.5 * two[1].position;
    const double radius = two[0].scatterer.radius;
    const std::vector<Vec2> sensors{middle, (1 + 1e-9) * radius * direction(2), {1, 1}};
    const auto near_fields = [&](double tolerance) {
      const auto solution = solve(two, two_pi, {0.2},
                                  {.tolerance = tolerance, .sensors = sensors, .diagnose = false});
      std::vector<Complex> fields;
      for (const Vec2& sensor : sensors) fields.push_back(solution.near_field(sensor));
      return fields;
    };
    const auto exact = near_fields(1e-14);
    for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
      CAPTURE(kind);
      CAPTURE(tolerance);
      CHECK(relative_distance(near_fields(tolerance), exact) < tolerance);
    }
  }
}

TEST_CASE("The boundary residual sees a basis order that is too low; energy does not") {
  for (const std::string kind : {"D", "N", "TM15", "TE15"}) {
    CAPTURE(kind);
    const Placement cluster = reference_placement("g10", kind);
    const auto exact = solved(cluster, 1e-15, true), rough = solved(cluster, 1e-1, true);
    CHECK(exact.diagnosis().boundary_residual < 2e-6);
    CHECK(rough.diagnosis().boundary_residual > 1e-2);
    for (const auto* solution : {&exact, &rough}) {
      CHECK(energy_defect(*solution) < 1e-12);
      CHECK(solution->diagnosis().residual < 1e-14);
    }
  }
}

TEST_CASE("The boundary residual falls to rounding with the order") {
  for (const std::string kind : {"D", "N", "TM15", "TE15", "TM15abs", "TE15abs"}) {
    const Placement cluster = reference_placement("g2", kind);
    SolveOptions options{.tolerance = 1e-15, .sensors = {}, .diagnose = true};
    for (const auto& [position, disk] : cluster)
      options.sensors.push_back(position + disk.radius * direction(1));
    const auto solution = solve(cluster, two_pi, {0, 1}, options);
    CAPTURE(kind);
    CHECK(solution.diagnosis().boundary_residual < 1e-12);
  }
}

TEST_CASE("Narrow gaps: right at 1e-3 radii, refused where the numbers end") {
  for (const std::string kind : {"D", "N", "TM15", "TE15"}) {
    const auto solution = solved(pair(kind, 1, 1e-3), 1e-6, true);
    CHECK(energy_defect(solution) < 1e-11);
    CHECK(solution.diagnosis().residual < 1e-13);
  }
  CHECK_THROWS_AS(solved(pair("N", 0.01, 1e-6), 1e-12), InputError);
}

TEST_CASE("From 1e-4 to 100: sizes, indices and metals") {
  for (const std::string kind : {"D", "N", "TM15", "TE15"})
    for (const double ka : {1e-4, 1.0, 100.0})
      for (const Complex index : {Complex(1 + 1e-8), Complex(10), Complex(0.1, 5)}) {
        Placement two = pair(kind, ka, 0.5);
        for (auto& placed : two) placed.scatterer.index = index;
        CAPTURE(kind);
        CAPTURE(ka);
        CAPTURE(index);
        const auto solution =
            solve(two, two_pi, {0.3, 1.4 + two_pi / 2}, {.sensors = {}, .diagnose = false});
        const Complex there = solution.far_field(1.4, 0);
        const Complex back = solution.far_field(0.3 + two_pi / 2, 1);
        CHECK(std::abs(there) > 0);
        CHECK(std::abs(there - back) < 1e-11 * std::abs(there));
      }
}

}  // namespace flatspeckle::wave
