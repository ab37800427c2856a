#include <algorithm>
#include <cmath>
#include <functional>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <doctest/doctest.h>

#include "core/error.h"
#include "flatland/media/hard_sphere_fluid.h"
#include "grin/media/scattering/mie_phase.h"
#include "mc/slab/slab_jobs.h"
#include "tests/mc/space/scenes_in_space.h"

namespace flatspeckle::mc::test_suspensions {

namespace {

using std::numbers::pi;
using tests::tilted_pairs;

SceneSpec spheres(double radius, const std::string& index, double fraction) {
  SceneSpec spec;
  spec.domain = "slab";
  spec.dimension = 3;
  spec.depth = 20;
  spec.scatterer = "mie";
  spec.radius = radius;
  spec.index = index;
  spec.volume_fraction = fraction;
  return spec;
}

Scene made(const SceneSpec& spec) {
  return tests::in_space(spec, intensity_request({0}, {far_view(0)}));
}

/// Integrates the differential cross section of a sphere, times S and f, over all directions.
double cross_section(const Scene& scene, const std::function<double(double)>& f) {
  const double k = scene.k, radius = scene.scatterer.radius;
  const grin::MieSphere sphere(k * radius, scene.scatterer.index);
  const HardSphereFluid fluid(std::min(scene.medium.packing_fraction, 0.49), 2 * radius);
  const auto integrand = [&](double angle) {
    const auto [s1, s2] = sphere.amplitudes(std::cos(angle));
    const double structure = fluid.structure_factor(2 * k * std::sin(angle / 2));
    return pi * std::sin(angle) * (std::norm(s1) + std::norm(s2)) / (k * k) * structure * f(angle);
  };
  return boost::math::quadrature::gauss_kronrod<double, 61>::integrate(integrand, 0, pi, 12, 1e-11);
}

}  // namespace

// Values of an independent Mie series (logarithmic derivatives, as in BHMIE); it gives Wiscombe's
// values of Q_sca and g at size parameters 1 and 10.
TEST_CASE("suspension: 1 um polystyrene in water has the coefficients of an independent series") {
  SceneSpec spec = spheres(0.5, "", 0);
  spec.wavelength = 0.633;
  spec.medium_index = 1.33;
  spec.index.reset();
  spec.radius.reset();
  spec.volume_fraction.reset();
  spec.diameter = 1;
  spec.particle_index = "1.59";
  spec.mass_fraction = 0.01;
  spec.particle_density = 1.05;
  spec.medium_density = 1;
  const Scene scene = made(spec);
  const BulkMedium& medium = scene.medium;
  CHECK(medium.packing_fraction == doctest::Approx(0.00952834683).epsilon(1e-8));
  CHECK(medium.cross_sections.scattering / (pi / 4) ==
        doctest::Approx(2.59545825821).epsilon(1e-9));
  CHECK(medium.g == doctest::Approx(0.91689974867).epsilon(1e-9));
  CHECK(medium.density == doctest::Approx(0.0181978020).epsilon(1e-8));
  CHECK(medium.mu_s == doctest::Approx(0.0370956397).epsilon(1e-8));
  CHECK(medium.mu_t == medium.mu_s);
  CHECK(medium.reduced_scattering() == doctest::Approx(0.00308265698).epsilon(1e-8));
  CHECK(medium.transport_mean_free_path() == doctest::Approx(324.395483).epsilon(1e-8));
}

TEST_CASE("suspension: density and optical depth of spheres give the same medium") {
  SceneSpec spec = spheres(0.4, "1.3+0.01i", 0.03);
  const Scene by_fraction = made(spec);
  spec.volume_fraction.reset();
  spec.optical_depth = by_fraction.medium.mu_t * *spec.depth;
  const Scene by_depth = made(spec);
  CHECK(by_depth.medium.density == doctest::Approx(by_fraction.medium.density).epsilon(1e-14));
  CHECK(by_depth.medium.mu_s == doctest::Approx(by_fraction.medium.mu_s).epsilon(1e-14));
  CHECK(by_depth.medium.packing_fraction == doctest::Approx(0.03).epsilon(1e-14));
}

TEST_CASE("suspension: scattering and g of correlated spheres agree with direct quadrature") {
  for (const auto& [radius, index] : {std::pair{0.05, "1.2"}, {0.4, "1.3+0.02i"}, {2.0, "1.1"}})
    for (const double fraction : {0.01, 0.2, 0.49}) {
      SceneSpec spec = spheres(radius, index, fraction);
      CAPTURE(*spec.radius);
      CAPTURE(fraction);
      const BulkMedium alone = made(spec).medium;
      spec.structure = "hard_spheres";
      const Scene scene = made(spec);
      const BulkMedium& medium = scene.medium;
      const double whole = cross_section(scene, [](double) { return 1.0; }),
                   cosine = cross_section(scene, [](double angle) { return std::cos(angle); });
      CHECK(medium.mu_s == doctest::Approx(medium.density * whole).epsilon(1e-8));
      CHECK(std::abs(medium.g - cosine / whole) < 1e-8);
      CHECK(medium.reduced_scattering() ==
            doctest::Approx(medium.density * (whole - cosine)).epsilon(1e-7));
      CHECK(medium.mu_t - medium.mu_s ==
            doctest::Approx(alone.mu_t - alone.mu_s).epsilon(1e-9).scale(alone.mu_t));
      // The order of spheres that are small against the wavelength reduces their scattering.
      if (*spec.radius < 0.1) CHECK(medium.mu_s < alone.mu_s);
      const SpaceLaw law = SpaceGeometry::law(scene);
      CHECK(law.moments()[0] == doctest::Approx(1).epsilon(1e-9));
      CHECK(law.moments()[1] == doctest::Approx(medium.g).epsilon(1e-8));
    }
}

TEST_CASE("suspension: sampled angles of correlated spheres have the mean of the phase function") {
  SceneSpec spec = spheres(0.4, "1.3", 0.4);
  spec.structure = "hard_spheres";
  const SpacePhase phase = made(spec).medium.space_phase;
  RandomStream random(3, 1, 0);
  constexpr int samples = 40000, bins = 12;
  std::vector<double> found(bins);
  for (int i = 0; i < samples; ++i) {
    const double turn = phase.one_minus_cosine(random);
    ++found[static_cast<std::size_t>(std::min(bins - 1.0, bins * turn / 2))];
  }
  double chi_squared = 0;
  for (int bin = 0; bin < bins; ++bin) {
    const double expected = samples * 2 * pi *
                            boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
                                [&](double turn) { return phase.density(1 - turn); },
                                2.0 * bin / bins, 2.0 * (bin + 1) / bins, 8, 1e-9);
    chi_squared += std::pow(found[static_cast<std::size_t>(bin)] - expected, 2) / expected;
  }
  CHECK(chi_squared < bins - 1 + 4 * std::sqrt(2.0 * (bins - 1)));
}

