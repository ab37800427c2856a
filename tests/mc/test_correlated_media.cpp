// Monte Carlo in media with a structure factor (conventions, C16).
#include <cmath>
#include <complex>

#include <doctest/doctest.h>
#define lapack_complex_double std::complex<double>
#define lapack_complex_float std::complex<float>
#include <lapacke.h>

#include "flatland/media/structure_factor.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_correlated_media {

namespace {

using tests::pi;

constexpr double k = 2 * pi;

/// 241 disks of k radius = 1 at packing fraction 0.2.
SceneSpec disks(const std::string& index, std::vector<double> views) {
  SceneSpec spec;
  spec.width = 12;
  spec.depth = 8;
  spec.scatterer = "tm";
  spec.radius = 1 / k;
  spec.index = index;
  spec.count = 241;
  spec.structure = "hard_disks";
  spec.view_angles = std::move(views);
  return spec;
}

std::vector<double> circle(int number) {
  std::vector<double> angles;
  for (int j = 0; j < number; ++j) angles.push_back(2 * pi * j / number);
  return angles;
}

/// Returns the eigenvalues of a Hermitian matrix stored row by row.
std::vector<double> eigenvalues(std::vector<Complex> matrix) {
  const auto n = static_cast<lapack_int>(std::lround(std::sqrt(matrix.size())));
  std::vector<double> values(n);
  REQUIRE(LAPACKE_zheev(LAPACK_ROW_MAJOR, 'N', 'L', n, matrix.data(), n, values.data()) == 0);
  return values;
}

}  // namespace

TEST_CASE("correlated disks of low contrast: intensity is N times that of one disk times S(q)") {
  const Scene scene = make_scene(disks("1.0001", {0.1, 0.7, 1.8, 2.6, -pi}));
  const auto found = tests::run(scene, ReversedPaths::no, 20000, 1).entries();
  const double contact = (2 + 1e-3) / k;
  const HardDiskFluid fluid(241.0 / 96 * pi * contact * contact / 4, contact);
  for (std::size_t e = 0; e < found.value.size(); ++e) {
    const double view = scene.request.views[e].angle;
    const double alone = 241 * std::norm(amplitude(scene.medium.t_matrix, k, view));
    const double s = fluid.structure_factor(2 * k * std::abs(std::sin(view / 2)));
    CHECK(found.value[e].real() / alone == doctest::Approx(s).epsilon(1e-3));
  }
}

TEST_CASE("correlated disks: scattered power equals the extinction of the coherent beam") {
  SceneSpec spec = disks("1.2", circle(96));
  const Scene scene = make_scene(spec);
  CHECK(scene.medium.albedo == doctest::Approx(1).epsilon(1e-12));
  const double lost = 12 * (1 - std::exp(-scene.medium.mu_t * 8));
  const auto scattered = tests::run(scene, ReversedPaths::no, 40000, 1)
                             .weighted_sum(std::vector<double>(96, 2 * pi / 96));
  CHECK_WITHIN_4_SIGMA(scattered.value[0].real(), scattered.error[0], lost, 1e-3 * lost);
  CHECK(scattered.error[0] < 0.02 * lost);
  // less than the extinction by independent disks
  spec.structure = "none";
  CHECK(lost < 0.9 * 12 * (1 - std::exp(-make_scene(spec).medium.mu_t * 8)));
}

TEST_CASE("correlated disks: the covariance is positive semidefinite") {
  SceneSpec spec = disks("1.2", circle(24));
  spec.light_angles = {0, 0.3};
  spec.covariance = "full";
  const Scene scene = make_scene(spec);
  const auto triangle = tests::run(scene, ReversedPaths::yes, 4000, 1).entries().value;
  const std::size_t n = scene.request.channels.size();
  std::vector<Complex> matrix(n * n);
  for (std::size_t a = 0, e = 0; a < n; ++a)
    for (std::size_t b = 0; b <= a; ++b, ++e) matrix[a * n + b] = triangle[e];
  const auto values = eigenvalues(std::move(matrix));
  CHECK(values.front() > -1e-12 * values.back());
  CHECK(values.back() > 0);
}

}  // namespace flatspeckle::mc::test_correlated_media
