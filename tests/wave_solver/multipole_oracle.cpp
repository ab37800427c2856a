#include "multipole_oracle.h"

#include <cmath>
#include <stdexcept>

#include "core/numbers/bessel.h"
#include "core/numbers/blas.h"

namespace flatspeckle::wave {

namespace {

/// Cylinder functions Z_n(x) for n = -order .. order, and Z_n' for one order less.
template <class Number>
class Cylinder {
 public:
  explicit Cylinder(std::vector<Number> z) : z_(std::move(z)) {}

  Number operator()(int n) const {
    const Number& value = z_[static_cast<std::size_t>(std::abs(n))];
    return n < 0 && n % 2 != 0 ? -value : value;
  }
  Number derivative(int n) const { return 0.5L * ((*this)(n - 1) + -(*this)(n + 1)); }

 private:
  std::vector<Number> z_;
};
Cylinder<ScaledReal> bessel(int order, double x) {
  return Cylinder(scaled_bessel_j(order + 1, x));
}
Cylinder<ScaledComplex> hankel(int order, double x) {
  return Cylinder(scaled_hankel(order + 1, x));
}

/// Returns e^{i n phi} with the angle of d measured as in C2.
Complex turn(int n, Vec d) {
  return std::polar(1.0, n * std::atan2(d.x, d.z));
}

/// 1/T_n of a disk with k a = x, times J_n / H_n.
class InverseT {
 public:
  InverseT(const Scatterer& disk, double x, int order)
      : kind_(disk.kind),
        q_(kind_ == Scatterer::Kind::tm ? disk.index.real() : 1 / disk.index.real()),
        j_(bessel(order, x)),
        h_(hankel(order, x)),
        inside_(bessel(order, disk.is_penetrable() ? disk.index.real() * x : x)) {}

  ScaledComplex operator()(int n) const {
    const ScaledComplex j_over_h = j_(n) / h_(n);
    if (kind_ == Scatterer::Kind::soft) return -(h_(n) / j_(n)) * j_over_h;
    if (kind_ == Scatterer::Kind::hard) return -(h_.derivative(n) / j_.derivative(n)) * j_over_h;
    const ScaledReal derivative = q_ * inside_.derivative(n);
    return -((derivative * h_(n) + -(inside_(n) * h_.derivative(n))) /
             (derivative * j_(n) + -(inside_(n) * j_.derivative(n)))) *
           j_over_h;
  }

 private:
  Scatterer::Kind kind_;
  long double q_;
  Cylinder<ScaledReal> j_;
  Cylinder<ScaledComplex> h_;
  Cylinder<ScaledReal> inside_;
};

/// Replaces `right` by the solution. Equations are multiplied by phases that make their diagonal
/// large for LAPACK, which measures pivots by |re| + |im|. Otherwise it would reject the real
/// pivots of soft disks, and the factors of unequal disks would grow without bound.
void solve(std::vector<Complex>& matrix, std::vector<Complex>& right) {
  const auto size = static_cast<lapack_int>(right.size());
  std::vector<lapack_int> pivots(right.size());
  for (std::size_t row = 0; row < right.size(); ++row) {
    const Complex diagonal = matrix[row * (right.size() + 1)];
    const Complex turned = std::polar(1.0, two_pi / 8 - std::arg(diagonal));
    cblas_zscal(size, &turned, &matrix[row], size);
    right[row] *= turned;
  }
  if (LAPACKE_zgesv(LAPACK_COL_MAJOR, size, 1, matrix.data(), size, pivots.data(), right.data(),
                    size) != 0)
    throw std::runtime_error("multipole oracle: singular");
}

}  // namespace

MultipoleOracle::MultipoleOracle(const Placement& placement, double k, double light,
                                 std::vector<int> orders)
    : placement_(placement), k_(k), light_(light), orders_(std::move(orders)) {
  std::size_t size = 0;
  for (const int order : orders_) {
    first_.push_back(size);
    size += 2 * static_cast<std::size_t>(order) + 1;
  }
  std::vector<Complex> matrix(size * size);  // column by column
  on_rim_.resize(size);
  for (std::size_t to = 0; to < placement.size(); ++to)
    for (std::size_t from = 0; from < placement.size(); ++from)
      to == from ? own_block(to, matrix) : block(to, from, matrix);
  solve(matrix, on_rim_);
}

/// Fills the diagonal block and the right-hand side of a disk.
void MultipoleOracle::own_block(std::size_t disk, std::vector<Complex>& matrix) {
  const auto& [centre, scatterer] = placement_[disk];
  const double x = k_ * scatterer.radius;
  const Complex phase = std::polar(1.0, k_ * dot(direction(light_), centre));
  const auto own = bessel(orders_[disk], x);
  const InverseT inverse_t(scatterer, x, orders_[disk]);
  for (int n = -orders_[disk]; n <= orders_[disk]; ++n) {
    const std::size_t row = place(disk, n);
    on_rim_[row] = static_cast<double>(own(n)) * phase * std::polar(1.0, n * (two_pi / 4 - light_));
    matrix[row + on_rim_.size() * row] = Complex(static_cast<ExtendedComplex>(inverse_t(n)));
  }
}

void MultipoleOracle::block(std::size_t to, std::size_t from, std::vector<Complex>& matrix) const {
  const Vec d = placement_[to].position - placement_[from].position;
  const auto received = bessel(orders_[to], k_ * placement_[to].scatterer.radius);
  const auto sent = hankel(orders_[from], k_ * placement_[from].scatterer.radius);
  const auto between = hankel(orders_[to] + orders_[from], k_ * length(d));
  for (int p = -orders_[to]; p <= orders_[to]; ++p)
    for (int n = -orders_[from]; n <= orders_[from]; ++n) {
      const ScaledComplex entry = -(received(p) * (between(n - p) / sent(n)));
      matrix[place(to, p) + on_rim_.size() * place(from, n)] =
          Complex(static_cast<ExtendedComplex>(entry)) * turn(n - p, d);
    }
}

Complex MultipoleOracle::inside(std::size_t disk, Vec point) const {
  const auto& [centre, scatterer] = placement_[disk];
  const double x = k_ * scatterer.radius, m = scatterer.index.real();
  const Vec d = point - centre;
  const int order = orders_[disk];
  const InverseT inverse_t(scatterer, x, order);
  const auto here = bessel(order, m * k_ * length(d)), at_rim = bessel(order, m * x);
  Complex sum = 0;
  for (int n = -order; n <= order; ++n) {
    // Total field on the rim, scattered and incident: b H (1 + J / (T H)).
    const ExtendedComplex rim = 1.0L + static_cast<ExtendedComplex>(inverse_t(n));
    const auto radial = static_cast<long double>(here(n) / at_rim(n));
    sum += on_rim_[place(disk, n)] * Complex(rim * radial) * turn(n, d);
  }
  return sum;
}

Complex MultipoleOracle::outside(Vec point) const {
  Complex sum = std::polar(1.0, k_ * dot(direction(light_), point));
  for (std::size_t disk = 0; disk < placement_.size(); ++disk) {
    const Vec d = point - placement_[disk].position;
    const auto here = hankel(orders_[disk], k_ * length(d));
    const auto at_rim = hankel(orders_[disk], k_ * placement_[disk].scatterer.radius);
    for (int n = -orders_[disk]; n <= orders_[disk]; ++n)
      sum += on_rim_[place(disk, n)] * Complex(static_cast<ExtendedComplex>(here(n) / at_rim(n))) *
             turn(n, d);
  }
  return sum;
}

}  // namespace flatspeckle::wave
