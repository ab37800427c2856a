#include <cmath>
#include <functional>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/bessel.h"
#include "reference.h"
#include "wave_solver/equations/cylinder_waves.h"

namespace flatspeckle::wave::test_cylinder_waves {

namespace {

// Returns unit waves 0, cos 1, sin 1, .. order.
std::vector<Mode> unit_modes(int order) {
  std::vector<Mode> modes{{0, false, root_half}};
  for (int n = 1; n <= order; ++n)
    for (const bool odd : {false, true}) modes.push_back({n, odd, 1});
  return modes;
}

double turn(const Mode& mode, double phi) {
  const double angle = mode.order * phi, size = std::sqrt(2) * static_cast<double>(mode.weight);
  return size * (mode.odd ? std::sin(angle) : std::cos(angle));
}

Complex outgoing(const Mode& mode, double k, Vec d) {
  const auto h = hankel(mode.order, k * length(d));
  return Complex(h[mode.order]) * turn(mode, angle_of(d));
}

double regular(const Mode& mode, double k, Vec d) {
  const auto j = bessel_j(mode.order, k * length(d));
  return static_cast<double>(j[mode.order]) * turn(mode, angle_of(d));
}

constexpr double k = 3;
const Vec here{0.3, -0.2}, there{1.1, 1.4};

}  // namespace

TEST_CASE("translation: the expansion about the receiver agrees with the outgoing wave") {
  const auto sent = unit_modes(4), received = unit_modes(30);
  const ModeSet sender{here, sent, 4}, receiver{there, received, 30};
  std::vector<Complex> block(sent.size() * received.size());
  translate(k, {&receiver, 1}, sender, {block.data(), received.size()});
  for (const Vec offset : {Vec{0.2, 0.1}, Vec{-0.3, 0.25}, Vec{0.01, -0.4}})
    for (std::size_t n = 0; n < sent.size(); ++n) {
      Complex sum = 0;
      for (std::size_t p = 0; p < received.size(); ++p)
        sum += block[n * received.size() + p] * regular(received[p], k, offset);
      const Complex exact = outgoing(sent[n], k, there + offset - here);
      CAPTURE(n);
      CHECK(std::abs(sum - exact) < 1e-11 * std::abs(exact));
    }
}

TEST_CASE("translation: the reverse translation is the transpose") {
  const auto modes = unit_modes(6);
  const ModeSet a{here, modes, 6}, b{there, modes, 6};
  const std::size_t n = modes.size();
  std::vector<Complex> forth(n * n), back(n * n);
  translate(k, {&b, 1}, a, {forth.data(), n});
  translate(k, {&a, 1}, b, {back.data(), n});
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      CHECK(std::abs(forth[j * n + i] - back[i * n + j]) <
            1e-13 * std::abs(forth[j * n + i]) + 1e-15);
}

TEST_CASE("outgoing modes: values and derivatives agree with series and finite differences") {
  const auto modes = unit_modes(5);
  const ModeSet sender{here, modes, 5};
  const std::vector<Vec> points{there, {-1, 0.5}, {0.4, -0.1}};
  const std::vector<Vec> along{direction(0.3), direction(2), direction(-1)};
  std::vector<Complex> value(points.size() * modes.size()), derivative(value.size());
  field_at(k, points, sender, {value.data(), points.size()});
  directional_derivatives(k, points, along, sender, {derivative.data(), points.size()});
  const double step = 1e-5;
  for (std::size_t n = 0; n < modes.size(); ++n)
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto field = [&](double s) {
        return outgoing(modes[n], k, points[i] + s * along[i] - here);
      };
      const std::size_t at = n * points.size() + i;
      const double size = static_cast<double>(
          std::abs(hankel(modes[n].order, k * length(points[i] - here)).back()));
      CHECK(std::abs(value[at] - field(0)) < 1e-13 * size);
      const Complex difference = (field(step) - field(-step)) / (2 * step * k);
      CHECK(std::abs(derivative[at] - difference) < 1e-6 * std::abs(derivative[at]) + 1e-7);
    }
}

TEST_CASE("translation: correct results although H_n exceeds double precision at large orders") {
  const int order = 120;  // |H_240(0.3)| is 1e660
  std::vector<Mode> modes = unit_modes(order);
  const auto j = bessel_j(order, 0.1);
  for (Mode& mode : modes) mode.weight *= std::abs(j[mode.order]);
  const ModeSet a{{0, 0}, modes, order}, b{{0.3 / k, 0}, modes, order};
  const std::size_t n = modes.size();
  std::vector<Complex> block(n * n);
  translate(k, {&b, 1}, a, {block.data(), n});
  // Statics: J_p H_{n+p} J_n -> (n+p)! / (n! p!) (x/r)^{n+p} / (pi (n+p)) of the size parameters.
  const int p = order;
  const Complex element = block[(2 * p - 1) * n + (2 * p - 1)];
  const double expected =
      std::exp(std::lgamma(2 * p) - 2 * std::lgamma(p + 1) + 2 * p * std::log(0.1 / 0.3)) /
      std::numbers::pi;
  CHECK(std::abs(element) == doctest::Approx(expected).epsilon(1e-3));
  const std::vector<Mode> bare = unit_modes(2500);
  const ModeSet c{{0, 0}, bare, 2500}, d{{1e-6, 0}, bare, 2500};
  std::vector<Complex> unused(bare.size() * bare.size());
  CHECK_THROWS_AS(translate(k, {&d, 1}, c, {unused.data(), bare.size()}), InputError);
}

TEST_CASE("translation: a receiver at the sender's position gets 0") {
  for (const int order : {0, 2}) {
    const auto modes = unit_modes(order);
    const ModeSet set{here, modes, order};
    std::vector<Complex> block(modes.size() * modes.size(), 1);
    translate(k, {&set, 1}, set, {block.data(), modes.size()});
    for (const Complex& element : block) CHECK(element == 0.0);
  }
}

}  // namespace flatspeckle::wave::test_cylinder_waves
