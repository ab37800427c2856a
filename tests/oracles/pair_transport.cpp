#include "tests/oracles/pair_transport.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "bench/oracles/quadrature.h"
#include "core/numbers/blas.h"

namespace flatspeckle::oracles {

namespace {

using std::numbers::pi;

/// Returns int_0^depth exp(-s a - (depth - s) b) ds.
Complex overlap(Complex a, Complex b, double depth) {
  const Complex half = (a - b) * depth / 2.0, middle = std::exp(-(a + b) * depth / 2.0);
  if (std::abs(half) < 1e-3) return depth * middle * (1.0 + half * half / 6.0);
  return (std::exp(-b * depth) - std::exp(-a * depth)) / (a - b);
}

}  // namespace

PairTransport::PairTransport(const Medium& medium, const std::vector<Pair>& lights,
                             const std::vector<Pair>& views, int panels)
    : medium_(medium), lights_(lights.size()) {
  openblas_set_num_threads(1);  // the matrices are small, and tests run in parallel
  add_nodes(medium.k * (std::sin(lights[0].first) - std::sin(lights[0].second)), panels);
  for (const Pair& pair : lights) add_pair(pair);
  for (const Pair& pair : views) add_pair(pair);
  scale_phase();
  constexpr int doublings = 36;  // double scattering is neglected in the thinnest layer
  double optical_depth = std::ldexp(medium_.mu_t * medium_.depth, -doublings);
  slab_ = thin_layer(optical_depth);
  for (int i = 0; i < doublings; ++i, optical_depth *= 2) slab_ = doubled(slab_, optical_depth);
}

/// Adds nodes, which are denser towards grazing angles, where the radiance near the faces has a
/// logarithmic singularity.
void PairTransport::add_nodes(double q, int panels) {
  GaussPanels unit;
  unit.add(0, 1, panels);
  for (std::size_t i = 0; i < unit.node.size(); ++i) {
    const double y = unit.node[i], complement = pi / 2 * y * y, cosine = std::sin(complement);
    for (const double side : {-1.0, 1.0}) {
      const double angle = side * (pi / 2 - complement);
      const Complex rate = Complex(1, q / medium_.mu_t * std::sin(angle)) / cosine;
      ordinates_.push_back({{angle, angle}, pi * y * unit.weight[i], 1 / cosine, rate});
    }
  }
  nodes_ = ordinates_.size();
}

void PairTransport::add_pair(Pair angles) {
  const double first = std::cos(angles.first), second = std::cos(angles.second);
  const Complex rate((1 / first + 1 / second) / 2, -medium_.k / medium_.mu_t * (first - second));
  ordinates_.push_back({angles, 0, 1, rate});
}

/// Returns the geometric mean of the phase function over both members of the pairs.
double PairTransport::phase_element(std::size_t out, std::size_t in, bool backward) const {
  const auto one = [&](double to, double from) {
    return medium_.phase((backward ? pi - to : to) - from);
  };
  const Ordinate &to = ordinates_[out], &from = ordinates_[in];
  return to.scale * from.scale *
         std::sqrt(one(to.angles.first, from.angles.first) *
                   one(to.angles.second, from.angles.second));
}

/// Scales the matrix symmetrically until every direction, and the first of every pair, scatters
/// with probability 1.
void PairTransport::scale_phase() {
  const std::size_t n = ordinates_.size();
  std::vector<double> scattered(n * nodes_);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < nodes_; ++j) {
      const double to = ordinates_[i].angles.first, from = ordinates_[j].angles.first;
      scattered[i * nodes_ + j] =
          ordinates_[j].weight * (medium_.phase(to - from) + medium_.phase(pi - to - from));
    }
  for (int iteration = 0; iteration < 50; ++iteration) {
    const auto before = ordinates_;
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < nodes_; ++j) sum += scattered[i * nodes_ + j] * before[j].scale;
      // the geometric mean of old and new values, because plain iteration would oscillate
      ordinates_[i].scale = i < nodes_ ? std::sqrt(before[i].scale / sum) : 1 / sum;
    }
  }
}

