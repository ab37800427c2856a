#include <cmath>

#include <doctest/doctest.h>

#include "core/search/levenberg_marquardt.h"
#include "tests/mc/transport/slabs.h"

namespace flatspeckle::mc::test_slab_information {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using tests::deflected;
using tests::pi;

constexpr double depth = 2000, share = 0.01;  // share: standard error over intensity

/// Real parts of the intensity and of three tilts per view, as functions of g, albedo and optical
/// depth.
struct Views {
  std::vector<double> angles;

  Scene scene(const VectorXd& p) const {
    const auto request = memory_effect_request(
        tests::wavenumber, 0, angles,
        {deflected(0, 0.5 / depth), deflected(0, 1 / depth), deflected(0, 2 / depth)});
    return tests::hg_slab(depth, {depth / p[2], p[0], p[1]}, request);
  }
  std::vector<Complex> values(const VectorXd& p) const {
    return slab_covariance(scene(p), false, {1e-4}).value;
  }
  MatrixXd derivatives(const VectorXd& p) const {
    const Scene at = scene(p);
    const auto n = static_cast<Index>(at.request.entries.size());
    MatrixXd found(n, 3);
    const BulkParameter of[] = {BulkParameter::g, BulkParameter::albedo, BulkParameter::mu_t};
    const double unit[] = {1, 1, 1 / depth};
    for (Index j = 0; j < 3; ++j) {
      const auto all = slab_derivatives(at, false, {1e-4}, of[j]).value;
      for (Index e = 0; e < n; ++e)
        found(e, j) = all[static_cast<std::size_t>(n + e)].real() * unit[j];
    }
    return found;
  }
};

/// Least squares about the truth; errors are a fixed share of the true values.
BoundedLeastSquares slab(const Views& views, const VectorXd& truth) {
  const auto measured = views.values(truth);
  const auto n = static_cast<Index>(measured.size());
  VectorXd data(n);
  for (Index e = 0; e < n; ++e) data[e] = measured[static_cast<std::size_t>(e)].real();
  const VectorXd error = share * data.cwiseAbs();
  return {[=](const VectorXd& p) -> VectorXd {
            const auto found = views.values(p);
            VectorXd residual(n);
            for (Index e = 0; e < n; ++e)
              residual[e] = (found[static_cast<std::size_t>(e)].real() - data[e]) / error[e];
            return residual;
          },
          [=](const VectorXd& p, const VectorXd&) -> MatrixXd {
            return error.cwiseInverse().asDiagonal() * views.derivatives(p);
          },
          VectorXd{{0.3, 0.9, 2}}, VectorXd{{0.95, 1, 60}}};
}

Information known(const Views& views, const VectorXd& truth) {
  const auto problem = slab(views, truth);
  return information(problem, problem.jacobian(truth, problem.residuals(truth)));
}

}  // namespace

TEST_CASE("slab information: transmission and reflection give g, albedo and optical depth") {
  const VectorXd truth{{0.8, 0.98, 4}};
  const auto problem = slab({{0.1, pi - 0.3}}, truth);
  const auto fit = levenberg_marquardt(
      problem, tests::is_night ? VectorXd{{0.7, 0.96, 5}} : VectorXd{{0.78, 0.975, 4.3}});
  REQUIRE(fit.converged);
  const VectorXd errors = information(problem, fit.jacobian).errors();
  CHECK((fit.parameters - truth).cwiseQuotient(errors).cwiseAbs().maxCoeff() < 0.05);
}

TEST_CASE("slab information: reflection determines g of a thick slab better than transmission") {
  const VectorXd thick{{0.8, 0.98, 30}};
  const auto alone = known({{0.1}}, thick), both = known({{0.1, pi - 0.3}}, thick);
  CHECK(both.errors()[0] < alone.errors()[0] / 3);
  CHECK(both.condition < alone.condition);
}

}  // namespace flatspeckle::mc::test_slab_information
