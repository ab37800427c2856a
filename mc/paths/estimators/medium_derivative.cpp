#include "mc/paths/estimators/medium_derivative.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/error.h"

namespace flatspeckle::mc {

namespace {

/// Steps and weights of the central difference of fourth order.
constexpr std::pair<int, double> differences[] = {
    {1, 8 / 12.0}, {-1, -8 / 12.0}, {2, -1 / 12.0}, {-2, 1 / 12.0}};

/// Returns a number of intervals that resolves the lobes of cylinders. It is the same number as in
/// TabulatedScattering, which samples the paths.
std::size_t table_intervals(const BulkMedium& medium) {
  return 4096 * (medium.phase.density ? 16 : std::max<std::size_t>(medium.t_matrix.size(), 2));
}

/// Returns the logarithmic derivative of an amplitude, derivative / value. It is 0 if the amplitude
/// is 0, because no path scatters by such an angle.
Complex over(Complex derivative, Complex value) {
  const double square = std::norm(value);
  return square > 0 ? product_with_conjugate(derivative, value) / square : 0;
}

AmplitudeDerivative table_derivative(const Scene& scene, const std::vector<Scene>& moved,
                                     double step) {
  const std::size_t intervals = table_intervals(scene.medium);
  const auto here = normalised_amplitudes(scene.medium, scene.k, intervals);
  std::vector<Complex> derivative(here.size());
  for (std::size_t n = 0; n < moved.size(); ++n) {
    const auto there = normalised_amplitudes(moved[n].medium, scene.k, intervals);
    for (std::size_t i = 0; i < derivative.size(); ++i)
      derivative[i] += differences[n].second / step * there[i];
  }
  for (std::size_t i = 0; i < derivative.size(); ++i) derivative[i] = over(derivative[i], here[i]);
  return AmplitudeDerivative(std::move(derivative));
}

AmplitudeDerivative amplitude_derivative(const std::string& name, const Scene& scene,
                                         const std::vector<Scene>& moved, double step) {
  if (scene.scatterer.kind == Scatterer::Kind::hg) {
    double by_g = 0;
    for (std::size_t n = 0; n < moved.size(); ++n)
      by_g += differences[n].second / step * moved[n].scatterer.g;
    return AmplitudeDerivative::by_g(scene.medium, by_g);
  }
  if (scene.scatterer.kind == Scatterer::Kind::point) return {};
  if (scene.medium.dimension == 3)
    throw InputError(name + ": derivatives by Monte Carlo in space require scatterer = hg");
  return table_derivative(scene, moved, step);
}

void require_same_but_medium(const std::string& name, const Scene& a, const Scene& b) {
  if (a.k != b.k || a.domain.depth != b.domain.depth || a.domain.width != b.domain.width)
    throw InputError(name +
                     ": derivatives by Monte Carlo require a key that changes only the medium");
}

/// Returns the scene with the radius or index of the cylinders larger by `more`, at the same
/// density.
Scene with_scatterer(const Scene& scene, BulkParameter parameter, double more) {
  Scene other = scene;
  if (parameter == BulkParameter::radius)
    other.scatterer.radius += more;
  else
    other.scatterer.index += more;
  other.medium = bulk_medium(other.scatterer, scene.k, scene.medium.density);
  return other;
}

}  // namespace

AmplitudeDerivative AmplitudeDerivative::by_g(const BulkMedium& medium, double factor) {
  AmplitudeDerivative derivative;
  derivative.g_ = medium.g;
  derivative.factor_ = factor;
  derivative.dimension_ = medium.dimension;
  return derivative;
}

void require_derivatives(const Scene& scene, const std::vector<MediumDerivative>& derivatives) {
  if (scene.profile || scene.medium.mu_s == 0)
    throw std::logic_error("derivatives by a medium: require a homogeneous medium that scatters");
  if (derivatives.size() > most_derivatives)
    throw std::logic_error("derivatives by a medium: too many parameters in one run");
}

MediumDerivative medium_derivative(const Scene& scene, BulkParameter parameter) {
  const BulkMedium& medium = scene.medium;
  switch (parameter) {
    case BulkParameter::mu_t:
      return {name_of(parameter), 1 / medium.mu_t, 0, {}};
    case BulkParameter::albedo:
      return {name_of(parameter), 0, 1 / medium.albedo, {}};
    case BulkParameter::g:
      return {name_of(parameter), 0, 0, AmplitudeDerivative::by_g(medium)};
    case BulkParameter::radius:
    case BulkParameter::index:
      break;
  }
  const Scatterer& scatterer = scene.scatterer;
  const bool radius = parameter == BulkParameter::radius;
  const double size = scene.k * scatterer.radius * std::abs(scatterer.index),
               step = 1e-3 / std::max(1.0, size) *
                      (radius ? scatterer.radius : scatterer.index.real());
  return medium_derivative(name_of(parameter), scene, step,
                           [&](double more) { return with_scatterer(scene, parameter, more); });
}

MediumDerivative medium_derivative(const std::string& name, const Scene& scene, double step,
                                   const std::function<Scene(double)>& at) {
  MediumDerivative derivative{name, 0, 0, {}};
  std::vector<Scene> moved;
  for (const auto& [steps, weight] : differences) {
    moved.push_back(at(steps * step));
    require_same_but_medium(name, scene, moved.back());
    derivative.log_mu_t += weight / step * moved.back().medium.mu_t / scene.medium.mu_t;
    derivative.log_albedo += weight / step * moved.back().medium.albedo / scene.medium.albedo;
  }
  derivative.amplitude = amplitude_derivative(name, scene, moved, step);
  return derivative;
}

}  // namespace flatspeckle::mc
