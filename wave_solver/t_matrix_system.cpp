#include "wave_solver/t_matrix_system.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "core/bessel.h"
#include "core/error.h"
#include "core/memory.h"
#include "wave_solver/basis_order.h"

namespace flatspeckle::wave {

namespace {

std::vector<ExtendedComplex> square_roots(std::vector<ExtendedComplex> values) {
  for (auto& value : values) value = std::sqrt(value);
  return values;
}

// e^{i arg d} of C2, where arg is measured from z towards x.
ExtendedComplex phasor_of(Vec2 d) {
  const long double x = d.x, z = d.z, r = std::sqrt(x * x + z * z);
  return {z / r, x / r};
}

// H_n(k|d|) e^{i n arg d} for n = -order .. order.
std::vector<ExtendedComplex> outgoing_waves(double k, Vec2 d, int order) {
  std::vector<ExtendedComplex> radial(order + 1), waves(2 * order + 1);
  hankel(k * length(d), radial);
  const ExtendedComplex turn = phasor_of(d);
  ExtendedComplex phase = 1;
  for (int n = 0; n <= order; ++n) {
    waves[order + n] = product(radial[n], phase);
    const ExtendedComplex reversed = product(radial[n], std::conj(phase));
    waves[order - n] = n % 2 == 0 ? reversed : -reversed;
    phase = product(phase, turn);
  }
  return waves;
}

// Tile by tile, so that reads and writes stay in cache.
void mirror_lower_triangle(std::vector<Complex>& matrix, std::size_t size) {
  constexpr std::size_t tile = 32;
  for (std::size_t column0 = 0; column0 < size; column0 += tile)
    for (std::size_t row0 = column0; row0 < size; row0 += tile)
      for (std::size_t column = column0; column < std::min(column0 + tile, size); ++column)
        for (std::size_t row = std::max(row0, column + 1); row < std::min(row0 + tile, size); ++row)
          matrix[row * size + column] = matrix[column * size + row];
}

void require_memory(std::size_t unknowns) {
  const double bytes =
      sizeof(Complex) * static_cast<double>(unknowns) * static_cast<double>(unknowns);
  const double physical = physical_memory();
  if (bytes < 0.9 * physical) return;
  throw InputError("unknowns", unknowns,
                   "the dense matrix needs " + std::to_string(static_cast<long long>(bytes)) +
                       " bytes, this machine has " +
                       std::to_string(static_cast<long long>(physical)) +
                       "; take fewer scatterers, wider gaps or a larger tolerance");
}

}  // namespace

// Where a block of the matrix is written: column-major.
struct TMatrixSystem::Block {
  Complex* data;
  std::size_t rows;  // of the matrix that holds it
};

TMatrixSystem::TMatrixSystem(Placement placement, double k, double tolerance,
                             std::span<const Vec2> sensors)
    : placement_(std::move(placement)), k_(k), first_{0} {
  for (const auto& t : basis(placement_, k, tolerance, sensors)) {
    const int order = static_cast<int>(t.size()) - 1;
    order_.push_back(order);
    tau_.push_back(square_roots(t));
    first_.push_back(first_.back() + 2 * order + 1);
    points_only_ = points_only_ && order == 0;
  }
}

std::vector<Complex> TMatrixSystem::matrix() const {
  require_memory(unknowns());
  if (points_only_) return point_matrix();
  const std::size_t size = unknowns();
  std::vector<Complex> matrix(size * size);
  for (std::size_t l = 0; l < placement_.size(); ++l)
    for (std::size_t j = l + 1; j < placement_.size(); ++j)
      pair_blocks(j, l, {&matrix[first_[l] * size + first_[j]], size},
                  {&matrix[first_[j] * size + first_[l]], size});
  for (std::size_t i = 0; i < size; ++i) matrix[i * (size + 1)] = 1;
  return matrix;
}

// Order 0 everywhere: double precision is enough and the matrix is symmetric as it stands.
std::vector<Complex> TMatrixSystem::point_matrix() const {
  const std::size_t size = unknowns();
  std::vector<Complex> matrix(size * size), tau(size);
  for (std::size_t j = 0; j < size; ++j) tau[j] = Complex(tau_[j][0]);
  for (std::size_t l = 0; l < size; ++l) {
    matrix[l * (size + 1)] = 1;
    for (std::size_t j = l + 1; j < size; ++j) {
      const Vec2 d = placement_[j].position - placement_[l].position;
      matrix[l * size + j] = -tau[j] * tau[l] * hankel0(k_ * std::sqrt(dot(d, d)));
    }
  }
  mirror_lower_triangle(matrix, size);
  return matrix;
}

// S(r_j - r_l) and S(r_l - r_j) share their elements: (l row -n, column -p) = (-1)^{n-p} (j row p,
// column n), the symmetry of C10.
void TMatrixSystem::pair_blocks(std::size_t j, std::size_t l, Block to_j, Block to_l) const {
  const int order_j = order_[j], order_l = order_[l], order = order_j + order_l;
  const Vec2 d = placement_[j].position - placement_[l].position;
  const auto waves = outgoing_waves(k_, d, order);
  if (!std::isfinite(std::abs(waves.back())))
    throw InputError("radius", placement_[j].scatterer.radius,
                     "two disks are so close at this wavelength that their translation leaves the "
                     "range of numbers; widen the gap");
  for (int n = -order_l; n <= order_l; ++n) {
    const ExtendedComplex tau_n = tau_[l][std::abs(n)];
    for (int p = -order_j; p <= order_j; ++p) {
      const Complex element(-product(product(tau_[j][std::abs(p)], waves[order + n - p]), tau_n));
      to_j.data[(n + order_l) * to_j.rows + (p + order_j)] = element;
      to_l.data[(order_j - p) * to_l.rows + (order_l - n)] = (n - p) % 2 == 0 ? element : -element;
    }
  }
}

std::vector<Complex> TMatrixSystem::apply(std::span<const Complex> x) const {
  std::vector<Complex> y(x.begin(), x.end()), to_j, to_l;
  const auto add = [&](const std::vector<Complex>& block, std::size_t row, std::size_t column) {
    const std::size_t rows = 2 * order_[row] + 1, columns = 2 * order_[column] + 1;
    for (std::size_t start = 0; start < x.size(); start += unknowns())
      for (std::size_t n = 0; n < columns; ++n)
        for (std::size_t p = 0; p < rows; ++p)
          y[start + first_[row] + p] += block[n * rows + p] * x[start + first_[column] + n];
  };
  for (std::size_t l = 0; l < placement_.size(); ++l)
    for (std::size_t j = l + 1; j < placement_.size(); ++j) {
      const std::size_t rows_j = 2 * order_[j] + 1, rows_l = 2 * order_[l] + 1;
      to_j.resize(rows_j * rows_l);
      to_l.resize(rows_j * rows_l);
      pair_blocks(j, l, {to_j.data(), rows_j}, {to_l.data(), rows_l});
      add(to_j, j, l);
      add(to_l, l, j);
    }
  return y;
}

// tau_n i^n e^{-i n angle} e^{i k w(angle).r_j}
void TMatrixSystem::plane_wave(double angle, std::span<Complex> column) const {
  const Vec2 w = direction(angle);
  const ExtendedComplex turn(w.x, w.z);  // i e^{-i angle}
  for (std::size_t j = 0; j < placement_.size(); ++j) {
    ExtendedComplex up(std::polar(1.0, k_ * dot(w, placement_[j].position))), down = up;
    for (int n = 0; n <= order_[j]; ++n) {
      const std::size_t centre = first_[j] + order_[j];
      column[centre + n] = Complex(product(tau_[j][n], up));
      column[centre - n] = Complex(product(tau_[j][n], down));
      up = product(up, turn);
      down = product(down, std::conj(turn));
    }
  }
}

std::vector<Complex> TMatrixSystem::right_sides(std::span<const double> light_angles) const {
  std::vector<Complex> sides(light_angles.size() * unknowns());
  for (std::size_t light = 0; light < light_angles.size(); ++light)
    plane_wave(light_angles[light], std::span(sides).subspan(light * unknowns(), unknowns()));
  return sides;
}

// By reciprocity the view at theta receives order n as the light from theta + pi sends order -n,
// times
// (-1)^n.
std::vector<Complex> TMatrixSystem::far_row(double view_angle) const {
  std::vector<Complex> sent(unknowns()), row(unknowns());
  plane_wave(view_angle + std::numbers::pi, sent);
  const Complex unit = std::polar(std::sqrt(2 / (std::numbers::pi * k_)), -std::numbers::pi / 4);
  for (std::size_t j = 0; j < placement_.size(); ++j) {
    const std::size_t centre = first_[j] + order_[j];
    for (int n = -order_[j]; n <= order_[j]; ++n)
      row[centre + n] = (n % 2 == 0 ? unit : -unit) * sent[centre - n];
  }
  return row;
}

std::vector<Complex> TMatrixSystem::near_row(Vec2 point) const {
  std::vector<Complex> row(unknowns());
  for (std::size_t j = 0; j < placement_.size(); ++j) {
    const Vec2 d = point - placement_[j].position;
    const bool disk = placement_[j].scatterer.is_disk();
    if (disk ? length(d) < placement_[j].scatterer.radius : length(d) == 0)
      throw InputError("near_sensors",
                       "(" + std::to_string(point.x) + ", " + std::to_string(point.z) + ")",
                       "must lie outside every scatterer");
    const auto waves = outgoing_waves(k_, d, order_[j]);
    for (int n = -order_[j]; n <= order_[j]; ++n)
      row[first_[j] + order_[j] + n] = Complex(product(tau_[j][std::abs(n)], waves[order_[j] + n]));
  }
  return row;
}

// d/ds H_n e^{i n phi} = (k/2) [H_{n-1} e^{i(n-1)phi} e^{i alpha} - H_{n+1} e^{i(n+1)phi} e^{-i
// alpha}] along the direction of angle alpha.
TMatrixSystem::Outgoing TMatrixSystem::outgoing(std::size_t scatterer, Vec2 point,
                                                Vec2 along) const {
  const int order = order_[scatterer];
  const auto waves = outgoing_waves(k_, point - placement_[scatterer].position, order + 1);
  const ExtendedComplex turn = phasor_of(along);
  Outgoing result;
  for (int n = -order; n <= order; ++n) {
    const auto* wave = &waves[order + 1 + n];
    const ExtendedComplex tau = tau_[scatterer][std::abs(n)];
    const ExtendedComplex slope = product(wave[-1], turn) - product(wave[1], std::conj(turn));
    result.field.push_back(Complex(product(tau, *wave)));
    result.derivative.push_back(Complex(product(tau, slope) * 0.5L));
  }
  return result;
}

}  // namespace flatspeckle::wave
