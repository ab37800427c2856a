#include <cmath>
#include <memory>
#include <numbers>
#include <tuple>
#include <vector>

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/gauss.h"
#include "flatland/media/layers.h"
#include "mc/paths/estimators/covariance_estimator.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/slab_covariance.h"
#include "mc/slab/slab_flux.h"
#include "mc/theory/memory_effect.h"
#include "tests/mc/flux_runs.h"

namespace flatspeckle::mc::test_faces {

namespace {

using tests::pi;

/// A slab of Henyey-Greenstein scatterers behind faces. The wavelength inside is 1.
SceneSpec spec_of(double index, double optical_depth, double g, double albedo) {
  SceneSpec spec;
  spec.scatterer = "hg";
  spec.g = g;
  spec.albedo = albedo;
  spec.domain = "slab";
  spec.depth = 2000;
  spec.optical_depth = optical_depth;
  spec.wavelength = index;
  spec.medium_index = index;
  return spec;
}

Scene made(const SceneSpec& spec) {
  const Scene scene = make_scene(spec);
  return spec.dimension == 3 ? in_space(scene, spec) : scene;
}

/// Factor of intensities along the normal: both transmissions of the field, and the change of the
/// far field outside by refraction.
double through_faces(double index) {
  return std::pow(2 / (1 + index), 4) * index;
}

/// Tilt along the normal for which q times the depth has this value.
double tilt_of(const SceneSpec& spec, double q_depth) {
  return std::asin(q_depth / (2 * pi / spec.outside_wavelength() * *spec.depth));
}

/// Returns the fraction of power that a stack of faces reflects at an angle in the first medium,
/// with all reflections between the faces.
double stack_reflectance(const std::vector<double>& indices, double angle) {
  const double sine = indices.front() * std::sin(angle);
  double reflected = 0;
  for (std::size_t face = indices.size() - 1; face-- > 0;) {
    const double from = indices[face], to = indices[face + 1];
    double here = 1;
    if (sine < from && sine < to) {
      const double a = std::sqrt(from * from - sine * sine), b = std::sqrt(to * to - sine * sine);
      here = std::pow((a - b) / (a + b), 2);
    }
    const double rest = 1 - here;
    reflected = here + (rest == 0 ? 0 : rest * rest * reflected / (1 - here * reflected));
  }
  return reflected;
}

/// Returns the intensity along the normal of a slab of isotropic scatterers between faces, for a
/// unit wave inside, by the integral equation of the fluence with all images of the slab in its
/// faces, on `cells` equal cells. indices: those of the slab, of clear layers at both sides, and
/// outside.
double normal_intensity(const std::vector<double>& indices, double depth, double albedo,
                        int cells) {
  const double step = depth / cells, critical = indices.front() > 1
                                                    ? std::asin(indices.back() / indices.front())
                                                    : pi / 2;
  std::vector<std::pair<double, double>> angles;  // and weights
  const QuadratureRule rule = gauss_legendre(40);
  for (const auto& [from, to] : {std::pair(0.0, critical), {critical, pi / 2}})
    for (std::size_t i = 0; i < rule.node.size() && to > from; ++i) {
      const double u = rule.node[i];
      angles.emplace_back(to - (to - from) * u * u, (to - from) * 2 * u * rule.weight[i]);
    }
  Eigen::MatrixXd kernel = Eigen::MatrixXd::Zero(cells, cells);
  for (const auto& [angle, weight] : angles) {
    const double c = std::cos(angle), r = stack_reflectance(indices, angle),
                 across = std::exp(-depth / c);
    const double cell = c * -std::expm1(-step / c);  // integral of exp(-z / c) over a cell
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j) {
        const int apart = std::abs(i - j);
        const double near = i == j ? 2 * (step - cell)
                                   : cell * cell / c * std::exp(-(apart - 1) * step / c),
                     images = cell * cell / c *
                              (r * std::exp(-(i + j) * step / c) +
                               r * std::exp(-(2 * cells - 2 - i - j) * step / c) +
                               r * r * std::exp(-(2 * cells - apart - 1) * step / c));
        kernel(i, j) +=
            2 * weight * (near + images) / (step * 2 * pi * (1 - r * r * across * across));
      }
  }
  Eigen::VectorXd light(cells);
  const double r = stack_reflectance(indices, 0), across = std::exp(-depth);
  const auto mean = [&](int cell) { return std::exp(-cell * step) * -std::expm1(-step) / step; };
  for (int i = 0; i < cells; ++i)
    light[i] = (mean(i) + r * across * mean(cells - 1 - i)) / (1 - r * r * across * across);
  const Eigen::VectorXd fluence =
      (Eigen::MatrixXd::Identity(cells, cells) - albedo * kernel).partialPivLu().solve(light);
  double sum = 0;
  for (int i = 0; i < cells; ++i) sum += fluence[i] * light[cells - 1 - i];
  return albedo * step * sum / (2 * pi);
}

struct Row {
  double index, optical_depth, g, albedo, intensity;
  std::vector<std::pair<double, double>> correlation;  ///< q L and C_I
};

/// Compares two methods entry by entry.
void check_against_transport(SceneSpec spec, ReversedPaths reversed, std::uint64_t seed) {
  const Scene scene = made(spec);
  const Plan plan = make_plan(scene, reversed);
  const auto exact = slab_covariance(scene, plan.reversed, {1e-5}).value;
  const Estimate found = tests::run(scene, plan, 40000, seed).entries();
  for (std::size_t e = 0; e < exact.size(); ++e) {
    CAPTURE(e);
    CHECK_WITHIN_4_SIGMA(found.value[e], found.error[e], exact[e], 1e-4 * std::abs(exact[e]));
  }
}

}  // namespace

