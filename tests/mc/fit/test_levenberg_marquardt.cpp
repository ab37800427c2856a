#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "core/search/levenberg_marquardt.h"
#include "core/search/profile.h"

namespace flatspeckle::mc::test_levenberg_marquardt {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_iterations = 60;
constexpr double precise = 1e-12;

/// Straight line through points of known errors, whose fit has a closed form.
struct Line {
  VectorXd x{{0, 1, 2, 3, 4}}, y{{1.1, 2.9, 5.2, 6.8, 9.1}}, error{{0.1, 0.2, 0.1, 0.3, 0.2}};

  BoundedLeastSquares problem(const VectorXd& lower, const VectorXd& upper) const {
    return {[this](const VectorXd& p) -> VectorXd {
              return ((p[0] + p[1] * x.array()) - y.array()) / error.array();
            },
            [this](const VectorXd&, const VectorXd&) {
              MatrixXd derivatives(x.size(), 2);
              derivatives << error.cwiseInverse(), x.cwiseQuotient(error);
              return derivatives;
            },
            lower, upper};
  }
};

/// Least squares of y = a exp(-b x).
BoundedLeastSquares decay(const VectorXd& x, const VectorXd& y, double error) {
  return {[=](const VectorXd& p) -> VectorXd {
            return (p[0] * (-p[1] * x.array()).exp() - y.array()) / error;
          },
          [=](const VectorXd& p, const VectorXd&) {
            const VectorXd falling = (-p[1] * x.array()).exp() / error;
            MatrixXd derivatives(x.size(), 2);
            derivatives << falling, -p[0] * x.cwiseProduct(falling);
            return derivatives;
          },
          VectorXd{{0.1, 0.01}}, VectorXd{{10, 5}}};
}

}  // namespace

TEST_CASE("Levenberg-Marquardt: a straight-line fit agrees with the closed form") {
  const Line line;
  const auto problem = line.problem(VectorXd{{-10, -10}}, VectorXd{{10, 10}});
  const auto fit = levenberg_marquardt(problem, VectorXd{{5, -3}}, most_iterations, precise);
  const Eigen::ArrayXd weight = line.error.array().square().inverse();
  const double w = weight.sum(), wx = (weight * line.x.array()).sum(),
               wxx = (weight * line.x.array().square()).sum(), wy = (weight * line.y.array()).sum(),
               wxy = (weight * line.x.array() * line.y.array()).sum(), det = w * wxx - wx * wx;
  REQUIRE(fit.converged);
  CHECK(fit.parameters[0] == doctest::Approx((wxx * wy - wx * wxy) / det).epsilon(1e-6));
  CHECK(fit.parameters[1] == doctest::Approx((w * wxy - wx * wy) / det).epsilon(1e-6));
  const auto known = information(problem, fit.jacobian);
  CHECK(known.covariance(0, 0) == doctest::Approx(wxx / det));
  CHECK(known.covariance(1, 1) == doctest::Approx(w / det));
  CHECK(known.correlation(0, 1) == doctest::Approx(-wx / std::sqrt(w * wxx)));
}

TEST_CASE("Levenberg-Marquardt: with one parameter at its bound the others are optimal") {
  const Line line;
  const auto problem = line.problem(VectorXd{{-10, -10}}, VectorXd{{10, 1.5}});
  const auto fit = levenberg_marquardt(problem, VectorXd{{5, -3}}, most_iterations, precise);
  const Eigen::ArrayXd weight = line.error.array().square().inverse();
  REQUIRE(fit.converged);
  CHECK(fit.parameters[1] == 1.5);
  CHECK(fit.parameters[0] ==
        doctest::Approx((weight * (line.y - 1.5 * line.x).array()).sum() / weight.sum())
            .epsilon(1e-6));
}

TEST_CASE("Levenberg-Marquardt: wide bounds do not end the search early") {
  constexpr double error = 1e-4, tolerance = 1e-3;
  const VectorXd x = VectorXd::LinSpaced(20, 0, 3), truth{{2, 0.8}};
  auto problem = decay(x, truth[0] * (-truth[1] * x.array()).exp(), error);
  problem.upper *= 1000;
  const auto fit = levenberg_marquardt(problem, VectorXd{{1, 0.2}}, most_iterations, tolerance);
  REQUIRE(fit.converged);
  const VectorXd errors = information(problem, fit.jacobian).errors();
  CHECK((fit.parameters - truth).cwiseQuotient(errors).cwiseAbs().maxCoeff() < 0.1);
}

