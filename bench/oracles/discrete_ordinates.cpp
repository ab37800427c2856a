#include "bench/oracles/discrete_ordinates.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "core/numbers/blas.h"

namespace flatspeckle::oracles {

namespace {

using std::numbers::pi;
using Matrix = std::vector<double>;  ///< n x n, row-major

Matrix matrix_product(const Matrix& a, const Matrix& b, std::size_t n) {
  Matrix c(n * n);
  const auto size = static_cast<blasint>(n);
  cblas_dgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, size, size, size, 1, a.data(), size,
              b.data(), size, 0, c.data(), size);
  return c;
}

Matrix columns_times(Matrix a, const std::vector<double>& factor) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] *= factor[i % factor.size()];
  return a;
}

Matrix rows_times(const std::vector<double>& factor, Matrix a) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] *= factor[i / factor.size()];
  return a;
}

Matrix operator+(Matrix a, const Matrix& b) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += b[i];
  return a;
}

/// Returns (1 - a)^-1 b.
Matrix solve_one_minus(Matrix a, Matrix b, std::size_t n) {
  for (double& element : a) element = -element;
  for (std::size_t i = 0; i < n; ++i) a[i * n + i] += 1;
  const auto size = static_cast<lapack_int>(n);
  std::vector<lapack_int> pivots(n);
  if (LAPACKE_dgesv(LAPACK_ROW_MAJOR, size, size, a.data(), size, pivots.data(), b.data(), size))
    throw std::runtime_error("singular");
  return b;
}

/// Returns int_0^depth exp(-s a - (depth - s) b) ds.
double overlap(double a, double b, double depth) {
  const double difference = (a - b) * depth;
  if (std::abs(difference) < 1e-5)
    return depth * std::exp(-(a + b) * depth / 2) * (1 + difference * difference / 24);
  return std::exp(-std::min(a, b) * depth) * -std::expm1(-std::abs(difference)) / std::abs(a - b);
}

double folded(double angle) {
  const double from_z = std::abs(std::remainder(angle, 2 * pi));
  return std::min(from_z, pi - from_z);
}

/// Nodes and weights of Gauss-Legendre quadrature on (0, 1), by Newton steps on the recurrence.
void gauss_legendre(int n, std::vector<double>& node, std::vector<double>& weight) {
  for (int i = 0; i < n; ++i) {
    double x = std::cos(pi * (i + 0.75) / (n + 0.5)), derivative = 1;
    for (int step = 0; step < 20; ++step) {
      double p = x, before = 1;
      for (int degree = 2; degree <= n; ++degree)
        before = std::exchange(p, ((2 * degree - 1) * x * p - (degree - 1) * before) / degree);
      derivative = n * (x * p - before) / (x * x - 1);
      x -= p / derivative;
    }
    node.push_back((1 + x) / 2);
    weight.push_back(1 / ((1 - x * x) * derivative * derivative));
  }
}

}  // namespace

std::function<double(double)> henyey_greenstein(double g) {
  return [g](double angle) {
    const double half = std::sin(angle / 2);
    return (1 - g) * (1 + g) / (2 * pi * ((1 - g) * (1 - g) + 4 * g * half * half));
  };
}

SlabTransport::SlabTransport(const std::vector<Medium>& layers, const std::vector<double>& angles,
                             int nodes) {
  openblas_set_num_threads(1);  // the matrices are small, and tests run in parallel
  std::vector<double> y, weight;
  gauss_legendre(nodes, y, weight);
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double complement = pi / 2 * y[i] * y[i];
    add_node(pi / 2 - complement, complement, pi * y[i] * weight[i]);
  }
  for (const double angle : angles)
    if (!find(angle)) add_node(folded(angle), pi / 2 - folded(angle), 0);
  for (std::size_t i = 0; i < layers.size(); ++i) {
    medium_ = layers[i];
    scale_phase();
    const auto add = [&](Stack& stack, int parity) {
      const Layer layer = slab(parity);
      const Stack own{medium_.optical_depth, layer, layer};
      stack = i == 0 ? own : added(stack, own);
    };
    add(even_, 1);
    add(odd_, -1);
  }
}

void SlabTransport::add_node(double angle, double complement, double weight) {
  angle_.push_back(angle);
  cosine_.push_back(std::sin(complement));
  weight_.push_back(weight);
}

/// Returns p(theta_i - theta_j) + parity p(theta_i + theta_j); the outgoing angle is measured from
/// -z if backward.
double SlabTransport::phase_element(std::size_t i, std::size_t j, bool backward, int parity) const {
  const double out = backward ? pi - angle_[i] : angle_[i];
  return scale_[i] * scale_[j] *
         (medium_.phase(out - angle_[j]) + parity * medium_.phase(out + angle_[j]));
}

/// Scales the matrix symmetrically until every direction, weight 0 included, scatters with
/// probability 1.
void SlabTransport::scale_phase() {
  const std::size_t n = angle_.size();
  scale_.assign(n, 1);
  Matrix scattered(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      scattered[i * n + j] =
          weight_[j] * (phase_element(i, j, false, 1) + phase_element(i, j, true, 1));
  for (int iteration = 0; iteration < 50; ++iteration) {
    const auto before = scale_;
    for (std::size_t i = 0; i < n; ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < n; ++j) sum += scattered[i * n + j] * before[j];
      // the geometric mean damps oscillations of the iteration
      scale_[i] = weight_[i] > 0 ? std::sqrt(before[i] / sum) : 1 / sum;
    }
  }
}

