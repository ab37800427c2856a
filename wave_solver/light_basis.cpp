#include "wave_solver/light_basis.h"

#include <algorithm>
#include <cmath>

#include "core/bessel.h"
#include "wave_solver/blas.h"

namespace flatspeckle::wave {

namespace {

constexpr std::size_t few = 8;  // fewer lights are not worth the trouble

// The largest |J_n| within the circle, n = 0, 1, .. until it is negligible.
std::vector<double> wave_sizes(double x, double tolerance) {
  std::vector<double> sizes;
  const int start = static_cast<int>(std::ceil(x));
  const int reach = start + 40 + static_cast<int>(10 * std::cbrt(x));
  const auto j = bessel_j(reach, x);
  for (int n = 0; n <= reach; ++n) {
    sizes.push_back(n <= start ? 1 : static_cast<double>(std::abs(j[n])));
    if (n > start && sizes.back() < tolerance / 100) break;
  }
  return sizes;
}

// Column-major: rows n = -M .. M of size_n i^n e^{-i n angle}, columns lights.
std::vector<Complex> coefficients(std::span<const double> angles,
                                  const std::vector<double>& sizes) {
  const int most = static_cast<int>(sizes.size()) - 1;
  std::vector<Complex> matrix;
  for (double angle : angles)
    for (int n = -most; n <= most; ++n)
      matrix.push_back(std::polar(sizes[std::abs(n)], n * (std::acos(0.0) - angle)));
  return matrix;
}

}  // namespace

Circle enclosing_circle(const Placement& placement) {
  if (placement.empty()) return {};
  Vec2 low = placement[0].position, high = low;
  for (const auto& [r, scatterer] : placement) {
    low = {std::min(low.x, r.x), std::min(low.z, r.z)};
    high = {std::max(high.x, r.x), std::max(high.z, r.z)};
  }
  Circle circle{0.5 * (low + high), 0};
  for (const auto& [r, scatterer] : placement)
    circle.radius = std::max(circle.radius, length(r - circle.centre) + scatterer.disk_radius());
  return circle;
}

LightBasis light_basis(std::span<const double> angles, double k, const Circle& circle,
                       double tolerance) {
  const LightBasis all{{angles.begin(), angles.end()}, {}};
  const std::size_t lights = angles.size();
  if (lights <= few) return all;
  const auto sizes = wave_sizes(std::max(k * circle.radius, 1e-6), tolerance);
  auto matrix = coefficients(angles, sizes);
  const auto rows = static_cast<lapack_int>(matrix.size() / lights),
             columns = static_cast<lapack_int>(lights);
  std::vector<lapack_int> pivots(lights);
  std::vector<Complex> reflectors(lights);
  LAPACKE_zgeqp3(LAPACK_COL_MAJOR, rows, columns, matrix.data(), rows, pivots.data(),
                 reflectors.data());
  const auto diagonal = [&](lapack_int i) { return std::abs(matrix[i * (rows + 1)]); };
  lapack_int rank = 0;
  while (rank < std::min(rows, columns) && diagonal(rank) > tolerance) ++rank;
  if (4 * rank > 3 * columns) return all;
  // The columns left out are R11^-1 R12 of those kept.
  const Complex one = 1;
  cblas_ztrsm(CblasColMajor, CblasLeft, CblasUpper, CblasNoTrans, CblasNonUnit, rank,
              columns - rank, &one, matrix.data(), rows, &matrix[rank * rows], rows);
  LightBasis basis;
  basis.weights.resize(lights * rank);
  const auto phase = [&](std::size_t light) {
    return std::polar(1.0, k * dot(direction(angles[light]), circle.centre));
  };
  for (lapack_int i = 0; i < columns; ++i) {
    const std::size_t light = pivots[i] - 1;
    if (i < rank) basis.angles.push_back(angles[light]);
    for (lapack_int j = 0; j < rank; ++j) {
      const Complex weight = i < rank ? Complex(i == j) : matrix[i * rows + j];
      basis.weights[light * rank + j] = weight * phase(light) * std::conj(phase(pivots[j] - 1));
    }
  }
  return basis;
}

}  // namespace flatspeckle::wave
