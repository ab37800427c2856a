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

void add(PairWaves& waves, const PairWave& wave) {
  waves.top.push_back(wave.top);
  waves.bottom.push_back(wave.bottom);
}

}  // namespace

ScatteringMatrices::ScatteringMatrices(const AngularGrid& grid, const ScatteringLaw& law,
                                       double albedo)
    : grid_(grid),
      law_(law),
      albedo_(albedo),
      root_(grid.weight().cwiseProduct(grid.cosine()).unaryExpr([](double square) {
        return 1 / std::sqrt(square);
      })) {
  const auto integrals = grid.mode_integrals(static_cast<int>(law.modes().size()) - 1);
  const auto blocks = [&](std::size_t even, std::size_t odd) {
    const auto scaled = [&](const Matrix& a) {
      return Matrix(albedo_ * root_.asDiagonal() * a * root_.asDiagonal());
    };
    return Blocks{scaled(gram(integrals.cosine, law.modes(), even)),
                  scaled(gram(integrals.sine, law.modes(), odd))};
  };
  // backwards, theta -> pi - theta, cos(m theta) has the sign (-1)^m, sin(m theta) the other one
  sum_ = blocks(0, 1);
  difference_ = blocks(1, 2);
}

std::vector<ScatteringMatrices::Parity> ScatteringMatrices::parities(double q) {
  if (q == 0) return {Parity::even, Parity::odd};
  return {Parity::both};
}

Matrix ScatteringMatrices::block(double q, const Blocks& scattering, Parity parity) const {
  const Eigen::Index n = grid_.size();
  const Matrix extinction = grid_.cosine().cwiseInverse().asDiagonal();
  if (parity == Parity::even) return extinction - scattering.even;
  if (parity == Parity::odd) return extinction - scattering.odd;
  const Matrix across =
      (q * grid_.angle().array().sin() / grid_.cosine().array()).matrix().asDiagonal();
  Matrix all(2 * n, 2 * n);
  all << extinction - scattering.even, -across, across, extinction - scattering.odd;
  return all;
}

TransportOperator ScatteringMatrices::transport(double q, Parity parity) const {
  return {block(q, difference_, parity), block(q, sum_, parity),
          parity == Parity::odd ? 0 : grid_.size(),
          (1 + std::abs(q)) / *std::min_element(grid_.cosine().begin(), grid_.cosine().end())};
}

PairWaves ScatteringMatrices::waves(const std::vector<Pair>& pairs, Parity parity) const {
  const Eigen::Index n = grid_.size(), size = parity == Parity::both ? 2 * n : n;
  const auto count = static_cast<Eigen::Index>(pairs.size());
  PairWaves found{{}, {}, Rows(count, size), Rows(count, size)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Pair pair = pairs[static_cast<std::size_t>(i)];
    const auto fed = [&](double turn, double sign) -> Eigen::VectorXcd {
      return root_.asDiagonal() * grid_.integrals([&](double theta) {
        return law_.pair(pair.first, pair.second, turn + sign * theta);
      });
    };
    const auto split = [&](const Eigen::VectorXcd& right, const Eigen::VectorXcd& left) {
      const double share = albedo_ * std::numbers::sqrt2 / 2;
      Eigen::VectorXcd parts(size);
      for (Eigen::Index j = 0; j < n; ++j) {
        if (parity != Parity::odd) parts[j] = share * (right[j] + left[j]);
        if (parity != Parity::even) parts[size - n + j] = Complex(0, share) * (right[j] - left[j]);
      }
      return parts;
    };
    found.down.row(i) = split(fed(0, 1), fed(0, -1)).transpose();
    found.up.row(i) = split(fed(pi, -1), fed(pi, 1)).transpose();
  }
  return found;
}

PairWaves ScatteringMatrices::lights(const Scene& scene, const std::vector<Pair>& pairs,
                                     Parity parity) const {
  PairWaves found = waves(pairs, parity);
  for (const Pair& pair : pairs) add(found, pair_wave(scene, pair));
  return found;
}

PairWaves ScatteringMatrices::views(const Scene& scene, const std::vector<Pair>& pairs,
                                    Parity parity) const {
  PairWaves found = waves(pairs, parity);
  found.down.swap(found.up);
  for (const Pair& pair : pairs) add(found, pair_wave(scene, turned_round(pair)));
  return found;
}

Complex ScatteringMatrices::double_scattering(const DoubleScattering& paths,
                                              const PairWaves& lights, Eigen::Index light,
                                              const PairWaves& views, Eigen::Index view,
                                              Parity parity) const {
  const Eigen::Index n = grid_.size();
  Complex sum = 0;
  for (Eigen::Index j = 0; j < n; ++j) {
    const double cosine = grid_.cosine()[j], sine = std::sin(grid_.angle()[j]);
    for (const bool down : {true, false}) {
      const Rows &fed = down ? lights.down : lights.up, &collected = down ? views.up : views.down;
      const auto along = [&](double sign) {
        return cosine * paths.along(sign * sine, cosine, down);
      };
      const Complex first = fed(light, j) * collected(view, j);
      if (parity != Parity::both) {
        sum += (parity == Parity::even ? first : -first) * along(1);
        continue;
      }
      const Complex second = fed(light, n + j) * collected(view, n + j),
                    mixed = Complex(0, 1) * (fed(light, j) * collected(view, n + j) +
                                             fed(light, n + j) * collected(view, j));
      sum += (first - second - mixed) / 2.0 * along(1) + (first - second + mixed) / 2.0 * along(-1);
    }
  }
  return sum;
}

}  // namespace flatspeckle::mc
