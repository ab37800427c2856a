#include "wave_solver/dense_solver.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>
#include <utility>

#include <cblas.h>

#define lapack_complex_double std::complex<double>
#define lapack_complex_float std::complex<float>
#include <lapacke.h>

#include "wave_solver/boundary_residual.h"

namespace flatspeckle::wave {

namespace {

struct DenseResult {
  std::vector<Complex> x;
  double condition;
};

double condition_number(const std::vector<Complex>& factors, lapack_int n, double norm) {
  double reciprocal = 0;
  LAPACKE_zgecon(LAPACK_COL_MAJOR, '1', n, factors.data(), n, norm, &reciprocal);
  return 1 / std::max(reciprocal, std::numeric_limits<double>::min());
}

// Solves in place of `x`, columns right sides.
DenseResult solve_dense(std::vector<Complex> matrix, std::vector<Complex> x, std::size_t unknowns,
                        bool want_condition) {
  // Placements are solved side by side: threads inside BLAS would only compete with them.
  static const bool single_threaded = (openblas_set_num_threads(1), true);
  static_cast<void>(single_threaded);
  if (x.empty() || unknowns == 0) return {std::move(x), 1};
  const auto n = static_cast<lapack_int>(unknowns);
  const auto columns = static_cast<lapack_int>(x.size() / unknowns);
  const double norm =
      want_condition ? LAPACKE_zlange(LAPACK_COL_MAJOR, '1', n, n, matrix.data(), n) : 0;
  std::vector<lapack_int> pivots(unknowns);
  if (LAPACKE_zgetrf(LAPACK_COL_MAJOR, n, n, matrix.data(), n, pivots.data()) != 0)
    throw std::runtime_error("the multiple-scattering equations are singular or not finite");
  LAPACKE_zgetrs(LAPACK_COL_MAJOR, 'N', n, columns, matrix.data(), n, pivots.data(), x.data(), n);
  return {std::move(x), want_condition ? condition_number(matrix, n, norm) : -1};
}

void require_finite(std::span<const Complex> values) {
  for (const Complex& value : values)
    if (!std::isfinite(value.real()) || !std::isfinite(value.imag()))
      throw std::runtime_error("the multiple-scattering equations have no finite solution");
}

// Rows of the scaled equations times tau are those of the unscaled ones.
double unscaled_residual(const TMatrixSystem& system, std::span<const Complex> sides,
                         std::span<const Complex> x) {
  const auto product = system.apply(x);
  double left = 0, given = 0;
  std::size_t i = 0;
  while (i < x.size())
    for (std::size_t j = 0; j < system.placement().size(); ++j) {
      const int order = system.order(j);
      for (int n = -order; n <= order; ++n, ++i) {
        const double weight = static_cast<double>(std::norm(system.tau(j)[std::abs(n)]));
        left += weight * std::norm(sides[i] - product[i]);
        given += weight * std::norm(sides[i]);
      }
    }
  return given > 0 ? std::sqrt(left / given) : 0;
}

Complex received(std::span<const Complex> row, std::span<const Complex> column) {
  double re = 0, im = 0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    re += row[i].real() * column[i].real() - row[i].imag() * column[i].imag();
    im += row[i].real() * column[i].imag() + row[i].imag() * column[i].real();
  }
  const Complex field(re, im);
  require_finite({&field, 1});
  return field;
}

}  // namespace

WaveSolution::WaveSolution(TMatrixSystem system, std::vector<double> light_angles,
                           std::vector<Complex> coefficients)
    : system_(std::move(system)),
      light_angles_(std::move(light_angles)),
      coefficients_(std::move(coefficients)) {
  require_finite(coefficients_);
}

std::vector<int> WaveSolution::basis_order() const {
  std::vector<int> orders(system_.placement().size());
  for (std::size_t j = 0; j < orders.size(); ++j) orders[j] = system_.order(j);
  return orders;
}

std::span<const Complex> WaveSolution::coefficients(std::size_t light) const {
  return std::span(coefficients_).subspan(light * system_.unknowns(), system_.unknowns());
}

Complex WaveSolution::far_field(double view_angle, std::size_t light) const {
  return received(system_.far_row(view_angle), coefficients(light));
}

Complex WaveSolution::near_field(Vec2 point, std::size_t light) const {
  return received(system_.near_row(point), coefficients(light));
}

std::vector<Complex> WaveSolution::fields(std::span<const View> views) const {
  std::vector<Complex> fields(light_angles_.size() * views.size());
  for (std::size_t view = 0; view < views.size(); ++view) {
    const auto row =
        views[view].near ? system_.near_row(views[view].point) : system_.far_row(views[view].angle);
    for (std::size_t light = 0; light < light_angles_.size(); ++light)
      fields[light * views.size() + view] = received(row, coefficients(light));
  }
  return fields;
}

WaveSolution solve(const Placement& placement, double k, const std::vector<double>& light_angles,
                   const SolveOptions& options) {
  check_no_overlap(placement);
  TMatrixSystem system(placement, k, options.tolerance, options.sensors);
  const auto sides = system.right_sides(light_angles);
  DenseResult result = solve_dense(system.matrix(), sides, system.unknowns(), options.diagnose);
  WaveSolution solution(std::move(system), light_angles, std::move(result.x));
  if (options.diagnose)
    solution.diagnosis_ = {unscaled_residual(solution.system_, sides, solution.coefficients_),
                           result.condition, boundary_residual(solution)};
  return solution;
}

}  // namespace flatspeckle::wave
