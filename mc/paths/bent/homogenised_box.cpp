#include "mc/paths/bent/homogenised_box.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/error.h"
#include "core/numbers/fourier.h"

namespace flatspeckle::mc {

namespace {

constexpr double cells_per_wavelength = 10;

std::size_t cells_along(double extent, double wavelength) {
  constexpr double fewest = 8;
  return static_cast<std::size_t>(
      std::ceil(std::max(fewest, cells_per_wavelength * extent / wavelength)));
}

/// In place, of rows of `wide` values.
void transform(std::vector<Complex>& grid, std::size_t wide, std::size_t high,
               LineTransform::Direction direction) {
  const LineTransform along(wide, direction), across(high, direction);
  for (std::size_t row = 0; row < high; ++row) along(&grid[row * wide]);
  std::vector<Complex> line(high);
  for (std::size_t column = 0; column < wide; ++column) {
    for (std::size_t row = 0; row < high; ++row) line[row] = grid[row * wide + column];
    across(line.data());
    for (std::size_t row = 0; row < high; ++row) grid[row * wide + column] = line[row];
  }
}

Complex hankel_order_0(double x) {
  return {::j0(x), ::y0(x)};
}

/// Dedekind's eta(i y).
double eta(double y) {
  using std::numbers::pi;
  double product = std::exp(-pi * y / 12);
  for (int n = 1; n * y < 7; ++n) product *= -std::expm1(-2 * pi * n * y);
  return product;
}

Complex hermitian_product(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  Complex sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::conj(a[i]) * b[i];
  return sum;
}

double norm_of(const std::vector<Complex>& a) {
  return std::sqrt(hermitian_product(a, a).real());
}

/// BiCGSTAB (van der Vorst 1992) for A x = b from x = b.
template <typename Apply>
std::vector<Complex> solved_by_iteration(const Apply& apply, const std::vector<Complex>& b) {
  constexpr int most_steps = 2000;
  constexpr double tolerance = 1e-6;
  std::vector<Complex> x = b, r = apply(x);
  for (std::size_t i = 0; i < b.size(); ++i) r[i] = b[i] - r[i];
  const std::vector<Complex> shadow = r;
  std::vector<Complex> p = r;
  Complex rho = hermitian_product(shadow, r);
  const double size = norm_of(b);
  for (int step = 0; step < most_steps; ++step) {
    if (norm_of(r) <= tolerance * size) return x;
    const auto v = apply(p);
    const Complex alpha = rho / hermitian_product(shadow, v);
    for (std::size_t i = 0; i < b.size(); ++i) r[i] -= alpha * v[i];
    const auto t = apply(r);
    const Complex omega = hermitian_product(t, r) / hermitian_product(t, t);
    for (std::size_t i = 0; i < b.size(); ++i) {
      x[i] += alpha * p[i] + omega * r[i];
      r[i] -= omega * t[i];
    }
    const Complex next = hermitian_product(shadow, r), beta = next / rho * alpha / omega;
    rho = next;
    for (std::size_t i = 0; i < b.size(); ++i) p[i] = r[i] + beta * (p[i] - omega * v[i]);
  }
  throw std::runtime_error("the mean field of the homogenised box was not found by iteration");
}

}  // namespace

HomogenisedBox::HomogenisedBox(const Domain& box, double k, Complex inside)
    : box_(box), k_(k), contrast_(inside * inside - k * k) {
  constexpr double most_cells = 4e6;
  const double wavelength = 2 * std::numbers::pi / k, per = cells_per_wavelength / wavelength;
  if (box.area() * per * per > most_cells)
    throw InputError("index_field", "mean_field",
                     "takes boxes of up to 40000 square wavelengths; a wider one is a slab");
  columns_ = cells_along(box.width, wavelength);
  rows_ = cells_along(box.depth, wavelength);
  dx_ = box.width / static_cast<double>(columns_);
  dz_ = box.depth / static_cast<double>(rows_);
  wide_ = transform_size(2.0 * static_cast<double>(columns_));
  high_ = transform_size(2.0 * static_cast<double>(rows_));
  find_spectrum();
}

Vec2 HomogenisedBox::centre(std::size_t column, std::size_t row) const {
  return {-box_.width / 2 + (static_cast<double>(column) + 0.5) * dx_,
          (static_cast<double>(row) + 0.5) * dz_};
}

/// Midpoint rule on a lattice. The cell of the logarithm itself counts
/// ln(dx / (2 pi eta(i dz/dx)^2)) (Kronecker's limit; Duan and Rokhlin 2009 for squares).
void HomogenisedBox::find_spectrum() {
  using std::numbers::pi;
  const double log_of_cell = std::log(dx_ / (2 * pi * std::pow(eta(dz_ / dx_), 2)));
  const Complex cell(0, dx_ * dz_ / 4),
      own = cell * Complex(1, 2 / pi * (std::numbers::egamma + std::log(k_ / 2) + log_of_cell));
  spectrum_.assign(wide_ * high_, 0);
  for (std::size_t row = 0; row < high_; ++row)
    for (std::size_t column = 0; column < wide_; ++column) {
      const auto away = [](std::size_t i, std::size_t size) {
        return static_cast<double>(std::min(i, size - i));
      };
      const double r = std::hypot(dx_ * away(column, wide_), dz_ * away(row, high_));
      spectrum_[row * wide_ + column] = r == 0 ? own : cell * hankel_order_0(k_ * r);
    }
  transform(spectrum_, wide_, high_, LineTransform::Direction::forward);
  for (Complex& value : spectrum_) value /= static_cast<double>(wide_ * high_);
}

/// (1 - contrast G) field
std::vector<Complex> HomogenisedBox::applied(const std::vector<Complex>& field) const {
  std::vector<Complex> grid(wide_ * high_);
  for (std::size_t row = 0; row < rows_; ++row)
    std::copy_n(&field[row * columns_], columns_, &grid[row * wide_]);
  transform(grid, wide_, high_, LineTransform::Direction::forward);
  for (std::size_t i = 0; i < grid.size(); ++i) grid[i] = product(grid[i], spectrum_[i]);
  transform(grid, wide_, high_, LineTransform::Direction::backward);
  std::vector<Complex> result(field.size());
  for (std::size_t row = 0; row < rows_; ++row)
    for (std::size_t column = 0; column < columns_; ++column)
      result[row * columns_ + column] =
          field[row * columns_ + column] - contrast_ * grid[row * wide_ + column];
  return result;
}

std::vector<Complex> HomogenisedBox::field(double angle) const {
  const Vec2 w = direction(angle);
  std::vector<Complex> incident;
  for (std::size_t row = 0; row < rows_; ++row)
    for (std::size_t column = 0; column < columns_; ++column)
      incident.push_back(std::polar(1.0, k_ * dot(w, centre(column, row))));
  return solved_by_iteration([this](const std::vector<Complex>& x) { return applied(x); },
                             incident);
}

}  // namespace flatspeckle::mc
