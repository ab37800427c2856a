#include "multipole_oracle.h"

#include <cmath>
#include <stdexcept>

#include <boost/math/special_functions/bessel.hpp>

#include "core/numbers/blas.h"

namespace flatspeckle::wave {

namespace {

using Real = long double;
using Wide = std::complex<Real>;

// Z_n and Z_n' of the four kinds that are needed, for all n.
Real sign(int n) {
  return n < 0 && n % 2 != 0 ? -1 : 1;
}
Real j(int n, Real x) {
  return sign(n) * boost::math::cyl_bessel_j(std::abs(n), x);
}
Wide h(int n, Real x) {
  return {j(n, x), sign(n) * boost::math::cyl_neumann(std::abs(n), x)};
}
Real j_slope(int n, Real x) {
  return (j(n - 1, x) - j(n + 1, x)) / 2;
}
Wide h_slope(int n, Real x) {
  return (h(n - 1, x) - h(n + 1, x)) / 2.0L;
}

Wide t_matrix(const Scatterer& disk, Real x, int n) {
  if (disk.kind == Scatterer::Kind::soft) return -j(n, x) / h(n, x);
  if (disk.kind == Scatterer::Kind::hard) return -j_slope(n, x) / h_slope(n, x);
  const Real m = disk.index.real(), q = disk.kind == Scatterer::Kind::tm ? m : 1 / m;
  const Real inside = j(n, m * x), slope = q * j_slope(n, m * x);
  return -(slope * j(n, x) - inside * j_slope(n, x)) / (slope * h(n, x) - inside * h_slope(n, x));
}

// e^{i n phi} with the angle of d measured as in C2.
Complex turn(int n, Vec2 d) {
  return std::polar(1.0, n * std::atan2(d.x, d.z));
}

/// right becomes the solution.
void solve(std::vector<Complex>& matrix, std::vector<Complex>& right) {
  const auto size = static_cast<lapack_int>(right.size());
  std::vector<lapack_int> pivots(right.size());
  if (LAPACKE_zgesv(LAPACK_COL_MAJOR, size, 1, matrix.data(), size, pivots.data(), right.data(),
                    size) != 0)
    throw std::runtime_error("multipole oracle: singular");
}

}  // namespace

MultipoleOracle::MultipoleOracle(const Placement& placement, double k, double light,
                                 std::vector<int> orders)
    : placement_(placement), k_(k), light_(light), orders_(std::move(orders)) {
  const std::size_t size = first(placement.size());
  std::vector<Complex> matrix(size * size);  // column by column
  on_rim_.resize(size);
  for (std::size_t to = 0; to < placement.size(); ++to)
    for (std::size_t from = 0; from < placement.size(); ++from)
      to == from ? own_block(to, matrix) : block(to, from, matrix);
  solve(matrix, on_rim_);
}

/// And the right side.
void MultipoleOracle::own_block(std::size_t disk, std::vector<Complex>& matrix) {
  const auto& [centre, scatterer] = placement_[disk];
  const Real x = k_ * scatterer.radius;
  const Complex phase = std::polar(1.0, k_ * dot(direction(light_), centre));
  for (int n = -orders_[disk]; n <= orders_[disk]; ++n) {
    const std::size_t row = place(disk, n);
    const Real own = j(n, x);
    on_rim_[row] = static_cast<double>(own) * phase * std::polar(1.0, n * (two_pi / 4 - light_));
    matrix[row + on_rim_.size() * row] = Complex(own / (t_matrix(scatterer, x, n) * h(n, x)));
  }
}

void MultipoleOracle::block(std::size_t to, std::size_t from, std::vector<Complex>& matrix) const {
  const Vec2 d = placement_[to].position - placement_[from].position;
  const Real x_to = k_ * placement_[to].scatterer.radius,
             x_from = k_ * placement_[from].scatterer.radius;
  const int p_last = orders_[to], n_last = orders_[from], last = p_last + n_last;
  std::vector<Wide> between, sent;
  for (int n = -last; n <= last; ++n) between.push_back(h(n, k_ * length(d)) * Wide(turn(n, d)));
  for (int n = -n_last; n <= n_last; ++n) sent.push_back(h(n, x_from));
  for (int p = -p_last; p <= p_last; ++p) {
    const Real received = j(p, x_to);
    for (int n = -n_last; n <= n_last; ++n)
      matrix[place(to, p) + on_rim_.size() * place(from, n)] =
          Complex(-received * between[n - p + last] / sent[n + n_last]);
  }
}

std::size_t MultipoleOracle::first(std::size_t disk) const {
  std::size_t unknowns = 0;
  for (std::size_t i = 0; i < disk; ++i) unknowns += 2 * static_cast<std::size_t>(orders_[i]) + 1;
  return unknowns;
}

Complex MultipoleOracle::inside(std::size_t disk, Vec2 point) const {
  const auto& [centre, scatterer] = placement_[disk];
  const Real x = k_ * scatterer.radius, m = scatterer.index.real();
  const Vec2 d = point - centre;
  Complex sum = 0;
  for (int n = -orders_[disk]; n <= orders_[disk]; ++n) {
    // on the rim b H (1 + J / (T H)): scattered and incident
    const Wide rim = 1.0L + j(n, x) / (t_matrix(scatterer, x, n) * h(n, x));
    const Real radial = j(n, m * k_ * length(d)) / j(n, m * x);
    sum += on_rim_[place(disk, n)] * Complex(rim * radial) * turn(n, d);
  }
  return sum;
}

Complex MultipoleOracle::outside(Vec2 point) const {
  Complex sum = std::polar(1.0, k_ * dot(direction(light_), point));
  for (std::size_t disk = 0; disk < placement_.size(); ++disk) {
    const Vec2 d = point - placement_[disk].position;
    for (int n = -orders_[disk]; n <= orders_[disk]; ++n) {
      const Real x = k_ * placement_[disk].scatterer.radius;
      sum += on_rim_[place(disk, n)] * Complex(h(n, k_ * length(d)) / h(n, x)) * turn(n, d);
    }
  }
  return sum;
}

}  // namespace flatspeckle::wave