TEST_CASE("transport with faces: intensities and C_I agree with tabulated discrete ordinates") {
  // A dense solution without reflections of the unscattered light, whose effect is up to 3e-5 here
  constexpr double accuracy = 5e-5;
  const std::vector<Row> rows = {
      {1, 10, 0, 1, 0.087752, {}},
      {1.33,
       10,
       0,
       1,
       0.137602,
       {{0.5, 0.88720}, {1, 0.63192}, {1.5, 0.37897}, {2, 0.20184}, {3, 0.04741}}},
      {1.33,
       10,
       0.9,
       1,
       0.522842,
       {{0.5, 0.81842}, {1, 0.59853}, {1.5, 0.47626}, {2, 0.40365}, {3, 0.31078}}},
      {1.5,
       10,
       0.9,
       1,
       0.577501,
       {{0.5, 0.75909}, {1, 0.51307}, {1.5, 0.39559}, {2, 0.33154}, {3, 0.25364}}},
      {1.33,
       5,
       0.5,
       0.98,
       0.270893,
       {{0.5, 0.85621}, {1, 0.58187}, {1.5, 0.36315}, {2, 0.22977}, {3, 0.10845}}}};
  for (const Row& row : rows) {
    CAPTURE(row.index);
    CAPTURE(row.g);
    SceneSpec spec = spec_of(row.index, row.optical_depth, row.g, row.albedo);
    spec.covariance = "memory_effect";
    spec.tilts = {0};
    for (const auto& [q_depth, correlation] : row.correlation)
      spec.tilts.push_back(tilt_of(spec, q_depth));
    const Scene scene = made(spec);
    const auto value = slab_covariance(scene, false, {1e-6}).value;
    CHECK(value[scene.request.reference_intensity(0)].real() / through_faces(row.index) ==
          doctest::Approx(row.intensity).epsilon(accuracy));
    for (std::size_t t = 0; t < row.correlation.size(); ++t)
      CHECK(std::norm(field_correlation(scene.request, value, {0})[t + 1]) ==
            doctest::Approx(row.correlation[t].second).epsilon(accuracy));
  }
}

TEST_CASE("transport with faces: isotropic slabs agree with the integral equation with images") {
  for (const auto& [n, optical_depth, albedo] :
       {std::tuple(1.0, 3.0, 1.0), {1.33, 10.0, 1.0}, {1.5, 1.0, 0.9}, {0.8, 2.0, 1.0}}) {
    const double index = n;
    CAPTURE(index);
    const Scene scene = made(spec_of(index, optical_depth, 0, albedo));
    const double coarse = normal_intensity({index, 1}, optical_depth, albedo, 80),
                 fine = normal_intensity({index, 1}, optical_depth, albedo, 160),
                 expected = fine + (fine - coarse) / 3;
    CHECK(slab_covariance(scene, false, {1e-7}).value[0].real() / through_faces(index) ==
          doctest::Approx(expected).epsilon(3e-6));
  }
}

TEST_CASE("transport with faces: a cell between cover slips agrees with the integral equation") {
  constexpr double water = 1.33, glass = 1.52, optical_depth = 3;
  Scene cell = made(spec_of(water, optical_depth, 0, 1));
  Material scatters{cell.scatterer, cell.medium, {}, water}, clear = scatters;
  clear.index = glass;
  clear.medium.mu_s = clear.medium.mu_t = 1e-18;
  cell.profile = std::make_shared<const Layers>(std::vector<Material>{clear, scatters, clear},
                                                std::vector<double>{500, 2000, 500});
  cell.medium = cell.profile->mean();
  cell.domain.depth = 3000;
  // the first layer defines Faces::inside and the wavenumber
  cell.faces->inside = glass;
  cell.k *= glass / water;
  const std::vector<double> indices{water, glass, 1};
  const double coarse = normal_intensity(indices, optical_depth, 1, 80),
               fine = normal_intensity(indices, optical_depth, 1, 160),
               twice = (glass - 1) / (glass + 1) * (glass - water) / (glass + water),
               enter =
                   std::pow(2 / (1 + glass) * 2 * glass / (glass + water), 2) / (1 - twice * twice);
  CHECK(slab_covariance(cell, false, {1e-7}).value[0].real() / (enter * enter * water) ==
        doctest::Approx(fine + (fine - coarse) / 3).epsilon(3e-6));
  const FluxJob job = slab_flux_job(cell, 4, {1e-7});
  for (const Invariant& balance :
       power_balance(job, tests::summed(job.batches, 2), unscattered_shares(cell)))
    CHECK(balance.holds());
}

