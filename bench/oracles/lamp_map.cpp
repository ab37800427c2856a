#include "bench/oracles/lamp_map.h"

#include <cmath>
#include <numbers>

#include "bench/oracles/quadrature.h"

namespace flatspeckle::oracles {

namespace {

/// Returns the root of albedo atanh(kappa) = kappa in (0, 1), by bisection.
double decay(double albedo) {
  double low = 0, high = 1;
  for (int i = 0; i < 200; ++i) {
    const double kappa = (low + high) / 2;
    (kappa > 0 && albedo * std::atanh(kappa) < kappa ? low : high) = kappa;
  }
  return low;
}

/// Returns the contribution of the pole times 4 pi r, for mu_t = 1.
double diffusing(double albedo, double r) {
  const double kappa = decay(albedo), square = kappa * kappa;
  return 2 * square * (1 - square) * std::exp(-kappa * r) / (albedo * (square - (1 - albedo)));
}

/// Returns the contribution of the branch cut times 4 pi r, the integral of exp(-r t) g(t) over t >
/// 1, for mu_t = 1.
double transient(double albedo, double r) {
  GaussPanels beyond_1;
  for (double from = 1e-14; from < 60 / r; from *= 4) beyond_1.add(from, 4 * from);
  double sum = 0;
  for (std::size_t i = 0; i < beyond_1.node.size(); ++i) {
    const double s = beyond_1.node[i], t = 1 + s;
    const double real = 1 - albedo / t * 0.5 * std::log((2 + s) / s);
    const double imaginary = std::numbers::pi * albedo / (2 * t);
    sum += beyond_1.weight[i] * std::exp(-r * t) / (real * real + imaginary * imaginary);
  }
  return sum;
}

constexpr double nearest = 1, farthest = 5, radius = 1;
constexpr int discs = 4;

/// Returns the mean fluence rate in a disc between two distances from the lamp.
double disc_mean(double albedo, double from, double to) {
  GaussPanels across, along;
  across.add(0, radius);
  along.add(from, to);
  double sum = 0;
  for (std::size_t i = 0; i < across.node.size(); ++i)
    for (std::size_t j = 0; j < along.node.size(); ++j)
      sum += across.weight[i] * across.node[i] * along.weight[j] *
             point_source_fluence(1, albedo, std::hypot(across.node[i], along.node[j]));
  return 2 * sum / (radius * radius * (to - from));
}

}  // namespace

double point_source_fluence(double mu_t, double albedo, double r) {
  const double depth = mu_t * r;
  return mu_t * (diffusing(albedo, depth) + transient(albedo, depth)) / (4 * std::numbers::pi * r);
}

grin::RenderScene lamp_map(double albedo) {
  using namespace grin;
  RenderScene scene{};
  scene.stage.boundary = Sphere{Vec3::Zero(), 12};
  scene.stage.medium.mu_s = albedo;
  scene.stage.medium.mu_a = 1 - albedo;
  scene.lights = {PointLight{Vec3::Zero()}};
  scene.map = RingCells(Vec3(0, 0, nearest), Vec3(0, 0, farthest), radius, {1, discs});
  return scene;
}

std::vector<double> lamp_fluence(double albedo) {
  constexpr double height = (farthest - nearest) / discs;
  std::vector<double> means;
  for (int i = 0; i < discs; ++i)
    means.push_back(disc_mean(albedo, nearest + i * height, nearest + (i + 1) * height));
  return means;
}

}  // namespace flatspeckle::oracles
