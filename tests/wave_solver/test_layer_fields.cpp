#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <doctest/doctest.h>

#include "core/error.h"
#include "core/numbers/gauss.h"
#include "core/numbers/random.h"
#include "wave_solver/layered/layer_fields.h"
#include "wave_solver/solutions/ensemble.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave::test_layer_fields {

namespace {

using std::numbers::pi;

constexpr double k = 2 * pi, width = 6, depth = 4;
constexpr Complex imaginary{0, 1};

Placement points(std::size_t count, double phase_shift = 1.1) {
  RandomStream random(5, 2, 0);
  Placement placement(count);
  for (auto& [place, scatterer] : placement) {
    place = {width * (random.uniform() - 0.5), depth * random.uniform()};
    scatterer.phase_shift = phase_shift;
  }
  return placement;
}

/// Returns the amplitudes with which the empty layer transmits and reflects a plane wave, phase
/// origin r = 0, from the 4 x 4 system's elimination known as the Airy formula.
std::pair<Complex, Complex> empty_layer(const LayerWaves& waves, double angle) {
  const double p = waves.outside_k() * std::sin(angle);
  const Complex within = waves.inside(p), beyond = waves.outside(p),
                across = std::exp(imaginary * within * waves.depth()), r = waves.reflected(p),
                around = 1.0 - r * r * across * across;
  return {(1.0 - r * r) * across * std::exp(-imaginary * beyond * waves.depth()) / around,
          -r * (1.0 - across * across) / around};
}

Scene layer_scene(const std::string& scatterer) {
  SceneSpec spec;
  spec.width = width;
  spec.depth = depth;
  spec.density = 1;
  spec.scatterer = scatterer;
  if (scatterer != "point") spec.radius = 0.1;
  Scene scene = make_scene(spec);
  scene.faces = Faces{1.33, 1, Polarisation::tm};
  scene.request = intensity_request({0.1}, {far_view(0.5)});
  return scene;
}

}  // namespace

TEST_CASE("layer fields: without a contrast they agree with the solver of a homogeneous medium") {
  const std::vector<double> lights{0.3, -2.8}, views{0.1, 1.4, 3.0};
  const Placement placement = points(40);
  const auto expected =
      solve(placement, k, lights, {.tolerance = 1e-12, .sensors = {}}).fields(far_views(views));
  const auto found =
      LayerFields(LayerWaves({1.5, 1.5, Polarisation::te}, k, depth), width, lights, views)
          .of(placement);
  REQUIRE(found.size() == expected.size());
  for (std::size_t j = 0; j < found.size(); ++j)
    CHECK(std::abs(found[j] - expected[j]) < 1e-10 * std::abs(expected[j]));
}

TEST_CASE("layer fields: one and two points agree with closed forms") {
  const LayerWaves waves({1.4, 1, Polarisation::tm}, k, depth);
  const LayerGreen green(waves, width);
  const double light = 0.4, view = 2.7;
  const LayerFields fields(waves, width, {light}, {view});
  const Placement pair = points(2);
  const Vec a = pair[0].position, b = pair[1].position;
  const Complex inverse = 1.0 / static_cast<Complex>(t_matrix(pair[0].scatterer, k, 0).front());
  const Complex at_a = waves.illuminated(light, a), at_b = waves.illuminated(light, b),
                from_a = waves.emitted(view, a), from_b = waves.emitted(view, b),
                own_a = inverse - green(a, a), own_b = inverse - green(b, b), both = green(a, b);
  CHECK(std::abs(fields.of({pair[0]})[0] - from_a * at_a / own_a) < 1e-13);
  const Complex determinant = own_a * own_b - both * both;
  const Complex expected =
      (from_a * (own_b * at_a + both * at_b) + from_b * (own_a * at_b + both * at_a)) / determinant;
  CHECK(std::abs(fields.of(pair)[0] - expected) < 1e-13);
}

