#include "mc/transport/scattering_matrices.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// sum over m = first, first + 2, .. of modes[m] v_m v_m^T
Matrix gram(const Matrix& integrals, const std::vector<double>& modes, std::size_t first) {
  const auto count = static_cast<Eigen::Index>((modes.size() - first + 1) / 2);
  if (modes.size() <= first) return Matrix::Zero(integrals.rows(), integrals.rows());
  Matrix taken(integrals.rows(), count), weighted(integrals.rows(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto m = first + 2 * static_cast<std::size_t>(i);
    taken.col(i) = integrals.col(static_cast<Eigen::Index>(m));
    weighted.col(i) = (m == 0 ? 2 : 4) / pi * modes[m] * taken.col(i);
  }
  return product(weighted, taken.transpose());
}

Dual<Matrix> gram(const Matrix& integrals, const Dual<std::vector<double>>& modes,
                  std::size_t first) {
  return {gram(integrals, modes.value, first), gram(integrals, modes.slope, first)};
}

/// [even, -across; across, odd]
template <typename M>
M both_parities(const M& even, const M& odd, const M& across) {
  const Eigen::Index n = even.rows();
  M all(2 * n, 2 * n);
  all << even, -across, across, odd;
  return all;
}
Dual<Matrix> both_parities(const Dual<Matrix>& even, const Dual<Matrix>& odd,
                           const Dual<Matrix>& across) {
  return {both_parities(even.value, odd.value, across.value),
          both_parities(even.slope, odd.slope, across.slope)};
}

template <typename Number>
void add(PairWavesOf<Number>& waves, const PairWaveOf<Number>& wave) {
  waves.top.push_back(wave.top);
  waves.bottom.push_back(wave.bottom);
}

}  // namespace

template <typename Number>
ScatteringMatricesOf<Number>::ScatteringMatricesOf(const AngularGrid& grid, const Law& law,
                                                   RealOf<Number> albedo, Number extinction,
                                                   const Departure<Number>& departure)
    : grid_(grid),
      law_(law),
      albedo_(albedo),
      extinction_(extinction),
      departure_(departure),
      root_(grid.weight().cwiseProduct(grid.cosine()).unaryExpr([](double square) {
        return 1 / std::sqrt(square);
      })) {
  const auto integrals = grid.mode_integrals(degree(law.modes()));
  const auto blocks = [&](std::size_t even, std::size_t odd) {
    const auto scaled = [&](const Matrix& a) -> Matrix {
      return root_.asDiagonal() * a * root_.asDiagonal();
    };
    return Blocks{albedo_ * linear(scaled, gram(integrals.cosine, law.modes(), even)),
                  albedo_ * linear(scaled, gram(integrals.sine, law.modes(), odd))};
  };
  // backwards, theta -> pi - theta, cos(m theta) has the sign (-1)^m, sin(m theta) the other one
  sum_ = blocks(0, 1);
  difference_ = blocks(1, 2);
}

template <typename Number>
std::vector<Parity> ScatteringMatricesOf<Number>::parities(double q) {
  if (q == 0) return {Parity::even, Parity::odd};
  return {Parity::both};
}

template <typename Number>
MatrixOf<Number> ScatteringMatricesOf<Number>::block(double q, const Blocks& scattering,
                                                     Parity parity) const {
  const M extinction = times(extinction_, Matrix(grid_.cosine().cwiseInverse().asDiagonal()));
  if (parity == Parity::even) return extinction - scattering.even;
  if (parity == Parity::odd) return extinction - scattering.odd;
  const Matrix across =
      (q * grid_.angle().array().sin() / grid_.cosine().array()).matrix().asDiagonal();
  return both_parities(M(extinction - scattering.even), M(extinction - scattering.odd),
                       M(times(departure_.length, across)));
}

template <typename Number>
TransportOperatorOf<Number> ScatteringMatricesOf<Number>::transport(double q, Parity parity) const {
  return {block(q, difference_, parity), block(q, sum_, parity),
          parity == Parity::odd ? 0 : grid_.size(),
          (std::abs(value_of(extinction_)) + std::abs(q)) /
              *std::min_element(grid_.cosine().begin(), grid_.cosine().end())};
}

