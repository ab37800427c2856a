#include "mc/paths/estimators/medium_slope.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "core/error.h"

namespace flatspeckle::mc {

namespace {

/// Weights of a difference of fourth order, of values at so many steps.
constexpr std::pair<int, double> differences[] = {
    {1, 8 / 12.0}, {-1, -8 / 12.0}, {2, -1 / 12.0}, {-2, 1 / 12.0}};

/// Nodes that see the lobes of cylinders, as those that paths are drawn with.
std::size_t table_intervals(const BulkMedium& medium) {
  return 4096 * (medium.phase.density ? 16 : std::max<std::size_t>(medium.t_matrix.size(), 2));
}

/// Where an amplitude is 0 paths do not turn.
Complex over(Complex slope, Complex value) {
  const double square = std::norm(value);
  return square > 0 ? product_with_conjugate(slope, value) / square : 0;
}

AmplitudeSlope table_slope(const Scene& scene, const std::vector<Scene>& moved, double step) {
  const std::size_t intervals = table_intervals(scene.medium);
  const auto here = normalised_amplitudes(scene.medium, scene.k, intervals);
  std::vector<Complex> slope(here.size());
  for (std::size_t n = 0; n < moved.size(); ++n) {
    const auto there = normalised_amplitudes(moved[n].medium, scene.k, intervals);
    for (std::size_t i = 0; i < slope.size(); ++i)
      slope[i] += differences[n].second / step * there[i];
  }
  for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = over(slope[i], here[i]);
  return AmplitudeSlope(std::move(slope));
}

AmplitudeSlope amplitude_slope(const std::string& name, const Scene& scene,
                               const std::vector<Scene>& moved, double step) {
  if (scene.scatterer.kind == Scatterer::Kind::hg) {
    double by_g = 0;
    for (std::size_t n = 0; n < moved.size(); ++n)
      by_g += differences[n].second / step * moved[n].scatterer.g;
    return AmplitudeSlope::by_g(scene.medium, by_g);
  }
  if (scene.scatterer.kind == Scatterer::Kind::point) return {};
  if (scene.medium.dimension == 3)
    throw InputError(name, "paths in space", "are differentiated of scatterer = hg alone");
  return table_slope(scene, moved, step);
}

void require_same_but_medium(const std::string& name, const Scene& a, const Scene& b) {
  if (a.k != b.k || a.domain.depth != b.domain.depth || a.domain.width != b.domain.width)
    throw InputError(name, "paths", "are differentiated by what the medium is made of alone");
}

/// Cylinders of another radius or index, at the same density.
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

AmplitudeSlope AmplitudeSlope::by_g(const BulkMedium& medium, double factor) {
  AmplitudeSlope slope;
  slope.g_ = medium.g;
  slope.factor_ = factor;
  slope.dimension_ = medium.dimension;
  return slope;
}

void require_slopes(const Scene& scene, const std::vector<MediumSlope>& slopes) {
  if (scene.profile || scene.medium.mu_s == 0)
    throw std::logic_error("derivatives by a medium: it must scatter, the same everywhere");
  if (slopes.size() > most_slopes)
    throw std::logic_error("derivatives by a medium: too many at once");
}

MediumSlope medium_slope(const Scene& scene, BulkParameter parameter) {
  const BulkMedium& medium = scene.medium;
  switch (parameter) {
    case BulkParameter::mu_t:
      return {name_of(parameter), 1 / medium.mu_t, 0, {}};
    case BulkParameter::albedo:
      return {name_of(parameter), 0, 1 / medium.albedo, {}};
    case BulkParameter::g:
      return {name_of(parameter), 0, 0, AmplitudeSlope::by_g(medium)};
    case BulkParameter::radius:
    case BulkParameter::index:
      break;
  }
  const Scatterer& scatterer = scene.scatterer;
  const bool radius = parameter == BulkParameter::radius;
  const double size = scene.k * scatterer.radius * std::abs(scatterer.index),
               step = 1e-3 / std::max(1.0, size) *
                      (radius ? scatterer.radius : scatterer.index.real());
  return medium_slope(name_of(parameter), scene, step,
                      [&](double more) { return with_scatterer(scene, parameter, more); });
}

MediumSlope medium_slope(const std::string& name, const Scene& scene, double step,
                         const std::function<Scene(double)>& at) {
  MediumSlope slope{name, 0, 0, {}};
  std::vector<Scene> moved;
  for (const auto& [steps, weight] : differences) {
    moved.push_back(at(steps * step));
    require_same_but_medium(name, scene, moved.back());
    slope.log_mu_t += weight / step * moved.back().medium.mu_t / scene.medium.mu_t;
    slope.log_albedo += weight / step * moved.back().medium.albedo / scene.medium.albedo;
  }
  slope.amplitude = amplitude_slope(name, scene, moved, step);
  return slope;
}

}  // namespace flatspeckle::mc
