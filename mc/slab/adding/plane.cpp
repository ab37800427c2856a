#include "mc/slab/adding/plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "core/algebra/dual.h"
#include "core/numbers/gauss.h"
#include "core/run/interrupt.h"
#include "flatland/scene/frequency_shift.h"
#include "mc/slab/adding/ordinates.h"

namespace flatspeckle::mc {

namespace {

using flatspeckle::divided_difference;
using std::numbers::pi;

/// Returns the second divided difference of exp at a, b and c: the integral of exp(a x + b y + c z)
/// over x + y + z = 1 with x, y, z > 0.
template <typename C>
C divided_difference(C a, C b, C c) {
  // Permutes the arguments so that a and c are furthest apart.
  const double ab = std::norm(value_of(a - b)), bc = std::norm(value_of(b - c)),
               ca = std::norm(value_of(c - a));
  if (ab >= bc && ab >= ca)
    std::swap(b, c);
  else if (bc >= ca)
    std::swap(a, b);
  if (std::norm(value_of(a - c)) > 0.25)
    return (divided_difference(a, b) - divided_difference(b, c)) / (a - c);
  // Sums the series exp(m) sum_k h_k / (k + 2)! about the mean m of a, b and c. The h_k are the
  // complete symmetric polynomials of x = a - m, y = b - m, z = c - m.
  const C middle = (a + b + c) / 3.0, x = a - middle, y = b - middle, z = c - middle;
  const C second = x * y + y * z + z * x, third = x * y * z;
  // h_{k-2}, h_{k-1}, h_k. The recurrence has only two terms because x + y + z = 0.
  std::array<C, 3> h{C{}, C{}, exp(C{})};
  C sum = 0.5 * h[2];
  double factorial = 2;
  for (int k = 1; k <= 12; ++k) {
    h = {h[1], h[2], third * h[0] - second * h[1]};
    factorial *= k + 2;
    sum += h[2] / factorial;
  }
  return exp(middle) * sum;
}

double magnitude(Complex z) {
  return std::abs(z);
}
double magnitude(const Dual<Complex>& z) {
  return std::max(std::abs(z.value), std::abs(z.derivative));
}

/// Returns the angle in the first quadrant that has the same absolute sine.
double folded(double angle) {
  const double from_z = std::abs(std::remainder(angle, 2 * pi));
  return std::min(from_z, pi - from_z);
}

void add(std::vector<Focus>& foci, double angle, double width) {
  constexpr double too_wide = 0.4;  // foci wider than this require no shorter panels
  if (width < too_wide) foci.push_back({angle, width});
}

}  // namespace

template <typename Number>
DoubleScatteringOf<Number>::DoubleScatteringOf(RealOf<Number> optical_depth, double k, double q,
                                               const Endpoint& lights, const Endpoint& views,
                                               const Departure<Number>& departure)
    : optical_depth_(optical_depth),
      q_(q * departure.length),
      extinction_(departure.extinction(k)),
      lights_(lights.pair),
      views_(views.pair),
      light_(lights.wave),
      view_(views.wave) {}

template <typename Number>
ComplexOf<Number> DoubleScatteringOf<Number>::along(double sine, double cosine, bool down) const {
  const C loss = (as_complex(extinction_) + Complex(0, sine) * q_) / cosine,
          between = down ? view_.top + light_.bottom : light_.top + view_.bottom;
  return optical_depth_ * optical_depth_ / cosine *
         divided_difference(C(optical_depth_ * (light_.top + view_.top)),
                            C(optical_depth_ * (between - loss)),
                            C(optical_depth_ * (light_.bottom + view_.bottom)));
}

template <typename Number>
ComplexOf<Number> DoubleScatteringOf<Number>::gauss(const Law& law, double from, double to) const {
  static const QuadratureRule rule = gauss_legendre(10);
  C sum{};
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double theta = from + rule.node[i] * (to - from), cosine = std::cos(theta);
    sum += rule.weight[i] * (along(std::sin(theta), std::abs(cosine), cosine > 0) *
                             law.pair(lights_.first, lights_.second, theta) *
                             law.pair(views_.first, views_.second, theta));
  }
  return (to - from) * sum;
}

template <typename Number>
ComplexOf<Number> DoubleScatteringOf<Number>::integral(const Law& law, double from, double to,
                                                       double tolerance, C estimate,
                                                       int depth) const {
  constexpr int deepest = 24;
  stop_if_interrupted();
  const double middle = (from + to) / 2;
  const C left = gauss(law, from, middle), right = gauss(law, middle, to);
  if (!(magnitude(left + right - estimate) > tolerance) || depth == deepest) return left + right;
  return integral(law, from, middle, tolerance, left, depth + 1) +
         integral(law, middle, to, tolerance, right, depth + 1);
}

