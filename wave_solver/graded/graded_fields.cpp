#include "wave_solver/graded/graded_fields.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "wave_solver/dense/columns.h"
#include "wave_solver/dense/dense_factor.h"

namespace flatspeckle::wave {

namespace {

std::vector<Vec2> sources_of(const CovarianceRequest& request) {
  if (!request.lights.all(Light::Kind::point))
    throw InputError("index_field: of graded media the exact solver takes near_sources alone");
  std::vector<Vec2> sources;
  for (const Light& light : request.lights) sources.push_back(light.point);
  return sources;
}

std::vector<Vec2> sensors_of(const CovarianceRequest& request) {
  std::vector<Vec2> sensors;
  for (const View& view : request.views) {
    if (!view.near)
      throw InputError("index_field: of graded media the exact solver takes near_sensors alone");
    sensors.push_back(view.point);
  }
  return sensors;
}

/// Between any two of some places.
double longest_way(const std::vector<Vec2>& places) {
  double longest = 0;
  for (const Vec2 a : places)
    for (const Vec2 b : places) longest = std::max(longest, length(a - b));
  return longest;
}

template <typename T>
std::vector<T> joined(std::vector<T> list, const std::vector<T>& rest) {
  list.insert(list.end(), rest.begin(), rest.end());
  return list;
}

}  // namespace

const DatasetTable graded_table{
    "solve in a graded medium",
    {{"near_source_field", Data::complex, "light sensor", "1",
      "scattered field of a point source, the Green function, in a graded medium"}}};

GradedFields::GradedFields(const IndexField& field, double k, std::vector<Vec2> sources,
                           std::vector<Vec2> sensors, const std::vector<Vec2>& within)
    : k_(k),
      sources_(std::move(sources)),
      sensors_(std::move(sensors)),
      green_(field, k, longest_way(joined(joined(within, sources_), sensors_))) {
  for (const Vec2 place : within)
    for (const auto* others : {&within, &std::as_const(sources_), &std::as_const(sensors_)})
      for (const Vec2 other : *others)
        if (other != place) green_(place, other);
}

GradedFields graded_fields(const Scene& scene) {
  const double half = scene.domain.width / 2, depth = scene.domain.depth;
  return {*scene.index,
          scene.k,
          sources_of(scene.request),
          sensors_of(scene.request),
          {{-half, 0}, {half, 0}, {-half, depth}, {half, depth}}};
}

/// H = -4 i G, which is H_0 without a field, of each scatterer at each point: [point][scatterer].
std::vector<Complex> GradedFields::rows(const Placement& placement,
                                        const std::vector<Vec2>& points) const {
  std::vector<Complex> rows;
  for (const Vec2 point : points)
    for (const PlacedScatterer& placed : placement)
      rows.push_back(Complex(0, -4) * green_(placed.position, point));
  return rows;
}

std::vector<Complex> GradedFields::of(const Placement& placement) const {
  const std::size_t n = placement.size(), fields = sources_.size() * sensors_.size();
  if (n == 0) return std::vector<Complex>(fields);
  Entries matrix(n * n);
  for (std::size_t j = 0; j < n; ++j) {
    const auto t = static_cast<Complex>(t_matrix(placement[j].scatterer, k_, 0).front());
    matrix[j * (n + 1)] = -1.0 / t;
    for (std::size_t l = 0; l < j; ++l)
      matrix[j * n + l] = matrix[l * n + j] =
          Complex(0, -4) * green_(placement[j].position, placement[l].position);
  }
  auto sides = rows(placement, sources_);  // of G itself, and with the sign of M beta = -a
  for (Complex& side : sides) side *= Complex(0, -0.25);
  DenseFactor factor(std::move(matrix), n);
  const auto found =
      transposed_product(rows(placement, sensors_), factor.solve(sides).data(), sources_.size(), n);
  require_finite(found);
  return found;
}

}  // namespace flatspeckle::wave