TEST_CASE("suspension: Monte Carlo agrees with transport for correlated spheres") {
  SceneSpec spec = spheres(0.3, "1.2", 0.3);
  spec.depth = 8;
  spec.structure = "hard_spheres";
  const Scene scene = tests::in_space(spec, tilted_pairs(0.2, 0, {0, 0.1}));
  tests::check_agreement(scene, false, 40000, 0.05);
}

TEST_CASE("suspension: bad parameters of spheres are rejected, correlated ones have no gradient") {
  CHECK_THROWS_WITH_AS(made(spheres(100, "1.2", 0.1)), doctest::Contains("1e-6 to 500"),
                       InputError);
  CHECK_THROWS_WITH_AS(made(spheres(1, "1", 0.1)), doctest::Contains("do not scatter"), InputError);
  CHECK_THROWS_WITH_AS(made(spheres(1, "1.2", 1e-320)), doctest::Contains("not finite"),
                       InputError);
  SceneSpec spec = spheres(0.3, "1.2", 0.1);
  CHECK(slab_gradient_job(made(spec), false, {1e-2}).parameters.size() == 4);
  spec.structure = "hard_spheres";
  CHECK(slab_gradient_job(made(spec), false, {1e-2}).parameters.size() == 2);
}

}  // namespace flatspeckle::mc::test_suspensions