template <typename Number>
ComplexOf<Number> DoubleScatteringOf<Number>::total(const Law& law, double tolerance) const {
  std::vector<double> cuts{-pi, -pi / 2, pi / 2, pi};
  for (const double angle : {lights_.first, lights_.second, views_.first, views_.second,
                             (lights_.first + lights_.second) / 2})
    cuts.push_back(std::remainder(angle, 2 * pi));
  std::sort(cuts.begin(), cuts.end());
  C sum{};
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
    if (cuts[i + 1] > cuts[i])
      sum += integral(law, cuts[i], cuts[i + 1], tolerance, gauss(law, cuts[i], cuts[i + 1]), 0);
  return sum;
}

template class DoubleScatteringOf<double>;
template class DoubleScatteringOf<Complex>;
template class DoubleScatteringOf<Dual<double>>;

double PlaneGeometry::matched(const Pair& lights, const Pair& views, double shift) {
  return matched_view(lights.first, views.first, lights.second, views.second, shift);
}

double PlaneGeometry::momentum(const Pair& lights, double k, double mu_t, double shift) {
  // In units of k: momenta that differ by less count as equal.
  constexpr double same_momentum = 1e-12;
  const double unit = same_momentum * k / mu_t,
               q = k / mu_t * (std::sin(lights.first) - (1 + shift) * std::sin(lights.second));
  return unit * std::round(q / unit);
}

Scene PlaneGeometry::with_scatterer(Scene scene, const Scatterer& scatterer) {
  scene.scatterer = scatterer;
  scene.medium = bulk_medium(scatterer, scene.k, scene.medium.density);
  return scene;
}

std::vector<Focus> light_foci(const Pair& lights, double width) {
  std::vector<Focus> found;
  for (const double angle : {lights.first, lights.second}) add(found, folded(angle), width);
  return found;
}

PlaneGeometry::Foci::Foci(const std::vector<Pair>& lights, double optical_depth, double width)
    : optical_depth_(optical_depth), width_(width) {
  std::vector<double> all;
  for (const Pair& pair : lights)
    for (const double angle : {pair.first, pair.second}) all.push_back(folded(angle));
  std::sort(all.begin(), all.end());
  for (const double angle : all)
    if (centres_.empty() || angle - centres_.back() > width / 2) centres_.push_back(angle);
}

