#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/random.h"
#include "reference.h"
#include "tests/statistics.h"
#include "wave_solver/equations/neighbours.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave::test_basis_order {

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

// Returns two equal disks of size parameter ka; gap in radii.
Placement pair(const std::string& kind, double ka, double gap) {
  Scatterer disk = reference_scatterer(kind);
  disk.radius = ka / two_pi;
  const double distance = (2 + gap) * disk.radius;
  return {{{0, 0}, disk}, {{0.6 * distance, 0.8 * distance}, disk}};
}

// Returns six equal disks around one.
Placement cluster(const std::string& kind, double ka, double gap) {
  Placement seven = pair(kind, ka, gap);
  const Scatterer disk = seven[0].scatterer;
  seven.pop_back();
  for (int i = 0; i < 6; ++i)
    seven.push_back({(2 + gap) * disk.radius * direction(0.2 + two_pi * i / 6), disk});
  return seven;
}

// Returns a disk and one of a fifth of its size; gap in radii of the latter.
Placement unequal(const std::string& kind, double ka, double gap) {
  Placement two = pair(kind, ka, 0);
  two[1].scatterer.radius /= 5;
  two[1].position = {two[0].scatterer.radius + (1 + gap) * two[1].scatterer.radius, 0};
  return two;
}

void check_convergence(const Placement& placement) {
  const auto exact = solved(placement, 1e-14).fields(views_around());
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

TEST_CASE("nearest image: iterated images accumulate at the focus of bipolar coordinates") {
  const double a = 0.4, b = 0.25, d = 0.7;
  // A point at distance s from the centre of a is reflected in a, at a^2/s, and then in b.
  double s = 1e3;
  for (int i = 0; i < 200; ++i) s = d - b * b / (d - a * a / s);
  CHECK(nearest_image(a, b, d) == doctest::Approx(s).epsilon(1e-13));
  CHECK(nearest_image(a, 0, d) == doctest::Approx(d).epsilon(1e-14));
}

TEST_CASE("basis orders: far fields of reference placements converge within the tolerance") {
  for (const std::string kind : {"D", "N", "TM15", "TE15", "TM15abs"})
    for (const std::string folder : {"g2", "g10"}) {
      CAPTURE(kind);
      CAPTURE(folder);
      check_convergence(reference_placement(folder, kind));
    }
}

TEST_CASE(
    "basis orders: far fields of pairs with gaps of 1e-3 to 0.5 radii converge within the "
    "tolerance") {
  int number = 0;  // outside nightly runs every third
  for (const std::string kind : {"D", "N", "TM15", "TE15", "TE15abs"})
    for (const double ka : {0.01, 1.0, 10.0, 30.0})
      for (const double gap : {0.5, 0.1, 0.01, 1e-3}) {
        if (!flatspeckle::tests::is_night && ++number % 3 != 0) continue;
        if (kind == "N" && gap < 0.01 && ka != 1) continue;  // a thousand unknowns each
        CAPTURE(kind);
        CAPTURE(ka);
        CAPTURE(gap);
        check_convergence(pair(kind, ka, gap));
      }
}

TEST_CASE("basis orders: far fields of clusters and unequal disks converge within the tolerance") {
  int number = 0;  // outside nightly runs every fifth
  for (const std::string kind : {"D", "N", "TM15", "TE15"})
    for (const double ka : {0.01, 0.3, 3.0})
      for (const double gap : {0.5, 0.05}) {
        if (!flatspeckle::tests::is_night && ++number % 5 != 1) continue;
        CAPTURE(kind);
        CAPTURE(ka);
        CAPTURE(gap);
        check_convergence(cluster(kind, ka, gap));
        check_convergence(unequal(kind, ka, gap));
      }
}

TEST_CASE("basis orders: only nearly touching hard disks require high orders") {
  // Hard disks require ln(1/eps) / (2 xi) orders, 430 here.
  const auto order = [](const std::string& kind) {
    return solved(pair(kind, 1, 1e-3), 1e-12).basis_order()[0];
  };
  CHECK(order("TM15") < 30);
  CHECK(order("D") < 70);
  CHECK(order("TE15") < 100);
  CHECK(order("N") > 430);
  CHECK(order("N") < 560);
}

TEST_CASE(
    "basis orders: near fields at sensors in a gap, on a rim and outside are within the "
    "tolerance") {
  for (const std::string kind : {"D", "N", "TM15", "TE15"}) {
    const Placement two = pair(kind, 1, 0.1);
    const Vec middle = 0.5 * two[1].position;
    const double radius = two[0].scatterer.radius;
    const std::vector<Vec> sensors{middle, (1 + 1e-9) * radius * direction(2), {1, 1}};
    const auto near_fields = [&](double tolerance) {
      const auto solution = solve(two, two_pi, {0.2},
                                  {.tolerance = tolerance, .sensors = sensors, .diagnose = false});
      std::vector<Complex> fields;
      for (const Vec& sensor : sensors) fields.push_back(solution.near_field(sensor));
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

TEST_CASE(
    "boundary residual: a basis order that is too low is detected, unlike by energy conservation") {
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

TEST_CASE("boundary residual: decreases to rounding at high orders") {
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

TEST_CASE("basis orders: an order above the limit is rejected with a message that contains it") {
  try {
    solved(pair("N", 0.01, 1e-6), 1e-12);
    FAIL("not refused");
  } catch (const InputError& error) {
    // ln(1e12) / (2 xi) with xi = 1e-3 is 13816; the gap is rounded down by up to a twelfth.
    const std::string message = error.what();
    const std::size_t at = message.find("basis order ");
    REQUIRE(at != std::string::npos);
    CHECK(std::stod(message.substr(at + 12)) == doctest::Approx(14200).epsilon(0.04));
  }
}

TEST_CASE("neighbours: the closest image agrees with an exhaustive search") {
  // Sparse, so that some have no neighbour within a cell and wider cells are searched.
  Scatterer disk = reference_scatterer("D");
  RandomStream random(5, 0, 0);
  Placement many;
  for (int i = 0; i < 2000; ++i) {
    disk.radius = 0.001 + 0.1 * random.uniform();
    const double x = random.uniform(), z = random.uniform();
    many.push_back({{100 * x, 100 * z}, disk});
  }
  const auto found = neighbours(many);
  for (std::size_t j = 0; j < many.size(); ++j) {
    double best = std::numeric_limits<double>::infinity();
    for (std::size_t l = 0; l < many.size(); ++l) {
      if (l == j) continue;
      best = std::min(best, nearest_image(many[j].scatterer.radius, many[l].scatterer.radius,
                                          length(many[l].position - many[j].position)));
    }
    REQUIRE(!found[j].empty());
    const auto& [l, distance, image] = found[j][0];
    CHECK(image == best);
    CHECK(distance == length(many[l].position - many[j].position));
  }
}

TEST_CASE(
    "basis orders: reciprocity for size parameters from 1e-4 to 100, high indices and metals") {
  const std::vector<Complex> of_any{1}, indices{1 + 1e-8, 4, {0.1, 5}};
  for (const std::string kind : {"D", "N", "TM15", "TE15"})
    for (const double ka : {1e-4, 1.0, 100.0})
      for (const Complex index : kind.size() == 1 ? of_any : indices) {
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

}  // namespace flatspeckle::wave::test_basis_order
