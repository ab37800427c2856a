#include "mc/transport/bulk_slope.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mc/jobs/gradient_job.h"

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

double scatterer_unit(const Scatterer& scatterer, BulkParameter parameter) {
  return parameter == BulkParameter::radius ? scatterer.radius : scatterer.index.real();
}

Scatterer with_size(Scatterer scatterer, BulkParameter parameter, double factor) {
  if (parameter == BulkParameter::radius)
    scatterer.radius *= factor;
  else
    scatterer.index.real(scatterer.index.real() * factor);
  return scatterer;
}

BulkSlope bulk_slope(const Scene& scene, const ScatteringLaw& law, BulkParameter parameter) {
  if (parameter != BulkParameter::radius && parameter != BulkParameter::index)
    return bulk_slope_of<ScatteringSlope>(scene.medium, law, parameter);
  return scatterer_slope<ScatteringSlope>(scene, law, parameter, [&](const Scatterer& scatterer) {
    Scene other = scene;
    other.scatterer = scatterer;
    other.medium = bulk_medium(scatterer, scene.k, scene.medium.density);
    return std::pair(other.medium, ScatteringLaw(other));
  });
}

std::vector<BulkParameter> slab_parameters(const Scene& scene) {
  auto parameters = bulk_parameters(scene);
  if (scene.scatterer.kind == Scatterer::Kind::mie)
    parameters.insert(parameters.end(), {BulkParameter::radius, BulkParameter::index});
  return parameters;
}

}  // namespace flatspeckle::mc
