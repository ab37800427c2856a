#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/hankel_array.h"
#include "wave_solver/graded/graded_fields.h"

namespace flatspeckle::wave::test_graded_green {

namespace {

constexpr double k = 2 * std::numbers::pi;

IndexField linear(Vec gradient) {
  IndexField field;
  field.kind = IndexField::Kind::linear;
  field.gradient = gradient;
  return field;
}

IndexField parabolic(double alpha) {
  IndexField field;
  field.kind = IndexField::Kind::parabolic;
  field.alpha = alpha;
  return field;
}

Complex free_wave(double r) {
  Complex h;
  const double x = k * r;
  hankel0({&x, 1}, {&h, 1});
  return Complex(0, 0.25) * h;
}

/// Returns (laplacian + k^2 n^2) G at q over |k^2 n^2 G|, by finite differences of sixth order.
double residual(const IndexField& field, Vec p, Vec q, double step) {
  const GradedGreen green(field, k, 40);
  const double weight[] = {-49.0 / 18, 1.5, -0.15, 1.0 / 90};
  Complex sum = 2 * weight[0] * green(p, q);
  for (int j = 1; j <= 3; ++j)
    for (const Vec axis : {Vec{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      sum += weight[j] * green(p, q + j * step * axis);
  const Complex own = k * k * field.square(q) * green(p, q);
  return std::abs(sum / (step * step) + own) / std::abs(own);
}

}  // namespace

TEST_CASE("graded Green function: agrees with H_0 without or with a negligible gradient") {
  for (const IndexField& field : {linear({0, 0}), linear({0, 1e-9}), parabolic(1e-7)}) {
    const GradedGreen green(field, k, 40);
    for (const double r : {1e-6, 1e-3, 0.1, 1.0, 7.3, 39.0}) {
      const Complex expected = free_wave(r), found = green({0, 0}, {0.6 * r, 0.8 * r});
      CAPTURE(r);
      CHECK(std::abs(found - expected) < 5e-6 * std::abs(expected));
      if (field.gradient == Vec{} && field.alpha == 0)
        CHECK(std::abs(found - expected) < 3e-13 * std::abs(expected));
    }
  }
}

TEST_CASE(
    "graded Green function: satisfies the wave equation by finite differences of sixth order") {
  const struct {
    IndexField field;
    Vec p, q;
  } cases[] = {{linear({0, 0.05}), {0, -4}, {3, 7}},      {linear({0, 0.05}), {9, 8}, {-9, 1}},
               {linear({0.03, -0.02}), {1, 2}, {4, 2.5}}, {linear({0, 0.05}), {0, 0}, {0.1, 0.2}},
               {parabolic(0.06), {0, -4}, {3, 7}},        {parabolic(0.06), {4, 1}, {-4, 3}},
               {parabolic(0.1), {2, 1}, {2.2, 1.1}}};
  for (const auto& row : cases) {
    const auto& [field, p, q] = row;
    const double coarse = residual(field, p, q, 0.02), fine = residual(field, p, q, 0.01);
    CAPTURE(row.field.describe());
    CAPTURE(row.q.x);
    CHECK(coarse < 2e-5);
    CHECK(fine < coarse / 20);  // error of the differences, not of the function
  }
}

TEST_CASE("graded Green function: is reciprocal") {
  const Vec p{1, -3}, q{-4, 9};
  for (const IndexField& field : {linear({0.02, 0.04}), parabolic(0.07)}) {
    const GradedGreen green(field, k, 40);
    CHECK(std::abs(green(p, q) - green(q, p)) < 1e-13 * std::abs(green(p, q)));
  }
}

TEST_CASE("graded Green function: rejected if the ray turns back before it arrives") {
  const GradedGreen green(linear({0, -0.05}), k, 60);
  CHECK_THROWS_AS(green({-30, 9}, {30, 9}), InputError);
  const GradedGreen guide(parabolic(0.1), k, 60);
  CHECK_THROWS_AS(guide({0, 0}, {0, 40}), InputError);
}

TEST_CASE("graded Green function: other fields are rejected") {
  IndexField field;
  field.kind = IndexField::Kind::blobs;
  CHECK_THROWS_AS(GradedGreen(field, k, 10), InputError);
}

}  // namespace flatspeckle::wave::test_graded_green