PairTransport::Layer PairTransport::thin_layer(double optical_depth) const {
  const std::size_t n = ordinates_.size();
  Layer layer{Matrix(n * n), Matrix(n * n)};
  for (std::size_t i = 0; i < n; ++i) {
    const Complex out = ordinates_[i].rate;
    const double share = medium_.albedo * ordinates_[i].per_cosine;
    for (std::size_t j = 0; j < n; ++j) {
      const Complex in = ordinates_[j].rate;
      layer.reflected[i * n + j] =
          share * phase_element(i, j, true) * overlap(in + out, 0, optical_depth);
      layer.transmitted[i * n + j] =
          share * phase_element(i, j, false) * overlap(in, out, optical_depth);
    }
  }
  return layer;
}

PairTransport::Matrix PairTransport::weighted(const Matrix& a) const {
  Matrix result = a;
  const std::size_t n = ordinates_.size();
  for (std::size_t i = 0; i < a.size(); ++i) result[i] *= ordinates_[i % n].weight;
  return result;
}

PairTransport::Matrix PairTransport::product(const Matrix& a, const Matrix& b) const {
  Matrix c(a.size());
  const auto n = static_cast<blasint>(ordinates_.size());
  const Complex one = 1, zero = 0;
  cblas_zgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, n, n, n, &one, a.data(), n, b.data(), n,
              &zero, c.data(), n);
  return c;
}

/// Returns (1 - a)^-1 b.
PairTransport::Matrix PairTransport::solve_one_minus(Matrix a, Matrix b) const {
  const std::size_t n = ordinates_.size();
  for (Complex& element : a) element = -element;
  for (std::size_t i = 0; i < n; ++i) a[i * n + i] += 1;
  const auto size = static_cast<lapack_int>(n);
  std::vector<lapack_int> pivots(n);
  if (LAPACKE_zgesv(LAPACK_ROW_MAJOR, size, size, a.data(), size, pivots.data(), b.data(), size))
    throw std::runtime_error("singular");
  return b;
}

/// Combines two layers of equal optical depth.
PairTransport::Layer PairTransport::doubled(const Layer& half, double optical_depth) const {
  const std::size_t n = ordinates_.size();
  std::vector<Complex> direct;
  for (const Ordinate& ordinate : ordinates_)
    direct.push_back(std::exp(-optical_depth * ordinate.rate));
  const auto by_in = [&](Matrix a) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] *= direct[i % n];
    return a;
  };
  const auto plus = [](Matrix a, const Matrix& b) {
    std::transform(a.begin(), a.end(), b.begin(), a.begin(), std::plus());
    return a;
  };
  const auto plus_by_out = [&](Matrix a, const Matrix& b) {
    for (std::size_t i = 0; i < a.size(); ++i) a[i] += direct[i / n] * b[i];
    return a;
  };
  const auto& [r, t] = half;
  const Matrix rw = weighted(r), tw = weighted(t);
  const Matrix there_and_back = solve_one_minus(product(rw, rw), product(rw, r));
  const Matrix down = plus(plus(t, by_in(there_and_back)), product(weighted(there_and_back), t));
  const Matrix up = plus(by_in(r), product(rw, down));
  return {plus(plus_by_out(r, up), product(tw, up)),
          plus(plus_by_out(by_in(t), down), product(tw, down))};
}

Complex PairTransport::covariance(std::size_t lights, std::size_t views) const {
  const std::size_t n = ordinates_.size(), view = nodes_ + lights_ + views;
  const Pair angles = ordinates_[view].angles;
  const double phase =
      -medium_.k * medium_.depth * (std::cos(angles.first) - std::cos(angles.second));
  return std::polar(1.0, phase) * slab_.transmitted[view * n + nodes_ + lights];
}

}  // namespace flatspeckle::oracles
