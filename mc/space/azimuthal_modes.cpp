#include "mc/space/azimuthal_modes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// i^m
Complex turned(int m) {
  constexpr Complex powers[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  return powers[m % 4];
}

}  // namespace

AzimuthalModes::AzimuthalModes(const PolarMatrices& polar, const SpaceLaw& law, double albedo,
                               int highest)
    : polar_(polar), grid_(polar.grid()), law_(law), albedo_(albedo), highest_(highest) {}

std::vector<AzimuthalModes::Part> AzimuthalModes::parts(double q) const {
  std::vector<Part> list;
  if (q == 0) {
    for (int f = 0; f <= 2 * highest_; ++f) list.push_back({{f}, mode(f) % 2 == 0});
    return list;
  }
  for (const int first : {0, 1}) {  // of cosines, of sines
    Part part{{}, 0};
    for (int parity : {0, 1}) {
      for (int m = first; m <= highest_; ++m)
        if (m % 2 == parity) part.functions.push_back(first * highest_ + m);
      if (parity == 0) part.even = static_cast<int>(part.functions.size());
    }
    if (!part.functions.empty()) list.push_back(part);
  }
  return list;
}

Matrix AzimuthalModes::block(double q, const Part& part, Matrix Scattering::*scattering) const {
  const Eigen::Index n = grid_.size(), count = part.functions.size();
  const Eigen::ArrayXd extinction = grid_.cosine().cwiseInverse(),
                       across = q * grid_.angle().array().sin() * extinction;
  Matrix all = Matrix::Zero(count * n, count * n);
  for (Eigen::Index a = 0; a < count; ++a) {
    const int m = mode(part.functions[a]);
    all.block(a * n, a * n, n, n) =
        Matrix(extinction.matrix().asDiagonal()) - polar_.of_mode(m).*scattering;
    for (Eigen::Index b = 0; b < count; ++b) {
      const int other = mode(part.functions[b]);
      if (std::abs(other - m) != 1) continue;
      const double coupling = std::min(m, other) == 0 ? std::numbers::sqrt2 / 2 : 0.5;
      all.block(a * n, b * n, n, n) = ((m - other) * coupling * across).matrix().asDiagonal();
    }
  }
  return all;
}

TransportOperator AzimuthalModes::transport(double q, const Part& part) const {
  return {block(q, part, &Scattering::difference), block(q, part, &Scattering::sum),
          part.even * grid_.size(),
          (1 + std::abs(q)) / *std::min_element(grid_.cosine().begin(), grid_.cosine().end())};
}

/// [azimuth][function]: normalised, times the step of the azimuth.
Matrix AzimuthalModes::azimuthal_functions(int steps) const {
  const double step = 2 * pi / steps;
  Matrix values(steps, 2 * highest_ + 1);
  for (int i = 0; i < steps; ++i) {
    values(i, 0) = step / std::sqrt(2 * pi);
    for (int m = 1; m <= highest_; ++m) {
      values(i, m) = step / std::sqrt(pi) * std::cos(m * i * step);
      values(i, highest_ + m) = step / std::sqrt(pi) * std::sin(m * i * step);
    }
  }
  return values;
}

/// What a pair scatters into the directions of a side, a row for each function.
Rows AzimuthalModes::fed(const SpacePair& pair, const Matrix& directions, const Matrix& azimuthal,
                         double side) const {
  const auto steps = azimuthal.rows();
  const auto projected = [&](const Eigen::VectorXd& angles) -> Matrix {
    Matrix values(angles.size(), steps);
    for (Eigen::Index j = 0; j < angles.size(); ++j) {
      const double sine = std::sin(angles[j]), cosine = side * std::cos(angles[j]);
      for (Eigen::Index i = 0; i < steps; ++i) {
        const Eigen::Vector3d to(sine * directions(i, 0), sine * directions(i, 1), cosine);
        values(j, i) = sine * law_.pair(pair.first.dot(to), pair.second.dot(to));
      }
    }
    return product(values, azimuthal);
  };
  const Matrix integrals = albedo_ * polar_.root().cwiseInverse().asDiagonal() *
                           grid_.integrals_of(azimuthal.cols(), projected);
  Rows rows(1, integrals.size());
  for (Eigen::Index f = 0; f < integrals.cols(); ++f)
    rows.middleCols(f * grid_.size(), grid_.size()) =
        turned(mode(static_cast<int>(f))) * integrals.col(f).transpose();
  return rows;
}

PairWaves AzimuthalModes::waves(const Eigen::Vector2d& x,
                                const std::vector<SpacePair>& pairs) const {
  double sine = 0;
  for (const SpacePair& pair : pairs)
    for (const auto& direction : {pair.first, pair.second})
      sine = std::max(sine, direction.head<2>().norm());
  // Modes of p beyond l sin(theta) have died out at the angle of a light.
  const int steps =
      2 * highest_ + 32 + static_cast<int>(1.2 * sine * static_cast<double>(law_.moments().size()));
  const Matrix azimuthal = azimuthal_functions(steps);
  Matrix directions(steps, 2);
  for (int i = 0; i < steps; ++i) {
    const double phi = 2 * pi * i / steps, c = std::cos(phi), s = std::sin(phi);
    directions.row(i) << c * x.x() - s * x.y(), c * x.y() + s * x.x();
  }
  const auto count = static_cast<Eigen::Index>(pairs.size());
  const Eigen::Index size = azimuthal.cols() * grid_.size();
  PairWaves found{{}, {}, Rows(count, size), Rows(count, size)};
  for (Eigen::Index i = 0; i < count; ++i) {
    found.down.row(i) = fed(pairs[i], directions, azimuthal, 1);
    found.up.row(i) = fed(pairs[i], directions, azimuthal, -1);
  }
  return found;
}

PairWaves AzimuthalModes::lights(double k, const Eigen::Vector2d& x,
                                 const std::vector<SpacePair>& pairs) const {
  PairWaves found = waves(x, pairs);
  for (const SpacePair& pair : pairs) {
    const PairWave wave = pair_wave(k, pair);
    found.top.push_back(wave.top);
    found.bottom.push_back(wave.bottom);
  }
  return found;
}

PairWaves AzimuthalModes::views(double k, const Eigen::Vector2d& x,
                                const std::vector<SpacePair>& pairs) const {
  PairWaves found = waves(x, pairs);
  found.down.swap(found.up);
  for (const SpacePair& pair : pairs) {
    const PairWave wave = pair_wave(k, turned_round(pair));
    found.top.push_back(wave.top);
    found.bottom.push_back(wave.bottom);
  }
  return found;
}

PairWaves AzimuthalModes::part_of(const PairWaves& all, const Part& part) const {
  const Eigen::Index n = grid_.size(), count = part.functions.size(), rows = all.down.rows();
  PairWaves found{all.top, all.bottom, Rows(rows, count * n), Rows(rows, count * n)};
  for (Eigen::Index a = 0; a < count; ++a) {
    const Eigen::Index from = part.functions[a] * n;
    found.down.middleCols(a * n, n) = all.down.middleCols(from, n);
    found.up.middleCols(a * n, n) = all.up.middleCols(from, n);
  }
  return found;
}

Eigen::VectorXd AzimuthalModes::power() const {
  return std::sqrt(2 * pi) * polar_.root();
}

}  // namespace flatspeckle::mc
