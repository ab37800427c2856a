#include <cmath>

#include <boost/math/quadrature/gauss.hpp>
#include <doctest/doctest.h>

#include "mc/paths/bent/graded_medium.h"
#include "tests/mc/estimates.h"

namespace flatspeckle::mc::test_mean_field {

namespace {

constexpr double k = 2 * std::numbers::pi;
const Domain box{Domain::Kind::box, 2.1, 1.2};

/// Integrates f(u) du from 0 to 1 by Gauss quadrature.
template <typename F>
Complex integral(const F& f) {
  using Rule = boost::math::quadrature::gauss<double, 30>;
  Complex sum = 0;
  for (std::size_t i = 0; i < Rule::abscissa().size(); ++i)
    for (const double node : {Rule::abscissa()[i], -Rule::abscissa()[i]})
      sum += Rule::weights()[i] / 2 * f((1 + node) / 2);
  return sum;
}

/// Returns int (i/4) H_0(k |x - y|) exp(i k w.y) dy over the box, by parts that have x as a corner:
/// there the substitutions u^3 and v^3 remove the logarithm.
Complex scattered_once(Vec x, Vec w) {
  const auto part = [&](Vec size) {
    return std::abs(size.x * size.z) * integral([&](double u) {
             return integral([&](double v) {
               const Vec offset{u * u * u * size.x, v * v * v * size.z};
               const double r = k * length(offset);
               return 9 * u * u * v * v * Complex(0, 0.25) * Complex(::j0(r), ::y0(r)) *
                      std::polar(1.0, k * dot(w, x + offset));
             });
           });
  };
  Complex sum = 0;
  for (const double side : {-box.width / 2, box.width / 2})
    for (const double face : {0.0, box.depth}) sum += part(Vec{side, face} - x);
  return sum;
}

}  // namespace

TEST_CASE("homogenised box: a small index difference adds single scattering, cells of any shape") {
  constexpr double differs = 1e-3, angle = 0.7;
  const HomogenisedBox more(box, k, k * (1 + differs)), less(box, k, k * (1 - differs));
  const auto added = more.field(angle), taken = less.field(angle);
  double largest = 0, worst = 0;
  for (const std::size_t column : {0U, 7U, 15U})
    for (const std::size_t row : {1U, 6U, 11U}) {
      const std::size_t cell = row * more.columns() + column;
      const Complex expected =
          4 * differs * k * k * scattered_once(more.centre(column, row), direction(angle));
      worst = std::max(worst, std::abs(added[cell] - taken[cell] - expected));
      largest = std::max(largest, std::abs(expected));
    }
  CHECK(worst < 0.007 * largest);
}

}  // namespace flatspeckle::mc::test_mean_field
