#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Dense>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <doctest/doctest.h>

#include "core/numbers/gauss.h"
#include "core/numbers/hankel_array.h"
#include "wave_solver/layered/layer_green.h"

namespace flatspeckle::wave::test_layer_green {

namespace {

using std::numbers::pi;

constexpr double k = 2 * pi, width = 12;
constexpr Complex imaginary{0, 1};

struct Case {
  Faces faces;
  double depth;
};

/// Layers of higher index, which guide modes, and of lower index, in both polarisations.
std::vector<Case> layers() {
  return {{{1.33, 1, Polarisation::tm}, 4},
          {{1.5, 1, Polarisation::te}, 3},
          {{1, 1.4, Polarisation::tm}, 0.6},
          {{1, 1.4, Polarisation::te}, 0.4}};
}

Complex along(double wavenumber, Complex p) {
  const Complex root = std::sqrt(Complex(wavenumber * wavenumber) - p * p);
  return root.imag() < 0 ? -root : root;
}

Complex free_wave(Vec a, Vec b) {
  Complex h;
  const double x = k * length(a - b);
  hankel0({&x, 1}, {&h, 1});
  return h;
}

Complex reflected_part(const LayerGreen& green, Vec a, Vec b) {
  return a == b ? green(a, b) : green(a, b) - free_wave(a, b);
}

/// Returns, for one transverse wavenumber p, the wave that the faces reflect to z when a plane z =
/// z' emits exp(i kz |z - z'|) / kz. It solves the four conditions of continuity at the faces
/// numerically.
Complex reflected_wave(const LayerWaves& waves, Complex p, double z, double source) {
  const Complex within = along(waves.k(), p), beyond = along(waves.outside_k(), p);
  const double depth = waves.depth(), s = waves.derivative_ratio();
  const Complex across = std::exp(imaginary * within * depth),
                to_near = std::exp(imaginary * within * source) / within,
                to_far = std::exp(imaginary * within * (depth - source)) / within;
  // Unknowns: waves exp(i kz z) and exp(i kz (depth - z)) inside, and both waves outside.
  Eigen::Matrix4cd conditions;
  conditions << 1, across, -1, 0,               // u at z = 0
      within, -within * across, s * beyond, 0,  // derivative at z = 0
      across, 1, 0, -1,                         // u at z = depth
      within * across, -within, 0, -s * beyond;
  const Eigen::Vector4cd sides(-to_near, within * to_near, -to_far, -within * to_far);
  const Eigen::Vector4cd found = conditions.partialPivLu().solve(sides);
  return found(0) * std::exp(imaginary * within * z) +
         found(1) * std::exp(imaginary * within * (depth - z));
}

/// Returns the reflected part of -4 i G by adaptive quadrature along another contour.
Complex by_quadrature(const LayerWaves& waves, Vec a, Vec b) {
  const double most = 1.5 * std::max(waves.k(), waves.outside_k()),
               nearest = std::min(a.z + b.z, 2 * waves.depth() - a.z - b.z);
  const auto line = [&](Complex from, Complex to) {
    const int panels = 1 + static_cast<int>(std::abs(to - from) / 3);
    const Complex step = (to - from) / double(panels);
    Complex sum = 0;
    for (int j = 0; j < panels; ++j) {
      const auto integrand = [&](double t) {
        const Complex p = from + (j + t) * step;
        return std::cos(p * (a.x - b.x)) * reflected_wave(waves, p, b.z, a.z) * step;
      };
      using Rule = boost::math::quadrature::gauss_kronrod<double, 31>;
      sum += Rule::integrate(integrand, 0.0, 1.0, 6, 1e-9);
    }
    return sum;
  };
  const Complex low(0.4, -0.3), high(most, -0.3);
  const double end = std::max(1.2 * most, 25 / nearest);
  return 2 / pi * (line(0, low) + line(low, high) + line(high, 1.2 * most) + line(1.2 * most, end));
}

/// Returns the contribution of the guided modes to the real part of -4 i G: the sum of 2 u(a) u(b)
/// cos(p (a.x - b.x)) / (p N) over the modes u with norm N.
double guided(const LayerWaves& waves, Vec a, Vec b) {
  const double within = waves.k(), beyond = waves.outside_k(), depth = waves.depth(),
               s = waves.derivative_ratio();
  if (within <= beyond) return 0;
  double sum = 0;
  const double most = std::sqrt(within * within - beyond * beyond);
  for (int m = 0; m * pi / depth < most; ++m) {
    // Bisection of the phase kz depth - m pi - 2 atan(s decay / kz).
    double low = m * pi / depth, high = std::min(most, (m + 1) * pi / depth);
    for (int step = 0; step < 100; ++step) {
      const double z = (low + high) / 2, decay = std::sqrt(most * most - z * z);
      (z * depth - m * pi - 2 * std::atan2(s * decay, z) < 0 ? low : high) = z;
    }
    const double z = (low + high) / 2, p = std::sqrt(within * within - z * z),
                 decay = std::sqrt(p * p - beyond * beyond);
    const auto mode = [&](double at) { return std::cos(z * (at - depth / 2) + m * pi / 2); };
    const double norm = depth / 2 + std::cos(m * pi) * std::sin(z * depth) / (2 * z) +
                        s * mode(0) * mode(0) / decay;
    sum += 2 / (p * norm) * mode(a.z) * mode(b.z) * std::cos(p * (a.x - b.x));
  }
  return sum;
}

/// Returns the contribution of the radiated waves to the real part of -4 i G: the integral of the
/// product of the far fields of both points.
double radiated(const LayerWaves& waves, Vec a, Vec b) {
  const QuadratureRule rule = gauss_legendre(300);
  double sum = 0;
  for (const double start : {-pi / 2, pi / 2})
    for (std::size_t j = 0; j < rule.node.size(); ++j) {
      const double angle = start + pi * rule.node[j];
      sum += pi * rule.weight[j] *
             (waves.emitted(angle, a) * std::conj(waves.emitted(angle, b))).real();
    }
  return waves.derivative_ratio() * waves.outside_k() / 4 * sum;
}

}  // namespace

TEST_CASE("layer Green function: agrees with quadrature of numerically matched waves") {
  for (const Case& layer : layers()) {
    const Faces faces = layer.faces;
    const double depth = layer.depth;
    const LayerWaves waves(faces, k, depth);
    const LayerGreen green(waves, width);
    const std::vector<std::array<Vec, 2>> pairs = {{Vec{0, 0.5 * depth}, {0, 0.5 * depth}},
                                                   {Vec{0, 0.3 * depth}, {3.1, 0.4 * depth}},
                                                   {Vec{0, 0.9 * depth}, {width, 0.2 * depth}},
                                                   {Vec{0, 0.05}, {-0.1, 0.07}},
                                                   {Vec{2, depth - 0.08}, {2.2, depth - 0.03}}};
    for (const auto& pair : pairs) {
      const Vec a = pair[0], b = pair[1];
      const Complex expected = by_quadrature(waves, a, b), found = reflected_part(green, a, b);
      CAPTURE(faces.inside);
      CAPTURE(a.z);
      CAPTURE(b.x);
      CHECK(std::abs(found - expected) < 1e-7);
    }
    for (const Vec a : {Vec{0, 0.01}, {0, depth - 0.003}}) {  // close to a face
      const Vec b{0.01, a.z};
      CHECK(std::abs(reflected_part(green, a, b) - by_quadrature(waves, a, b)) <
            LayerGreen::accuracy);
    }
  }
}

TEST_CASE("layer Green function: power of a source equals that of radiation and guided modes") {
  for (const Case& layer : layers()) {
    const Faces faces = layer.faces;
    const double depth = layer.depth;
    const LayerWaves waves(faces, k, depth);
    const LayerGreen green(waves, width);
    for (const Vec a : {Vec{0, 0.13 * depth}, {1, 0.6 * depth}})
      for (const Vec b : {a, Vec{0.4, 0.9 * depth}, {-8.3, 0.2 * depth}}) {
        const double power =
            reflected_part(green, a, b).real() + std::cyl_bessel_j(0, k * length(a - b));
        CAPTURE(faces.inside);
        CAPTURE(b.x);
        CHECK(std::abs(power - radiated(waves, a, b) - guided(waves, a, b)) < 1e-7);
      }
  }
}

TEST_CASE("layer Green function: satisfies the wave equation by finite differences") {
  const double weight[] = {-49.0 / 18, 1.5, -0.15, 1.0 / 90}, step = 0.02;
  for (const Case& layer : layers()) {
    const Faces faces = layer.faces;
    const double depth = layer.depth;
    const LayerGreen green(LayerWaves(faces, k, depth), width);
    const Vec a{0.3, 0.25 * depth}, b{2.9, 0.4 * depth};
    Complex sum = 2 * weight[0] * green(a, b);
    for (int j = 1; j <= 3; ++j)
      for (const Vec axis : {Vec{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
        sum += weight[j] * green(a, b + j * step * axis);
    CHECK(std::abs(sum / (step * step) + k * k * green(a, b)) < 2e-5 * k * k);
    CHECK(green(a, b) == green(b, a));
  }
}

TEST_CASE("layer Green function: without a contrast it is the Hankel function H_0") {
  const LayerGreen green(LayerWaves({1.4, 1.4, Polarisation::te}, k, 5), width);
  const Vec a{0, 1}, b{4, 3.7};
  CHECK(green(a, b) == free_wave(a, b));
  CHECK(green(a, a) == Complex(0));
}

}  // namespace flatspeckle::wave::test_layer_green
