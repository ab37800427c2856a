#include "bench/oracles/slab_theory.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "core/numbers/blas.h"

namespace flatspeckle::oracles {

namespace {

using std::numbers::pi;

/// Returns int_0^x K_0 = pi/2 - int_0^inf exp(-x cosh t)/cosh t dt; the trapezoidal rule converges
/// exponentially.
double integral_of_k0(double x) {
  constexpr double step = 0.05;
  double sum = std::exp(-x) / 2;
  for (int i = 1; i < 800; ++i) {
    const double c = std::cosh(i * step);
    sum += std::exp(-x * c) / c;
  }
  return pi / 2 - step * sum;
}

/// Returns int_from^{from+length} exp(constant + rate z) dz, without overflow if the result is
/// finite.
Complex integral_of_exp(Complex constant, Complex rate, double from, double length) {
  const Complex half = rate * length / 2.0, middle = constant + rate * from + half;
  if (std::abs(half) < 1e-4) return length * std::exp(middle) * (1.0 + half * half / 6.0);
  return length * (std::exp(middle + half) - std::exp(middle - half)) / (2.0 * half);
}

}  // namespace

/// The operator A = albedo int K dz', discretised on the cells, and LU factors of 1 - A.
struct IsotropicSlab::Kernel {
  double q;
  /// Elements of A by the distance of two cells; the matrix is Toeplitz.
  std::vector<double> over_cell;
  std::vector<double> factors;
  std::vector<lapack_int> pivots;

  double element(int i, int j) const { return over_cell[std::abs(i - j)]; }
};

IsotropicSlab::IsotropicSlab(double k, double depth, double mu_t, double albedo, int cells)
    : k_(k), depth_(depth), mu_t_(mu_t), albedo_(albedo), cells_(cells) {
  openblas_set_num_threads(1);  // the matrices are small, and tests run in parallel
}

IsotropicSlab::~IsotropicSlab() = default;

IsotropicSlab::Wave IsotropicSlab::light_wave(double angle) const {
  const double cosine = std::cos(angle);
  return {0, Complex(-mu_t_ / (2 * cosine), k_ * cosine)};
}

IsotropicSlab::Wave IsotropicSlab::view_wave(double angle) const {
  const double cosine = std::cos(angle), rate = mu_t_ / (2 * std::abs(cosine));
  if (cosine > 0) return {-rate * depth_, Complex(rate, -k_ * cosine)};
  return {0, Complex(-rate, -k_ * cosine)};
}

IsotropicSlab::Wave IsotropicSlab::times_conjugate(Wave a, Wave b) {
  return {a.constant + std::conj(b.constant), a.rate + std::conj(b.rate)};
}

Complex IsotropicSlab::mean_over_cell(Wave wave, int cell) const {
  const double h = depth_ / cells_;
  return integral_of_exp(wave.constant, wave.rate, h * cell, h) / h;
}

const IsotropicSlab::Kernel& IsotropicSlab::kernel(double q) const {
  for (const auto& known : kernels_)
    if (std::abs(known->q - q) < 1e-12 * k_) return *known;
  const double rate = std::hypot(mu_t_, q), h = depth_ / cells_;
  std::vector<double> edge(cells_ + 1);  // int_0^{(j + 1/2) h} K_0(rate d) dd
  for (int j = 0; j <= cells_; ++j) edge[j] = integral_of_k0(rate * (j + 0.5) * h) / rate;
  auto kernel = std::make_unique<Kernel>();
  kernel->q = q;
  for (int d = 0; d < cells_; ++d) {
    const double over_cell = d == 0 ? 2 * edge[0] : edge[d] - edge[d - 1];
    kernel->over_cell.push_back(albedo_ * mu_t_ / pi * over_cell);
  }
  for (int i = 0; i < cells_; ++i)
    for (int j = 0; j < cells_; ++j)
      kernel->factors.push_back((i == j ? 1 : 0) - kernel->element(i, j));
  kernel->pivots.resize(cells_);
  LAPACKE_dgetrf(LAPACK_COL_MAJOR, cells_, cells_, kernel->factors.data(), cells_,
                 kernel->pivots.data());
  kernels_.push_back(std::move(kernel));
  return *kernels_.back();
}

std::vector<Complex> IsotropicSlab::multiple_collisions(double q, Wave source) const {
  const Kernel& operators = kernel(q);
  std::vector<double> second(2 * cells_);  // real parts, then imaginary parts
  for (int j = 0; j < cells_; ++j) {
    const Complex first = mu_t_ * mean_over_cell(source, j);
    for (int i = 0; i < cells_; ++i) {
      second[i] += operators.element(i, j) * first.real();
      second[cells_ + i] += operators.element(i, j) * first.imag();
    }
  }
  LAPACKE_dgetrs(LAPACK_COL_MAJOR, 'N', cells_, 2, operators.factors.data(), cells_,
                 operators.pivots.data(), second.data(), cells_);
  std::vector<Complex> collisions(cells_);
  for (int i = 0; i < cells_; ++i) collisions[i] = {second[i], second[cells_ + i]};
  return collisions;
}

Complex IsotropicSlab::chain(double q, Wave source, Wave view) const {
  const auto collisions = multiple_collisions(q, source);
  Complex sum = 0;
  for (int i = 0; i < cells_; ++i) sum += collisions[i] * mean_over_cell(view, i);
  return albedo_ / (2 * pi) * sum * (depth_ / cells_);
}

Complex IsotropicSlab::single(Channel a, Channel b) const {
  const Wave light = times_conjugate(light_wave(a.light), light_wave(b.light));
  const Wave view = times_conjugate(view_wave(a.view), view_wave(b.view));
  return albedo_ * mu_t_ / (2 * pi) *
         integral_of_exp(light.constant + view.constant, light.rate + view.rate, 0, depth_);
}

Complex IsotropicSlab::ladder(Channel a, Channel b) const {
  return chain(k_ * (std::sin(a.light) - std::sin(b.light)),
               times_conjugate(light_wave(a.light), light_wave(b.light)),
               times_conjugate(view_wave(a.view), view_wave(b.view)));
}

Complex IsotropicSlab::crossed(Channel a, Channel b) const {
  return chain(k_ * (std::sin(a.light) + std::sin(b.view)),
               times_conjugate(light_wave(a.light), view_wave(b.view)),
               times_conjugate(view_wave(a.view), light_wave(b.light)));
}

double IsotropicSlab::absorbed(double light) const {
  const Wave source = times_conjugate(light_wave(light), light_wave(light));
  double collisions = mu_t_ * integral_of_exp(0, source.rate, 0, depth_).real();
  for (const Complex c : multiple_collisions(0, source)) collisions += c.real() * depth_ / cells_;
  return (1 - albedo_) * collisions / std::cos(light);
}

}  // namespace flatspeckle::oracles
