// Diffusion theory of faces and delays, and the keys of moving scatterers.
#include <cmath>
#include <vector>

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include "bench/oracles/quadrature.h"
#include "core/error.h"
#include "mc/jobs/dynamics.h"
#include "mc/slab/slab_covariance.h"
#include "mc/theory/diffusing_waves.h"
#include "tests/mc/space/scenes_in_space.h"

namespace flatspeckle::mc::test_diffusing_waves {

namespace {

using tests::pi;

struct Index {
  double inside, outside;
  bool te;
};

/// Returns Fresnel's reflectance, from amplitudes with complex cosines.
double reflectance(const Index& index, double cosine) {
  const double ratio = index.inside / index.outside;
  const Complex outside = std::sqrt(Complex(1 - ratio * ratio * (1 - cosine * cosine)));
  return std::norm(index.te ? (cosine - ratio * outside) / (cosine + ratio * outside)
                            : (ratio * cosine - outside) / (ratio * cosine + outside));
}

/// Returns the extrapolation length of isotropic scatterers, in mean free paths, by discrete
/// ordinates: far inside the radiance is z + length - mu. Near the face decaying modes 1/(1 - s mu)
/// exp(-s z) are added, with s^2 from the eigenvalues of the ordinates.
double milne_length(const Index& index, int dimension) {
  const double critical =
      index.inside > index.outside ? std::asin(index.outside / index.inside) : pi / 2;
  oracles::GaussPanels angles;
  for (const auto& [from, to] :
       {std::pair{0.0, 0.8}, {0.8, 0.97}, {0.97, 1.0}, {1.0, 1.1}, {1.1, 1.4}, {1.4, 2.0}})
    angles.add(from > 1 ? critical + (from - 1) * (pi / 2 - critical) : from * critical,
               to > 1 ? critical + (to - 1) * (pi / 2 - critical) : to * critical);
  std::vector<double> cosine, weight;
  for (std::size_t i = 0; i < angles.node.size(); ++i) {
    if (!(angles.weight[i] > 0)) continue;
    cosine.push_back(std::cos(angles.node[i]));
    weight.push_back(angles.weight[i] * (dimension == 3 ? std::sin(angles.node[i]) : 2 / pi));
  }
  const auto n = static_cast<Eigen::Index>(cosine.size());
  const Eigen::Map<Eigen::ArrayXd> mu(cosine.data(), n), w(weight.data(), n);
  const Eigen::VectorXd share = (w / mu.square()).sqrt();
  Eigen::MatrixXd modes =
      -Eigen::MatrixXd((w.sqrt() / mu).matrix() * (w.sqrt() / mu).matrix().transpose());
  modes.diagonal() += (1 / mu.square()).matrix();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(modes, Eigen::EigenvaluesOnly);
  Eigen::MatrixXd system(n, n);
  Eigen::VectorXd right(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double r = reflectance(index, mu[i]);
    system(i, 0) = 1 - r;
    right[i] = (1 + r) * mu[i];
    for (Eigen::Index mode = 1; mode < n; ++mode) {
      const double s = std::sqrt(solver.eigenvalues()[mode]);
      system(i, mode) = 1 / (1 - s * mu[i]) - r / (1 + s * mu[i]);
    }
  }
  const Eigen::VectorXd scale = system.cwiseAbs().colwise().maxCoeff();
  for (Eigen::Index mode = 0; mode < n; ++mode) system.col(mode) /= scale[mode];
  return system.partialPivLu().solve(right)[0] / scale[0];
}

Scene slab_with(const Index& index, int dimension) {
  Scene scene;
  scene.medium.dimension = dimension;
  scene.medium.mu_s = scene.medium.mu_t = 1;
  scene.faces = Faces{index.inside, index.outside, index.te ? Polarisation::te : Polarisation::tm};
  return scene;
}

BulkMedium medium_in_space(double mu_t, double g, double albedo) {
  BulkMedium medium;
  medium.dimension = 3;
  medium.mu_t = mu_t;
  medium.mu_s = albedo * mu_t;
  medium.g = g;
  return medium;
}

}  // namespace

TEST_CASE("extrapolation length: agrees with discrete ordinates of the Milne problem") {
  CHECK(milne_length({1, 1, false}, 3) == doctest::Approx(0.710446).epsilon(1e-4));
  CHECK(milne_length({1, 1, false}, 2) == doctest::Approx(0.818309).epsilon(1e-4));
  for (const int dimension : {2, 3})
    for (const bool te : {false, true})
      for (const double inside : {0.9, 1.1, 1.33, 1.5, 2.0}) {
        if (te && dimension == 3) continue;
        CAPTURE(dimension);
        CAPTURE(inside);
        CAPTURE(te);
        const Index index{inside, 1, te};
        CHECK(extrapolation_length(slab_with(index, dimension)) ==
              doctest::Approx(milne_length(index, dimension)).epsilon(5e-3));
        const Index in_water{inside * 1.33, 1.33, te};
        CHECK(extrapolation_length(slab_with(in_water, dimension)) ==
              doctest::Approx(extrapolation_length(slab_with(index, dimension))).epsilon(1e-12));
      }
}

TEST_CASE("extrapolation length: without reflection it is that of the medium") {
  for (const int dimension : {2, 3}) {
    Scene scene = slab_with({1.33, 1.33, false}, dimension);
    const double matched = extrapolation_length(scene.medium);
    CHECK(extrapolation_length(scene) == matched);
    scene.faces->outside = 1.33 * (1 + 1e-6);
    CHECK(extrapolation_length(scene) == doctest::Approx(matched).epsilon(1e-3));
    scene.faces.reset();
    CHECK(extrapolation_length(scene) == matched);
  }
}

TEST_CASE("diffusing-wave correlation: agrees with the formulas of Weitz and Pine") {
  const double depth = 12;
  for (const double g : {0.0, 0.8}) {
    const BulkMedium medium = medium_in_space(1 / (1 - g), g, 1);
    const DiffusingSlab slab(medium, depth);
    const double h = slab.extrapolation;
    for (const double t : {1e-6, 1e-3, 0.02}) {
      const double x = std::sqrt(6 * t);  // lengths in transport mean free paths
      const double transmitted =
          (depth + 2 * h) / (1 + h) * (std::sinh(x) + h * x * std::cosh(x)) /
          ((1 + h * h * x * x) * std::sinh(depth * x) + 2 * h * x * std::cosh(depth * x));
      CHECK(diffusing_wave_correlation(slab, t, ExitSide::transmitted) ==
            doctest::Approx(transmitted).epsilon(1e-9));
    }
    CHECK(diffusing_wave_correlation(slab, 0, ExitSide::transmitted) == 1);
    CHECK(diffusing_wave_correlation(slab, 0, ExitSide::reflected) == 1);
    const DiffusingSlab deep(medium, 1e6);
    for (const double t : {1e-6, 1e-4})
      CHECK(diffusing_wave_correlation(deep, t, ExitSide::reflected) ==
            doctest::Approx(std::exp(-backscattering_factor(deep) * std::sqrt(6 * t)))
                .epsilon(6 * t));
  }
}

TEST_CASE("diffusing-wave correlation: finite and at most 1 for all delays and absorptions") {
  for (const double depth : {0.01, 10.0, 1e4})
    for (const double albedo : {0.01, 0.9, 1.0})
      for (const double delay : {0.0, 1e-12, 1.0, 1e6})
        for (const ExitSide side : {ExitSide::transmitted, ExitSide::reflected}) {
          const double value =
              diffusing_wave_correlation({medium_in_space(1, 0.9, albedo), depth}, delay, side);
          CHECK(value >= 0);
          CHECK(value <= 1 + 1e-9);
        }
}

TEST_CASE("decay time of a thick slab in space: transport agrees with diffusion theory") {
  const auto spec = tests::hg_in_space(1000, 100, 0, 1);
  for (const auto side : {ExitSide::transmitted, ExitSide::reflected}) {
    CAPTURE(side == ExitSide::reflected);
    const double view = side == ExitSide::transmitted ? 0 : pi, bias = view == 0 ? 0.002 : 0.1;
    const Scene scene = tests::in_space(spec, intensity_request({0}, {far_view(view)}));
    const double decay = diffusing_wave_decay(scene, side);
    const double now = slab_covariance(scene, false, {1e-5}).value[0].real(),
                 then = slab_covariance(scene, false, {1e-5}, {.delay = decay}).value[0].real();
    CHECK(then / now == doctest::Approx(std::exp(-1)).epsilon(bias));
  }
}

TEST_CASE("diffusion constant: that of a sphere of 0.5 um radius in water at 20 degrees Celsius") {
  CHECK(stokes_einstein(293.15, 1.0016e-3, 0.5e-6) == doctest::Approx(4.28e-13).epsilon(2e-3));
}

namespace {

struct Values {
  SceneSpec spec;
  DynamicsValues moving;
};
void add_keys(Keys& keys, Values& values) {
  add_keys(keys, values.moving);
}

Dynamics dynamics(const DynamicsValues& moving, const std::optional<double>& metres = 1e-6) {
  Values given;
  given.moving = moving;
  given.spec.wavelength = 0.5;
  return made_of(given, [&](const Keys& keys, const Values& values) {
    return make_dynamics(keys, values.moving, values.spec, metres);
  });
}

}  // namespace

TEST_CASE("dynamics: delays are in s if the diffusion constant has a unit") {
  const auto by_unit = dynamics({.delays = {"0", "1us:1ms:2", "2"}, .diffusion = "0.4 um^2/s"});
  CHECK(by_unit.delays == std::vector<double>{0, 1e-6, 1e-3, 2});
  CHECK(by_unit.diffusion.value() == doctest::Approx(4e-13).epsilon(1e-12));
  const double k = 2 * pi / 0.5e-6;
  CHECK(by_unit.motion.diffusion == doctest::Approx(4e-13 * k * k).epsilon(1e-12));
  const auto by_liquid =
      dynamics({.delays = {"1 ms"}, .temperature = 300, .viscosity = 1e-3, .particle_radius = 0.2});
  CHECK(by_liquid.diffusion.value() ==
        doctest::Approx(stokes_einstein(300, 1e-3, 0.2e-6)).epsilon(1e-12));
  const auto plain = dynamics({.delays = {"0.1", "1"}, .diffusion = "3"}, std::nullopt);
  CHECK_FALSE(plain.diffusion.has_value());
  CHECK(plain.motion.diffusion == 3);
  CHECK(plain.delays == std::vector<double>{0.1, 1});
}

TEST_CASE("dynamics: mixtures of units and plain numbers are rejected") {
  const auto refused = [](const DynamicsValues& moving, std::optional<double> metres = 1e-6) {
    CHECK_THROWS_AS(dynamics(moving, metres), InputError);
  };
  refused({.delays = {"1us"}});
  refused({.delays = {"1us"}, .diffusion = "2"});
  refused({.delays = {"1m"}, .diffusion = "1e-12 m^2/s"});
  refused({.delays = {"1us"}, .diffusion = "1e-12 m^2/s"}, std::nullopt);
  refused({.delays = {"1us"}, .diffusion = "1e-12 m/s"});
  refused({.delays = {"1us"}, .diffusion = "-1e-12 m^2/s"});
  refused({.delays = {"1us"}, .temperature = 300, .particle_radius = 1});
  refused({.delays = {"1us"}, .temperature = 300, .viscosity = 1e-3});
  refused({.delays = {"1"}, .viscosity = 1e-3});
  refused({.delays = {"1"}, .diffusion = "1", .temperature = 300, .viscosity = 1e-3});
  refused({.delays = {"1"}, .exposures = {"1ms"}});
  refused({.diffusion = "1"});
}

}  // namespace flatspeckle::mc::test_diffusing_waves