std::vector<Focus> PlaneGeometry::Foci::of(const Pair& lights, Momentum q) const {
  std::vector<Focus> found;
  for (const double angle : {folded(lights.first), folded(lights.second)})
    add(found, *std::prev(std::upper_bound(centres_.begin(), centres_.end(), angle)), width_);
  // If the phase varies by fewer radians than this, panels without an additional focus need fewer
  // ordinates.
  constexpr double many_turns = 150;
  if (std::abs(q) * std::min(4.0, optical_depth_) > many_turns)
    add(found, folded((lights.first + lights.second) / 2),
        std::max(0.01, 1 / (std::abs(q) * std::min(1.0, optical_depth_))));
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

Matrix PlaneGeometry::functions(const Eigen::VectorXd& angle, int m, int last) {
  const Eigen::ArrayXd c = angle.array().cos(), s = angle.array().sin();
  Eigen::ArrayXd cosine = Eigen::ArrayXd::Ones(angle.size()),
                 sine = Eigen::ArrayXd::Zero(angle.size());
  Matrix values(angle.size(), std::max(last - m + 1, 0));
  for (int l = 0; l <= last; ++l) {
    if (l >= m) values.col(l - m) = m == 0 ? cosine : sine;
    const Eigen::ArrayXd next = c * cosine - s * sine;
    sine = s * cosine + c * sine;
    cosine = next;
  }
  return values;
}

double PlaneGeometry::weight(int l) {
  return (l == 0 ? 2 : 4) / pi;
}

std::vector<Complex> PlaneGeometry::beam(double light, int m, int last) {
  std::vector<Complex> shares;
  for (int l = m; l <= last; ++l) {
    const double weight = (l == 0 ? 0.5 : 1) * std::numbers::sqrt2 / pi;
    shares.push_back(weight *
                     (m == 0 ? Complex(std::cos(l * light)) : Complex(0, std::sin(l * light))));
  }
  return shares;
}

template <typename Number>
PairWavesOf<Number> PlaneGeometry::fed(const OrdinatesOf<PlaneGeometry, RealOf<Number>>& ordinates,
                                       Momentum, int, const std::vector<Pair>& pairs) {
  const AngularGrid& grid = ordinates.grid();
  const Eigen::Index n = grid.size();
  const Eigen::VectorXd scale = ordinates.root().cwiseInverse();
  /// Returns the parts of radiance that are even and odd in the angle. right: radiance at the
  /// ordinates; left: radiance in their mirror images about z.
  const auto split = [&](const Eigen::VectorXcd& right, const Eigen::VectorXcd& left) {
    constexpr double share = std::numbers::sqrt2 / 2;
    Eigen::VectorXcd parts(2 * n);
    for (Eigen::Index j = 0; j < n; ++j) {
      parts[j] = share * (right[j] + left[j]);
      parts[n + j] = Complex(0, share) * (right[j] - left[j]);
    }
    return parts;
  };
  /// Returns the radiance scattered into the directions turn + theta and turn - theta, split into
  /// even and odd parts, where theta are the ordinates.
  const auto into = [&](double turn) {
    return each_part<Number>([&](const auto& part) {
      Rows rows(std::ssize(pairs), 2 * n);
      for (Eigen::Index i = 0; i < rows.rows(); ++i) {
        const Pair pair = pairs[static_cast<std::size_t>(i)];
        const auto towards = [&](double sign) -> Eigen::VectorXcd {
          return scale.asDiagonal() * grid.integrals([&](double theta) {
            return part(ordinates.law().pair(pair.first, pair.second, turn + sign * theta));
          });
        };
        rows.row(i) = turn == 0 ? split(towards(1), towards(-1)).transpose()
                                : split(towards(-1), towards(1)).transpose();
      }
      return rows;
    });
  };
  return {{}, {}, ordinates.albedo() * into(0), ordinates.albedo() * into(pi), {}};
}

template <typename Number>
ComplexOf<Number> PlaneGeometry::double_scattering(const DoubleScatteringOf<Number>& paths,
                                                   const AngularGrid& grid,
                                                   const std::vector<int>& functions,
                                                   const HomogeneousLayerOf<Number>& layer,
                                                   Eigen::Index light, Eigen::Index view) {
  using C = ComplexOf<Number>;
  const Eigen::Index n = grid.size();
  C sum{};
  for (Eigen::Index j = 0; j < n; ++j) {
    const double cosine = grid.cosine()[j], sine = std::sin(grid.angle()[j]);
    for (const bool down : {true, false}) {
      const auto fed = [&](Eigen::Index i) {
        return entry(down ? layer.lights.down : layer.lights.up, light, i);
      };
      const auto collected = [&](Eigen::Index i) {
        return entry(down ? layer.views.up : layer.views.down, view, i);
      };
      const auto along = [&](double sign) {
        return cosine * paths.along(sign * sine, cosine, down);
      };
      const C first = fed(j) * collected(j);
      if (functions.size() == 1) {
        sum += (functions.front() == 0 ? first : -first) * along(1);
        continue;
      }
      const C second = fed(n + j) * collected(n + j),
              mixed = Complex(0, 1) * (fed(j) * collected(n + j) + fed(n + j) * collected(j));
      sum += (first - second - mixed) / 2.0 * along(1) + (first - second + mixed) / 2.0 * along(-1);
    }
  }
  return sum;
}

template PairWavesOf<double> PlaneGeometry::fed<double>(const OrdinatesOf<PlaneGeometry, double>&,
                                                        Momentum, int, const std::vector<Pair>&);
template PairWavesOf<Complex> PlaneGeometry::fed<Complex>(const OrdinatesOf<PlaneGeometry, double>&,
                                                          Momentum, int, const std::vector<Pair>&);
template PairWavesOf<Dual<double>> PlaneGeometry::fed<Dual<double>>(
    const OrdinatesOf<PlaneGeometry, Dual<double>>&, Momentum, int, const std::vector<Pair>&);
template Complex PlaneGeometry::double_scattering<double>(const DoubleScatteringOf<double>&,
                                                          const AngularGrid&,
                                                          const std::vector<int>&,
                                                          const HomogeneousLayerOf<double>&,
                                                          Eigen::Index, Eigen::Index);
template Complex PlaneGeometry::double_scattering<Complex>(const DoubleScatteringOf<Complex>&,
                                                           const AngularGrid&,
                                                           const std::vector<int>&,
                                                           const HomogeneousLayerOf<Complex>&,
                                                           Eigen::Index, Eigen::Index);
template Dual<Complex> PlaneGeometry::double_scattering<Dual<double>>(
    const DoubleScatteringOf<Dual<double>>&, const AngularGrid&, const std::vector<int>&,
    const HomogeneousLayerOf<Dual<double>>&, Eigen::Index, Eigen::Index);

}  // namespace flatspeckle::mc