template <typename Number>
PairWavesOf<Number> ScatteringMatricesOf<Number>::waves(const std::vector<Pair>& pairs,
                                                        Parity parity) const {
  const Eigen::Index n = grid_.size(), size = parity == Parity::both ? 2 * n : n;
  const auto count = static_cast<Eigen::Index>(pairs.size());
  const auto split = [&](const Eigen::VectorXcd& right, const Eigen::VectorXcd& left) {
    constexpr double share = std::numbers::sqrt2 / 2;
    Eigen::VectorXcd parts(size);
    for (Eigen::Index j = 0; j < n; ++j) {
      if (parity != Parity::odd) parts[j] = share * (right[j] + left[j]);
      if (parity != Parity::even) parts[size - n + j] = Complex(0, share) * (right[j] - left[j]);
    }
    return parts;
  };
  /// Into directions turn + theta and turn - theta.
  const auto fed = [&](double turn) {
    return each_part<Number>([&](const auto& part) {
      Rows rows(count, size);
      for (Eigen::Index i = 0; i < count; ++i) {
        const Pair pair = pairs[static_cast<std::size_t>(i)];
        const auto towards = [&](double sign) -> Eigen::VectorXcd {
          return root_.asDiagonal() * grid_.integrals([&](double theta) {
            return part(law_.pair(pair.first, pair.second, turn + sign * theta));
          });
        };
        rows.row(i) = turn == 0 ? split(towards(1), towards(-1)).transpose()
                                : split(towards(-1), towards(1)).transpose();
      }
      return rows;
    });
  };
  return {{}, {}, albedo_ * fed(0), albedo_ * fed(pi)};
}

template <typename Number>
EndWavesOf<Number> ScatteringMatricesOf<Number>::ends(const Scene& scene,
                                                      const std::vector<Pair>& lights,
                                                      const std::vector<Pair>& views,
                                                      Parity parity) const {
  const Waves fed = waves(lights, parity), seen = views == lights ? fed : waves(views, parity);
  Ends found{fed, {{}, {}, seen.up, seen.down}};
  for (const Pair& pair : lights) add(found.lights, pair_wave(scene, pair, departure_));
  for (const Pair& pair : views) add(found.views, pair_wave(scene, turned_round(pair), departure_));
  return found;
}

template <typename Number>
ComplexOf<Number> ScatteringMatricesOf<Number>::double_scattering(
    const DoubleScatteringOf<Number>& paths, const Waves& lights, Eigen::Index light,
    const Waves& views, Eigen::Index view, Parity parity) const {
  const Eigen::Index n = grid_.size();
  C sum{};
  for (Eigen::Index j = 0; j < n; ++j) {
    const double cosine = grid_.cosine()[j], sine = std::sin(grid_.angle()[j]);
    for (const bool down : {true, false}) {
      const auto fed = [&](Eigen::Index i) {
        return entry(down ? lights.down : lights.up, light, i);
      };
      const auto collected = [&](Eigen::Index i) {
        return entry(down ? views.up : views.down, view, i);
      };
      const auto along = [&](double sign) {
        return cosine * paths.along(sign * sine, cosine, down);
      };
      const C first = fed(j) * collected(j);
      if (parity != Parity::both) {
        sum += (parity == Parity::even ? first : -first) * along(1);
        continue;
      }
      const C second = fed(n + j) * collected(n + j),
              mixed = Complex(0, 1) * (fed(j) * collected(n + j) + fed(n + j) * collected(j));
      sum += (first - second - mixed) / 2.0 * along(1) + (first - second + mixed) / 2.0 * along(-1);
    }
  }
  return sum;
}

template class ScatteringMatricesOf<double>;
template class ScatteringMatricesOf<Complex>;
template class ScatteringMatricesOf<Dual<double>>;

}  // namespace flatspeckle::mc