TEST_CASE("layer fields: lossless points scatter the power that the mean waves lose") {
  // A layer of lower index guides no modes. The grazing angles of its sharp resonances are avoided
  // by a thin layer.
  for (const bool te : {false, true}) {
    const double thin = 0.6, light = 0.5;
    const LayerWaves waves({1, 1.3, te ? Polarisation::te : Polarisation::tm}, k, thin);
    Placement placement = points(12);
    for (auto& placed : placement) placed.position.z *= thin / depth;
    const QuadratureRule rule = gauss_legendre(300);
    std::vector<double> views{light, pi - light}, weights;
    for (const double start : {-pi / 2, pi / 2})
      for (std::size_t j = 0; j < rule.node.size(); ++j) {
        views.push_back(start + pi * rule.node[j]);
        weights.push_back(pi * rule.weight[j]);
      }
    const auto fields = LayerFields(waves, width, {light}, views).of(placement);
    double scattered = 0;
    for (std::size_t j = 0; j < weights.size(); ++j)
      scattered += weights[j] * std::norm(fields[j + 2]);
    const auto [through, back] = empty_layer(waves, light);
    const double lost =
        -std::sqrt(8 * pi / waves.outside_k()) *
        (std::polar(1.0, pi / 4) * (fields[0] * std::conj(through) + fields[1] * std::conj(back)))
            .real();
    CHECK(std::abs(scattered - lost) < 1e-6 * lost);
  }
}

TEST_CASE(
    "layer fields: exchange of light and view, both reversed, leaves the amplitude unchanged") {
  const std::vector<double> lights{0.3, -0.9}, views{0.7, 2.2};
  const Placement placement = points(30);
  std::vector<double> back_lights, back_views;
  for (const double view : views) back_lights.push_back(view + pi);
  for (const double light : lights) back_views.push_back(light + pi);
  const LayerWaves waves({1.5, 1, Polarisation::te}, k, depth);
  const auto there = LayerFields(waves, width, lights, views).of(placement),
             back = LayerFields(waves, width, back_lights, back_views).of(placement);
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      CHECK(std::abs(there[2 * i + j] - back[2 * j + i]) < 1e-11 * std::abs(there[2 * i + j]));
}

TEST_CASE("layer fields: the field of a plane wave satisfies the conditions at both faces") {
  for (const bool te : {false, true})
    for (const double angle : {0.4, 2.5}) {
      const LayerWaves waves({1.5, 1, te ? Polarisation::te : Polarisation::tm}, k, depth);
      const double p = waves.outside_k() * std::sin(angle), s = waves.derivative_ratio(),
                   beyond = waves.outside(p).real();
      const auto [through, back] = empty_layer(waves, angle < 1 ? angle : pi - angle);
      const Complex far_phase = std::exp(imaginary * beyond * depth);
      const auto derivative = [&](double z, double step) {  // one-sided, of fourth order
        const auto u = [&](int j) { return waves.illuminated(angle, {0, z + j * step}); };
        return (-25.0 / 12 * u(0) + 4.0 * u(1) - 3.0 * u(2) + 4.0 / 3 * u(3) - 0.25 * u(4)) / step;
      };
      // The face of incidence, then the other one; light from below is the mirror image.
      const bool down = angle < 1;
      const Complex phase = down ? Complex(1) : std::conj(far_phase);
      const double front = down ? 0 : depth, inward = down ? 1e-3 : -1e-3;
      const auto inside = [&](double z) { return waves.illuminated(angle, {0, z}); };
      CHECK(std::abs(inside(front) - phase * (1.0 + back)) < 1e-12);
      CHECK(std::abs(inside(depth - front) - phase * through * far_phase) < 1e-12);
      const Complex sign = down ? imaginary : -imaginary;
      CHECK(std::abs(derivative(front, inward) - phase * sign * s * beyond * (1.0 - back)) < 1e-5);
      CHECK(std::abs(derivative(depth - front, -inward) -
                     phase * sign * s * beyond * through * far_phase) < 1e-5);
    }
}

TEST_CASE("layer fields: ensembles require points and a tolerance within the accuracy") {
  CHECK_NOTHROW(wave_job(layer_scene("point"), 1, 1e-6));
  CHECK_THROWS_AS(wave_job(layer_scene("point"), 1, 1e-8), InputError);
  CHECK_THROWS_AS(wave_job(layer_scene("soft"), 1, 1e-6), InputError);
}

}  // namespace flatspeckle::wave::test_layer_fields
