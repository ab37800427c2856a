#include <string>

#include <doctest/doctest.h>

#include "core/error.h"
#include "reference.h"
#include "wave_solver/equations/t_matrix_system.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave::test_wave_solution {

TEST_CASE("wave solution: an empty placement has zero fields") {
  const auto solution = solve({}, two_pi, {0, 1});
  CHECK(solution.far_field(0.2, 1) == Complex(0));
  CHECK(solution.near_field({1, 2}) == Complex(0));
  CHECK(solution.fields(std::vector<View>{far_view(0), near_sensor({0, 0})}).size() == 4);
  CHECK(solution.diagnosis().residual == 0);
  CHECK(solution.diagnosis().boundary_residual == 0);
}

TEST_CASE("wave solution: one scatterer agrees with its T-matrix and the phase of its position") {
  const Vec place{0.4, -1.3};
  for (const std::string kind : {"D", "N", "TM15", "TE15abs"}) {
    Scatterer disk = reference_scatterer(kind);
    disk.radius = 0.3;
    const double light = 0.5, view = 2.1;
    const auto t = t_matrix(disk, two_pi, isolated_order(disk, two_pi, 1e-15));
    const Complex phase = std::polar(1.0, two_pi * dot(direction(light) - direction(view), place));
    const Complex expected = amplitude(t, two_pi, view - light) * phase;
    const Complex found =
        solve({{place, disk}}, two_pi, {light}, {.tolerance = 1e-15, .sensors = {}})
            .far_field(view);
    CHECK(std::abs(found - expected) < 1e-13 * std::abs(expected));
  }
}

TEST_CASE("wave solution: disks of index 1 do not scatter") {
  Placement placement = reference_placement("g10", "TM15");
  for (auto& placed : placement) placed.scatterer.index = 1;
  const auto solution = solve(placement, two_pi, {0.2});
  CHECK(solution.far_field(1) == Complex(0));
  CHECK(solution.diagnosis().boundary_residual == 0);
}

TEST_CASE("wave solution: residual and condition number of a well-posed problem") {
  const auto diagnosis = solve(reference_placement("g10", "D"), two_pi, {0, 2}).diagnosis();
  CHECK(diagnosis.residual > 0);
  CHECK(diagnosis.residual < 1e-13);
  CHECK(diagnosis.condition > 10);
  CHECK(diagnosis.condition < 1e5);
}

TEST_CASE(
    "wave solution: the reported residual is that of the equations, for few and many lights") {
  RandomStream random(3, 1, 0);
  Placement points(2000);
  for (auto& placed : points) placed.position = {14 * random.uniform(), 14 * random.uniform()};
  for (const Method method : {Method::dense, Method::fast})
    for (const int lights : {2, 24}) {
      std::vector<double> angles;
      for (int light = 0; light < lights; ++light) angles.push_back(two_pi * light / lights);
      const auto solution =
          solve(points, two_pi, angles,
                {.tolerance = 1e-3, .sensors = {}, .diagnose = true, .method = method});
      const TMatrixSystem& system = solution.system();
      std::vector<Complex> x;
      for (int light = 0; light < lights; ++light) {
        const auto beta = solution.coefficients(light);
        x.insert(x.end(), beta.begin(), beta.end());
      }
      const double residual = relative_distance(system.apply(x), system.right_hand_sides(angles));
      CAPTURE(lights);
      if (method == Method::dense)
        CHECK(solution.diagnosis().residual < 1e-12);
      else
        CHECK(solution.diagnosis().residual == doctest::Approx(residual).epsilon(0.3));
      CHECK(residual < (method == Method::dense ? 1e-12 : 1e-3));
    }
}

TEST_CASE("wave equations: the block-by-block product agrees with the matrix") {
  TMatrixSystem system(reference_placement("g2", "D"), two_pi, 1e-12);
  const std::vector<double> lights{0};
  const auto rhs = system.right_hand_sides(lights);
  const auto product = system.apply(rhs);
  const auto matrix = system.matrix();
  for (std::size_t row = 0; row < system.unknowns(); ++row) {
    Complex sum = 0;
    for (std::size_t column = 0; column < system.unknowns(); ++column)
      sum += matrix[column * system.unknowns() + row] * rhs[column];
    CHECK(std::abs(sum - product[row]) < 1e-14);
  }
  CHECK(relative_distance(product, rhs) > 0.1);
}

TEST_CASE("wave solution: points among disks are reciprocal") {
  Placement placement = reference_placement("g2", "TE15");
  placement.push_back({{0.9, 0.1}, Scatterer{}});
  const auto solution = solve(placement, two_pi, {0.3, 1.4 + two_pi / 2});
  CHECK(solution.basis_order().back() == 0);
  const Complex there = solution.far_field(1.4, 0);
  CHECK(std::abs(there - solution.far_field(0.3 + two_pi / 2, 1)) < 1e-12 * std::abs(there));
}

TEST_CASE("wave solution: inner points, bulk phase functions and overlaps are rejected") {
  const Placement two = reference_placement("g2", "D");
  const auto solution = solve(two, two_pi, {0});
  CHECK_THROWS_AS(solution.near_field(two[0].position), InputError);
  CHECK_NOTHROW(solution.near_field(two[0].position + 0.26 * direction(1)));

  const auto points = solve({{{1, 1}, Scatterer{}}}, two_pi, {0});
  CHECK_THROWS_AS(points.near_field({1, 1}), InputError);

  Scatterer henyey_greenstein;
  henyey_greenstein.kind = Scatterer::Kind::hg;
  CHECK_THROWS_AS(solve({{{0, 0}, henyey_greenstein}}, two_pi, {0}), InputError);

  Placement overlapping = two;
  overlapping[1].position = overlapping[0].position + Vec{0.1, 0};
  CHECK_THROWS_AS(solve(overlapping, two_pi, {0}), InputError);
}

TEST_CASE("wave equations: a matrix beyond the memory is rejected before it is allocated") {
  Placement crowd(3'000'000);
  for (std::size_t j = 0; j < crowd.size(); ++j) crowd[j].position.x = static_cast<double>(j);
  const TMatrixSystem system(std::move(crowd), two_pi, 1e-12);
  try {
    system.matrix();
    FAIL("not refused");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find("144000000000000 bytes") != std::string::npos);
  }
}

}  // namespace flatspeckle::wave::test_wave_solution