TEST_CASE("flux with faces: half-space of Giovanelli and power balance") {
  SceneSpec spec = spec_of(1.5, 100, 0, 0.9);
  spec.dimension = 3;
  spec.polarisation = "unpolarised";
  const auto flux = flux_estimates(slab_flux_job(made(spec), 1, {1e-8}),
                                   tests::summed(slab_flux_job(made(spec), 1, {1e-8}).batches, 2));
  const double specular = specular_reflectance(made(spec), 0);
  CHECK(specular == doctest::Approx(0.04).epsilon(1e-12));
  // Giovanelli, Optica Acta 2 (1955) 153: the total reflectance
  CHECK(std::abs(flux.reflectance.value[0].real() + specular - 0.2600) < 1e-4);
  for (const double index : {0.7, 1.33}) {
    SceneSpec plane = spec_of(index, 3, 0.8, 0.95);
    plane.light_angles = {0, 0.6};
    const Scene scene = made(plane);
    const FluxJob job = slab_flux_job(scene, 8, {1e-7});
    for (const Invariant& balance :
         power_balance(job, tests::summed(job.batches, 2), unscattered_shares(scene)))
      CHECK(balance.holds());
  }
}

TEST_CASE("Monte Carlo with faces: agrees with transport") {
  SceneSpec spec = spec_of(1.33, 2, 0.5, 0.98);
  spec.depth = 200;
  spec.light_angles = {0.2};
  spec.view_angles = {0.3};
  spec.covariance = "memory_effect";
  spec.tilts = {0, 0.001, 0.003};
  check_against_transport(spec, ReversedPaths::no, 1);
  spec.dimension = 3;
  check_against_transport(spec, ReversedPaths::no, 2);
  spec.dimension = 2;
  spec.polarisation = "te";
  spec.outside_index = 1.5;
  check_against_transport(spec, ReversedPaths::no, 3);
  SceneSpec back = spec_of(1.5, 2, 0, 1);
  back.depth = 200;
  back.light_angles = {0.2};
  back.view_angles = {pi + 0.2, pi + 0.202};
  check_against_transport(back, ReversedPaths::yes, 4);
}

TEST_CASE("flux with faces: Monte Carlo agrees with transport") {
  SceneSpec spec = spec_of(1.4, 2, 0.5, 0.95);
  spec.light_angles = {0, 0.7};
  const Scene scene = made(spec);
  const auto job = slab_flux_job(scene, 1, {1e-7});
  const auto exact = flux_estimates(job, tests::summed(job.batches, 2));
  const auto found = tests::run_flux(scene, tests::paths(40000), 7).flux;
  for (std::size_t light = 0; light < 2; ++light) {
    tests::check_share(found.reflectance, light, exact.reflectance.value[light].real());
    tests::check_share(found.transmittance, light, exact.transmittance.value[light].real());
    tests::check_share(found.absorptance, light, exact.absorptance.value[light].real());
  }
}

TEST_CASE("faces between equal indices change only angles and wavelengths") {
  SceneSpec spec = spec_of(1.33, 3, 0.5, 0.98), inside = spec;
  spec.outside_index = 1.33;
  spec.light_angles = {0.3};
  spec.view_angles = {-0.4};
  inside.medium_index = std::nullopt;
  inside.wavelength = 1;
  inside.light_angles = spec.light_angles;
  inside.view_angles = spec.view_angles;
  CHECK(
      slab_covariance(made(spec), false, {1e-7}).value[0].real() ==
      doctest::Approx(slab_covariance(made(inside), false, {1e-7}).value[0].real()).epsilon(1e-7));
}

TEST_CASE("faces: unpolarised light has no covariance") {
  SceneSpec spec = spec_of(1.33, 3, 0.5, 1);
  spec.polarisation = "unpolarised";
  CHECK_THROWS_AS(path_walks(made(spec), make_plan(made(spec), ReversedPaths::no), 1), InputError);
}

}  // namespace flatspeckle::mc::test_faces