TEST_CASE("Levenberg-Marquardt: normalised residuals of an exponential fit are standard normal") {
  constexpr double error = 0.01;
  constexpr int runs = 400;
  const VectorXd x = VectorXd::LinSpaced(20, 0, 3), truth{{2, 0.8}};
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, error);
  VectorXd sum = VectorXd::Zero(2), squares = VectorXd::Zero(2);
  for (int run = 0; run < runs; ++run) {
    VectorXd y = truth[0] * (-truth[1] * x.array()).exp();
    for (double& value : y) value += noise(random);
    const auto problem = decay(x, y, error);
    const auto fit = best_fit(problem, {VectorXd{{0.5, 3}}, VectorXd{{5, 0.1}}});
    REQUIRE(fit.converged);
    const VectorXd normalised =
        (fit.parameters - truth).cwiseQuotient(information(problem, fit.jacobian).errors());
    sum += normalised;
    squares += normalised.cwiseAbs2();
  }
  for (int i = 0; i < 2; ++i) {
    CHECK(std::abs(sum[i] / runs) < 4 / std::sqrt(runs));
    CHECK(std::abs(squares[i] / runs - 1) < 4 * std::sqrt(2.0 / runs));
  }
}

TEST_CASE("fit information: inseparable parameters have infinite condition and a named direction") {
  const BoundedLeastSquares sum_alone{[](const VectorXd& p) {
                                        return VectorXd{{p[0] + p[1] - 1, 0}};
                                      },
                                      [](const VectorXd&, const VectorXd&) {
                                        return MatrixXd{{1, 1}, {0, 0}};
                                      },
                                      VectorXd{{0, 0}}, VectorXd{{1, 1}}};
  const auto fit = levenberg_marquardt(sum_alone, VectorXd{{0.9, 0.8}});
  CHECK(fit.chi_squared() < 1e-6);
  const auto known = information(sum_alone, fit.jacobian);
  CHECK(std::isinf(known.condition));
  CHECK(known.covariance(0, 0) > 1e6);
  CHECK(known.best[0] == doctest::Approx(known.best[1]));
  CHECK(known.worst[0] == doctest::Approx(-known.worst[1]));
}

TEST_CASE("derivative check: a Jacobian wrong by 1 % is detected by differences") {
  const VectorXd x{{0, 0.5, 1, 2, 4}};
  const VectorXd y = 3 * (-0.7 * x.array()).exp();
  for (const double factor : {1.0, 1.01}) {
    auto problem = decay(x, y, 0.01);
    problem.lower = VectorXd{{0.1, 0.1}}, problem.upper = VectorXd{{10, 2}};
    problem.jacobian = [own = problem.jacobian, factor](const VectorXd& p, const VectorXd& r) {
      return MatrixXd(factor * own(p, r));
    };
    const auto fit = levenberg_marquardt(problem, VectorXd{{2, 1}});
    const auto found = check_derivative(problem, fit);
    REQUIRE(found.has_value());
    CHECK(found->limit < 0.01);
    CHECK((found->off < found->limit) == (factor == 1));
  }
  Line line;
  const auto at_bound = line.problem(VectorXd{{5, 3}}, VectorXd{{9, 5}});
  CHECK_FALSE(
      check_derivative(at_bound, levenberg_marquardt(at_bound, VectorXd{{6, 4}})).has_value());
}

TEST_CASE("profile of chi^2: two standard errors where it is quadratic") {
  const Line line;
  const auto problem = line.problem(VectorXd{{-10, -10}}, VectorXd{{10, 10}});
  const auto fit = levenberg_marquardt(problem, VectorXd{{5, -3}}, most_iterations, precise);
  const VectorXd error = information(problem, fit.jacobian).errors();
  for (const Eigen::Index i : {0, 1})
    for (const double side : {-1.0, 1.0})
      CHECK(profile_end(problem, fit, i, side, 4)[i] ==
            doctest::Approx(fit.parameters[i] + 2 * side * error[i]).epsilon(1e-9));
}

TEST_CASE("profile of chi^2: ends where it is not quadratic agree with the closed form") {
  // chi^2 = (exp(a) - 1 + b)^2 + 100 b^2 has the least value 100/101 (exp(a) - 1)^2 for given a
  const auto grown = [](const VectorXd& p) -> VectorXd {
    return VectorXd{{std::exp(p[0]) - 1 + p[1], 10 * p[1]}};
  };
  const BoundedLeastSquares problem{grown,
                                    [](const VectorXd& p, const VectorXd&) {
                                      return MatrixXd{{std::exp(p[0]), 1}, {0, 10}};
                                    },
                                    VectorXd{{-3, -5}}, VectorXd{{8, 5}}};
  const auto fit = levenberg_marquardt(problem, VectorXd{{1, 1}}, most_iterations, precise);
  REQUIRE(fit.converged);
  const auto end = [&](double side, double rise) {
    return profile_end(problem, fit, 0, side, rise);
  };
  CHECK(end(1, 4)[0] == doctest::Approx(std::log(1 + 2 * std::sqrt(1.01))).epsilon(0.03));
  CHECK(end(1, 4)[1] == doctest::Approx(-2 * std::sqrt(1.01) / 101).epsilon(0.1));
  CHECK(end(-1, 0.64)[0] == doctest::Approx(std::log(1 - 0.8 * std::sqrt(1.01))).epsilon(0.1));
  CHECK(end(-1, 4)[0] == -3);  // chi^2 never rises by 4
}

}  // namespace flatspeckle::mc::test_levenberg_marquardt
