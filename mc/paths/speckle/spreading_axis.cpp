#include "mc/paths/speckle/spreading_axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/numbers/gauss.h"

namespace flatspeckle::mc {

namespace {

/// Returns the angle of Chebyshev node a.
double angle_of_node(std::size_t a, std::size_t count) {
  return (2 * static_cast<double>(a) + 1) / (2 * static_cast<double>(count)) * std::numbers::pi;
}

/// Kernel of exponential of a semicircle, 1 at 0 and nearly 0 at t = 1.
double spreading_kernel(double t, int width) {
  return std::exp(2.3 * width * (std::sqrt(std::max(0.0, 1 - t * t)) - 1));
}

}  // namespace

std::vector<double> chebyshev_nodes(std::size_t count) {
  std::vector<double> node;
  for (std::size_t a = 0; a < count; ++a) node.push_back(std::cos(angle_of_node(a, count)));
  return node;
}

std::vector<double> lagrange(const std::vector<double>& node, double t) {
  std::vector<double> value;
  double sum = 0;
  for (std::size_t a = 0; a < node.size(); ++a) {
    const double distance = t - node[a];
    if (distance == 0) {
      std::vector<double> one(node.size());
      one[a] = 1;
      return one;
    }
    value.push_back((a % 2 == 0 ? 1 : -1) * std::sin(angle_of_node(a, node.size())) / distance);
    sum += value.back();
  }
  for (double& v : value) v /= sum;
  return value;
}

SpreadingAxis::SpreadingAxis(double low, double high, double bandwidth, int width) : width_(width) {
  // Twice as many points as the bandwidth requires
  const double longest = std::max(high - low, 1e-6);
  step_ = std::min(std::numbers::pi / bandwidth, 4 * longest);
  origin_ = low - step_ * width / 2.0;
  size_ =
      static_cast<std::size_t>(std::ceil(longest / step_)) + static_cast<std::size_t>(width) + 1;
}

std::size_t SpreadingAxis::spread(double x, std::span<double> weights) const {
  const double position = (x - origin_) / step_, first = std::ceil(position - width_ / 2.0);
  for (int i = 0; i < width_; ++i)
    weights[static_cast<std::size_t>(i)] =
        spreading_kernel(2 * (first + i - position) / width_, width_);
  return static_cast<std::size_t>(std::clamp(first, 0.0, static_cast<double>(size_) - width_));
}

double SpreadingAxis::transform(double wavenumber) const {
  static const QuadratureRule rule = gauss_legendre(40);  // on [0, 1]
  double sum = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i)
    sum += width_ * rule.weight[i] * spreading_kernel(rule.node[i], width_) *
           std::cos(wavenumber * step_ * rule.node[i] * width_ / 2);
  return sum;
}

std::vector<Complex> SpreadingAxis::to_pixels(const FarCamera& camera, double axis_cosine, double k,
                                              const std::vector<double>& node) const {
  std::vector<Complex> all;
  all.reserve(camera.pixels * node.size() * size_);
  for (std::size_t p = 0; p < camera.pixels; ++p) {
    const double off = camera.cosine(axis_cosine, p) - axis_cosine, scale = 1 / transform(k * off);
    const auto interpolated = lagrange(node, off / camera.aperture);
    for (std::size_t i = 0; i < size_; ++i) {
      const Complex phase = std::polar(scale, -k * off * at(i));
      for (const double at_node : interpolated) all.push_back(phase * at_node);
    }
  }
  return all;
}

double SpreadingAxis::error(int width) {
  constexpr int positions = 8, wavenumbers = 16;
  constexpr double bandwidth = 2;  // wavenumbers from -1 to 1
  const SpreadingAxis axis(0, 20, bandwidth, width);
  std::array<double, widest> weights;
  double sum = 0;
  for (int p = 0; p < positions; ++p)
    for (int q = 0; q < wavenumbers; ++q) {
      const double x = 10 + axis.step_ * (p + 0.5) / positions,
                   wavenumber = (2 * q + 1.0) / wavenumbers - 1;
      const std::size_t first = axis.spread(x, weights);
      Complex found = 0;
      for (std::size_t i = 0; i < static_cast<std::size_t>(width); ++i)
        found += weights[i] * std::polar(1.0, wavenumber * (x - axis.at(first + i)));
      sum += std::norm(found / axis.transform(wavenumber) - 1.0);
    }
  return std::sqrt(sum / (positions * wavenumbers));
}

}  // namespace flatspeckle::mc
