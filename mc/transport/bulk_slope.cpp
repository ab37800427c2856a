#include "mc/transport/bulk_slope.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mc/estimators/gradient.h"

namespace flatspeckle::mc {

std::vector<double> power_slopes(double g, std::size_t count) {
  std::vector<double> slopes(count);
  for (std::size_t m = 1; m < count; ++m)
    slopes[m] = static_cast<double>(m) * std::pow(g, static_cast<double>(m - 1));
  return slopes;
}

ScatteringSlope::ScatteringSlope(const ScatteringLaw& law) : law_(law) {
  modes_.value = law.modes();
  modes_.slope.assign(law.modes().size(), 0);
}

/// The modes are g^m.
ScatteringSlope ScatteringSlope::by_g(const ScatteringLaw& law, double g) {
  ScatteringSlope slope(law);
  slope.by_g_ = true;
  slope.modes_.slope = power_slopes(g, law.modes().size() + 1);
  return slope;
}

ScatteringSlope::ScatteringSlope(const ScatteringLaw& law, std::vector<Neighbour> neighbours)
    : ScatteringSlope(law) {
  neighbours_ = std::move(neighbours);
  auto& modes = modes_.slope;
  for (const auto& [weight, near] : neighbours_) {
    modes.resize(std::max(modes.size(), near.modes().size()));
    for (std::size_t m = 0; m < near.modes().size(); ++m) modes[m] += weight * near.modes()[m];
  }
}

Dual<Complex> ScatteringSlope::pair(double a, double b, double theta) const {
  Dual<Complex> pair{law_.pair(a, b, theta), 0};
  if (by_g_) pair.slope = (law_.slope(theta - a) + law_.slope(theta - b)) / 2 * pair.value;
  for (const auto& [weight, near] : neighbours_) pair.slope += weight * near.pair(a, b, theta);
  return pair;
}

namespace {

/// By the logarithm of what `scaled` multiplies in a scatterer.
template <typename Scaled>
BulkSlope scatterer_slope(const Scene& scene, const ScatteringLaw& law, double unit,
                          const Scaled& scaled) {
  const Scatterer& scatterer = scene.scatterer;
  const double size = scene.k * scatterer.radius * std::abs(scatterer.index),
               step = 1e-3 / std::max(1.0, size);
  double log_mu_t = 0, albedo = 0;
  std::vector<ScatteringSlope::Neighbour> neighbours;
  const auto add = [&](double steps, double factor) {
    const double weight = factor / (12 * step);
    Scene other = scene;
    scaled(other.scatterer, 1 + steps * step);
    other.medium = bulk_medium(other.scatterer, scene.k, scene.medium.density);
    log_mu_t += weight * other.medium.mu_t / scene.medium.mu_t;
    albedo += weight * other.medium.albedo;
    neighbours.push_back({weight, ScatteringLaw(other)});
  };
  add(1, 8);
  add(-1, -8);
  add(2, -1);
  add(-2, 1);
  return {unit, log_mu_t, albedo, ScatteringSlope(law, std::move(neighbours))};
}

}  // namespace

BulkSlope bulk_slope(const Scene& scene, const ScatteringLaw& law, BulkParameter parameter) {
  const auto wider = [](Scatterer& scatterer, double factor) { scatterer.radius *= factor; };
  const auto denser = [](Scatterer& scatterer, double factor) {
    scatterer.index.real(scatterer.index.real() * factor);
  };
  if (parameter == BulkParameter::radius)
    return scatterer_slope(scene, law, scene.scatterer.radius, wider);
  if (parameter == BulkParameter::index)
    return scatterer_slope(scene, law, scene.scatterer.index.real(), denser);
  return bulk_slope_of<ScatteringSlope>(scene.medium, law, parameter);
}

std::vector<BulkParameter> slab_parameters(const Scene& scene) {
  auto parameters = bulk_parameters(scene);
  if (!scene.scatterer.is_disk() || !scene.medium.structure.independent()) return parameters;
  parameters.push_back(BulkParameter::radius);
  if (scene.scatterer.is_penetrable()) parameters.push_back(BulkParameter::index);
  return parameters;
}

}  // namespace flatspeckle::mc
