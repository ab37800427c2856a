#include "mc/space/azimuthal_modes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "mc/transport/bulk_slope.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// i^m
Complex turned(int m) {
  constexpr Complex powers[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  return powers[m % 4];
}

template <typename Number>
void add(PairWavesOf<Number>& waves, const PairWaveOf<Number>& wave) {
  waves.top.push_back(wave.top);
  waves.bottom.push_back(wave.bottom);
}

}  // namespace

template <typename Number>
AzimuthalModesOf<Number>::AzimuthalModesOf(const Polar& polar, const Slab& slab, int highest)
    : polar_(polar), grid_(polar.grid()), slab_(slab), highest_(highest) {}

template <typename Number>
auto AzimuthalModesOf<Number>::parts(double q) const -> std::vector<Part> {
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

template <typename Number>
MatrixOf<Number> AzimuthalModesOf<Number>::block(double q, const Part& part,
                                                 MatrixOf<Real> Scattering::*scattering) const {
  const Eigen::Index n = grid_.size(), count = part.functions.size();
  const Eigen::ArrayXd loss = grid_.cosine().cwiseInverse(),
                       momentum = q * grid_.angle().array().sin() * loss;
  Matrix extinction = Matrix::Zero(count * n, count * n), across = extinction;
  for (Eigen::Index a = 0; a < count; ++a) {
    const int m = mode(part.functions[a]);
    extinction.block(a * n, a * n, n, n) = loss.matrix().asDiagonal();
    for (Eigen::Index b = 0; b < count; ++b) {
      const int other = mode(part.functions[b]);
      if (std::abs(other - m) != 1) continue;
      const double coupling = std::min(m, other) == 0 ? std::numbers::sqrt2 / 2 : 0.5;
      across.block(a * n, b * n, n, n) = ((m - other) * coupling * momentum).matrix().asDiagonal();
    }
  }
  const auto scattered = each_part<Real>([&](const auto& of) {
    Matrix all = Matrix::Zero(count * n, count * n);
    for (Eigen::Index a = 0; a < count; ++a)
      all.block(a * n, a * n, n, n) = of(polar_.of_mode(mode(part.functions[a])).*scattering);
    return all;
  });
  const Departure<Number>& departure = slab_.departure;
  return times(departure.extinction(slab_.k_per_mu_t()), extinction) - scattered +
         times(departure.length, across);
}

template <typename Number>
TransportOperatorOf<Number> AzimuthalModesOf<Number>::transport(double q, const Part& part) const {
  const double extinction = std::abs(value_of(slab_.departure.extinction(slab_.k_per_mu_t())));
  return {
      block(q, part, &Scattering::difference), block(q, part, &Scattering::sum),
      part.even * grid_.size(),
      (extinction + std::abs(q)) / *std::min_element(grid_.cosine().begin(), grid_.cosine().end())};
}

/// [azimuth][function]: normalised, times the step of the azimuth.
template <typename Number>
Matrix AzimuthalModesOf<Number>::azimuthal_functions(int steps) const {
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

/// What pairs scatter into the directions of a side, a row each, function by function.
template <typename Number>
RowsOf<Number> AzimuthalModesOf<Number>::fed(const std::vector<SpacePair>& pairs,
                                             const Matrix& directions, const Matrix& azimuthal,
                                             double side) const {
  const auto steps = azimuthal.rows();
  const auto projected = [&](const Eigen::VectorXd& angles, const SpacePair& pair,
                             const auto& part) -> Matrix {
    Matrix values(angles.size(), steps);
    for (Eigen::Index j = 0; j < angles.size(); ++j) {
      const double sine = std::sin(angles[j]), cosine = side * std::cos(angles[j]);
      for (Eigen::Index i = 0; i < steps; ++i) {
        const Eigen::Vector3d to(sine * directions(i, 0), sine * directions(i, 1), cosine);
        values(j, i) = sine * part(slab_.law.pair(pair.first.dot(to), pair.second.dot(to)));
      }
    }
    return product(values, azimuthal);
  };
  const Eigen::Index n = grid_.size(), functions = azimuthal.cols();
  return slab_.albedo * each_part<Number>([&](const auto& part) {
           Rows rows(static_cast<Eigen::Index>(pairs.size()), functions * n);
           for (Eigen::Index i = 0; i < rows.rows(); ++i) {
             const Matrix integrals =
                 polar_.root().cwiseInverse().asDiagonal() *
                 grid_.integrals_of(functions, [&](const Eigen::VectorXd& angles) {
                   return projected(angles, pairs[static_cast<std::size_t>(i)], part);
                 });
             for (Eigen::Index f = 0; f < functions; ++f)
               rows.block(i, f * n, 1, n) =
                   turned(mode(static_cast<int>(f))) * integrals.col(f).transpose();
           }
           return rows;
         });
}

template <typename Number>
auto AzimuthalModesOf<Number>::waves(const Eigen::Vector2d& x,
                                     const std::vector<SpacePair>& pairs) const -> Waves {
  double sine = 0;
  for (const SpacePair& pair : pairs)
    for (const Eigen::Vector3d& direction : {pair.first, pair.second})
      sine = std::max(sine, direction.head<2>().norm());
  // Modes of p beyond l sin(theta) have died out at the angle of a light.
  const int steps =
      2 * highest_ + 32 + static_cast<int>(1.2 * sine * (1 + degree(slab_.law.moments())));
  const Matrix azimuthal = azimuthal_functions(steps);
  Matrix directions(steps, 2);
  for (int i = 0; i < steps; ++i) {
    const double phi = 2 * pi * i / steps, c = std::cos(phi), s = std::sin(phi);
    directions.row(i) << c * x.x() - s * x.y(), c * x.y() + s * x.x();
  }
  return {{}, {}, fed(pairs, directions, azimuthal, 1), fed(pairs, directions, azimuthal, -1)};
}

template <typename Number>
auto AzimuthalModesOf<Number>::ends(const Eigen::Vector2d& x, const std::vector<SpacePair>& lights,
                                    const std::vector<SpacePair>& views) const -> Ends {
  const Waves fed = waves(x, lights), seen = views == lights ? fed : waves(x, views);
  Ends found{fed, {{}, {}, seen.up, seen.down}};
  const double k = slab_.k_per_mu_t();
  for (const SpacePair& pair : lights) add(found.lights, pair_wave(k, pair, slab_.departure));
  for (const SpacePair& pair : views)
    add(found.views, pair_wave(k, turned_round(pair), slab_.departure));
  return found;
}

template <typename Number>
auto AzimuthalModesOf<Number>::part_of(const Waves& all, const Part& part) const -> Waves {
  const Eigen::Index n = grid_.size(), count = part.functions.size();
  const auto taken = [&](const Rows& rows) {
    Rows found(rows.rows(), count * n);
    for (Eigen::Index a = 0; a < count; ++a)
      found.middleCols(a * n, n) = rows.middleCols(part.functions[a] * n, n);
    return found;
  };
  return {all.top, all.bottom, linear(taken, all.down), linear(taken, all.up)};
}

template <typename Number>
Eigen::VectorXd AzimuthalModesOf<Number>::power() const {
  return std::sqrt(2 * pi) * polar_.root();
}

template class AzimuthalModesOf<double>;
template class AzimuthalModesOf<Complex>;
template class AzimuthalModesOf<Dual<double>>;

}  // namespace flatspeckle::mc
