#include <random>

#include <doctest/doctest.h>

#include "mc/fit/medium_fit.h"
#include "mc/fit/task/curve_values.h"
#include "tests/statistics.h"

namespace flatspeckle::mc::test_distance_fit {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double mu_s = 11.5, mu_a = 0.013, g = 0.9, diffusion = 200, scale = 0.3, beta = 0.45;

MovingSpec tissue() {
  MovingSpec spec;
  spec.domain = "slab";
  spec.dimension = 3;
  spec.scatterer = "hg";
  spec.depth = 100;
  spec.g = g;
  spec.medium_index = 1.4;
  spec.polarisation = "unpolarised";
  return spec;
}

DistanceRequest fibres(const std::vector<double>& distances) {
  DistanceRequest request;
  for (const double distance : distances)
    request.detectors.push_back({DistanceDetector::Kind::disk, distance, 0.5});
  return request;
}

/// Returns the scene and the values of distance_solution() for the true coefficients.
std::vector<double> solved(const DistanceRequest& request) {
  MovingSpec truth = tissue();
  truth.mu_s = mu_s;
  truth.mu_a = mu_a;
  return real_parts(distance_solution(scene_of(truth), request, 1e-3).value);
}

/// Returns a measurement of a curve with relative errors `share`, with noise unless the seed is 0.
Measurement measured(const Curve& curve, const std::vector<double>& exact, double share,
                     unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Measurement one{"synthetic", {curve}, {}, {}};
  one.values = Eigen::Map<const VectorXd>(exact.data(), std::ssize(exact));
  const VectorXd error = share * one.values;
  one.covariance = error.cwiseAbs2().asDiagonal();
  for (Index i = 0; seed > 0 && i < error.size(); ++i) one.values[i] += error[i] * normal(random);
  return one;
}

/// Reflectance at 11 distances from 5 to 30, by a detector of known or unknown scale.
Measurement reflectances(double share, unsigned seed, double factor = 1) {
  Curve curve{tissue(), Observable::reflectance, {}, {}};
  for (int i = 0; i < 11; ++i) curve.abscissa.push_back(5 + 2.5 * i);
  curve.distances = fibres(curve.abscissa);
  static const std::vector<double> powers = solved(*curve.distances);
  std::vector<double> exact;
  for (std::size_t i = 0; i < curve.abscissa.size(); ++i) {
    curve.entries.push_back(i);
    exact.push_back(factor * powers[i] / curve.distances->detectors[i].area());
  }
  return measured(curve, exact, share, seed);
}

/// g1, or g2 - 1, after several delays at a distance of 20.
Measurement decay(Observable observable, double share, unsigned seed) {
  const std::vector<double> delays = {1e-6, 3e-6, 1e-5, 3e-5, 1e-4};
  DistanceRequest request = fibres({20});
  request.dynamics = {.delays = delays, .motion = {.diffusion = diffusion}};
  const auto fields = solved(request);
  Curve curve{tissue(), observable, {}, delays, delays, delays};
  curve.distances = fibres(std::vector<double>(delays.size(), 20));
  std::vector<double> exact;
  for (std::size_t i = 0; i < delays.size(); ++i) {
    curve.entries.push_back(i);
    const double g1 = fields[1 + i] / fields[0];
    exact.push_back(observable == Observable::field_correlation ? g1 : beta * g1 * g1);
  }
  return measured(curve, exact, share, seed);
}

FitTask task_of(std::vector<Measurement> measurements, const std::vector<std::string>& free) {
  FitTask task;
  task.free = read_free_parameters(free, MovingSpec{});
  task.measurements = std::move(measurements);
  return task;
}

void check_values(const FitTask& task, const VectorXd& truth) {
  const MediumFit fit = fit_medium(task);
  REQUIRE(fit.converged);
  CAPTURE(fit.estimates.transpose());
  CAPTURE(fit.errors.transpose());
  CHECK((fit.estimates - truth).cwiseQuotient(fit.errors).cwiseAbs().maxCoeff() < 0.1);
  REQUIRE(fit.derivative_check);
  CHECK(fit.derivative_check->holds());
}

}  // namespace

TEST_CASE("distance fit: reflectance against distance gives mu_a and mu_s within their errors") {
  const unsigned sets = tests::is_night ? 100 : 8;
  VectorXd sum = VectorXd::Zero(2), squares = sum;
  double chi_squared = 0;
  for (unsigned seed = 1; seed <= sets; ++seed) {
    FitTask task = task_of({reflectances(0.05, seed)}, {"mu_a=0.001:0.1", "mu_s=2:50"});
    const MediumFit fit = fit_medium(task);
    REQUIRE(fit.converged);
    const VectorXd off = (fit.estimates - VectorXd{{mu_a, mu_s}}).cwiseQuotient(fit.errors);
    sum += off;
    squares += off.cwiseAbs2();
    chi_squared += fit.chi_squared;
    CHECK(fit.degrees_of_freedom == doctest::Approx(9));
  }
  const double count = sets, four_errors = 4 / std::sqrt(count);
  CAPTURE((sum / count).transpose());
  CAPTURE((squares / count).transpose());
  CAPTURE(chi_squared / count);
  CHECK((sum / count).cwiseAbs().maxCoeff() < four_errors);
  CHECK((squares / count - VectorXd::Ones(2)).cwiseAbs().maxCoeff() < four_errors * std::sqrt(2.0));
  CHECK(std::abs(chi_squared / count - 9) < four_errors * std::sqrt(18.0));
}

TEST_CASE("distance fit: values without noise give scale, diffusion and beta") {
  check_values(task_of({reflectances(0.05, 0, scale)},
                       {"mu_a=0.001:0.1", "mu_s=2:50", "detector_scale=0.01:10"}),
               VectorXd{{mu_a, mu_s, scale}});
  check_values(task_of({reflectances(0.05, 0), decay(Observable::field_correlation, 0.05, 0)},
                       {"diffusion=20:2000", "mu_a=0.001:0.1", "mu_s=2:50"}),
               VectorXd{{diffusion, mu_a, mu_s}});
  auto counters = task_of({decay(Observable::intensity_correlation, 0.05, 0)},
                          {"diffusion=20:2000", "beta=0.1:1"});
  counters.measurements[0].curves[0].scene.mu_s = mu_s;
  counters.measurements[0].curves[0].scene.mu_a = mu_a;
  check_values(counters, VectorXd{{diffusion, beta}});
}

}  // namespace flatspeckle::mc::test_distance_fit