SlabTransport::Layer SlabTransport::thin_layer(double optical_depth, int parity) const {
  const std::size_t n = angle_.size();
  Layer layer{Matrix(n * n), Matrix(n * n)};
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      const double out = 1 / cosine_[i], in = 1 / cosine_[j], share = medium_.albedo * out;
      layer.reflected[i * n + j] = share * phase_element(i, j, true, parity) *
                                   -std::expm1(-optical_depth * (in + out)) / (in + out);
      layer.transmitted[i * n + j] =
          share * phase_element(i, j, false, parity) * overlap(in, out, optical_depth);
    }
  }
  return layer;
}

/// Adds two layers of equal optical depth.
SlabTransport::Layer SlabTransport::doubled(const Layer& half, double optical_depth) const {
  const std::size_t n = angle_.size();
  const auto direct = this->direct(optical_depth);
  const auto& [r, t] = half;
  const Matrix rw = columns_times(r, weight_), tw = columns_times(t, weight_);
  const Matrix there_and_back =
      solve_one_minus(matrix_product(rw, rw, n), matrix_product(rw, r, n), n);
  const Matrix down = t + columns_times(there_and_back, direct) +
                      matrix_product(columns_times(there_and_back, weight_), t, n);
  const Matrix up = columns_times(r, direct) + matrix_product(rw, down, n);
  return {r + rows_times(direct, up) + matrix_product(tw, up, n),
          rows_times(direct, down) + columns_times(t, direct) + matrix_product(tw, down, n)};
}

std::vector<double> SlabTransport::direct(double optical_depth) const {
  std::vector<double> direct;
  for (const double cosine : cosine_) direct.push_back(std::exp(-optical_depth / cosine));
  return direct;
}

/// Adds two different layers. Downward radiance between them is the light transmitted by the upper
/// layer plus the light that layer reflects back from below.
SlabTransport::Stack SlabTransport::added(const Stack& upper, const Stack& lower) const {
  const std::size_t n = angle_.size();
  const auto from = [&](const Layer& first, const Layer& first_behind, double first_depth,
                        const Layer& second, double second_depth) {
    const auto through_first = direct(first_depth), through_second = direct(second_depth);
    const Matrix back = columns_times(first_behind.reflected, weight_),
                 forth = columns_times(second.reflected, weight_);
    const Matrix on = solve_one_minus(
        matrix_product(back, forth, n),
        first.transmitted + matrix_product(back, columns_times(second.reflected, through_first), n),
        n);
    const Matrix returned =
        columns_times(second.reflected, through_first) + matrix_product(forth, on, n);
    return Layer{first.reflected + rows_times(through_first, returned) +
                     matrix_product(columns_times(first_behind.transmitted, weight_), returned, n),
                 rows_times(through_second, on) + columns_times(second.transmitted, through_first) +
                     matrix_product(columns_times(second.transmitted, weight_), on, n)};
  };
  return {upper.optical_depth + lower.optical_depth,
          from(upper.above, upper.below, upper.optical_depth, lower.above, lower.optical_depth),
          from(lower.below, lower.above, lower.optical_depth, upper.below, upper.optical_depth)};
}

SlabTransport::Layer SlabTransport::slab(int parity) const {
  constexpr int doublings =
      46;  // double scattering in the first layer is neglected: 1e-14 of the optical depth
  double optical_depth = std::ldexp(medium_.optical_depth, -doublings);
  Layer layer = thin_layer(optical_depth, parity);
  for (int i = 0; i < doublings; ++i, optical_depth *= 2) layer = doubled(layer, optical_depth);
  return layer;
}

std::optional<std::size_t> SlabTransport::find(double angle) const {
  const auto same = [&](double other) { return std::abs(other - folded(angle)) < 1e-12; };
  const auto found = std::find_if(angle_.begin(), angle_.end(), same);
  if (found == angle_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - angle_.begin());
}

/// Returns power through a face over incident power; the even radiance contains both signs of
/// theta.
double SlabTransport::flux(const Matrix& radiance, double light) const {
  const std::size_t n = angle_.size(), in = find(light).value();
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += weight_[i] * cosine_[i] * radiance[i * n + in];
  return sum / cosine_[in];
}

double SlabTransport::reflectance(double light) const {
  return flux(even_.above.reflected, light);
}

double SlabTransport::transmittance(double light) const {
  return flux(even_.above.transmitted, light);
}

double SlabTransport::direct_transmittance(double light) const {
  return std::exp(-even_.optical_depth / std::cos(light));
}

double SlabTransport::radiance(double light, double view) const {
  const std::size_t at = find(view).value() * angle_.size() + find(light).value();
  const bool through = std::cos(view) > 0;
  const double even = through ? even_.above.transmitted[at] : even_.above.reflected[at];
  const double odd = through ? odd_.above.transmitted[at] : odd_.above.reflected[at];
  const double same_side = std::sin(light) * std::sin(view) >= 0 ? 1 : -1;
  return (even + same_side * odd) / 2;
}

double SlabTransport::covariance_without_reversed(double light, double view) const {
  return std::abs(std::cos(view)) * radiance(light, view);
}

}  // namespace flatspeckle::oracles
