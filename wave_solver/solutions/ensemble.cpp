#include "wave_solver/solutions/ensemble.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <omp.h>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/blas.h"
#include "core/numbers/random.h"
#include "wave_solver/equations/system_memory.h"
#include "wave_solver/solutions/wave_solution.h"

namespace flatspeckle::wave {

namespace {

// Fields of one placement in every channel of the request.
std::vector<Complex> channel_fields(const Scene& scene, const FieldPlan& plan,
                                    const SolveOptions& options, RandomStream random) {
  const CovarianceRequest& request = scene.request;
  const Placement placement = draw_placement(scene, random);
  const auto fields = scattered_fields(placement, scene.k, plan, options);
  std::vector<Complex> channels;
  channels.reserve(request.channels.size());
  for (const Channel& channel : request.channels)
    channels.push_back(fields[channel.light * request.views.size() + channel.view]);
  return channels;
}

SolveOptions batch_options(const Scene& scene, double tolerance) {
  SolveOptions options{.tolerance = tolerance, .sensors = {}, .diagnose = false};
  for (const View& view : scene.request.views)
    if (view.near) options.sensors.push_back(view.point);
  for (const Light& light : scene.request.lights)
    if (light.kind == Light::Kind::point) options.sensors.push_back(light.point);
  return options;
}

FieldPlan field_plan(const Scene& scene, double tolerance) {
  const Domain& box = scene.domain;
  const double radius = std::hypot(box.width, box.depth) / 2 + scene.scatterer.disk_radius();
  return make_field_plan(scene.request.lights, scene.request.views, scene.k,
                         {{0, box.depth / 2}, radius}, tolerance);
}

// (sum u_a u_b* - sum u_a sum u_b* / n) / (n - 1); 0 while one sample shows no spread.
std::vector<Complex> sample_covariance(const CovarianceRequest& request, double samples,
                                       std::span<const Complex> sums) {
  std::vector<Complex> covariance(request.entries.size());
  if (samples < 2) return covariance;
  const auto products = sums.subspan(request.channels.size());
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    const auto [a, b] = request.entries[i];
    covariance[i] = (products[i] - sums[a] * std::conj(sums[b]) / samples) / (samples - 1);
  }
  return covariance;
}

// Centres of disks are anywhere in the box; some placement would cover what is within a radius.
void require_uncovered(const Scene& scene, const std::string& key, Vec2 point) {
  const Domain& box = scene.domain;
  const Vec2 beyond{std::max(0.0, std::abs(point.x) - box.width / 2),
                    std::max({0.0, -point.z, point.z - box.depth})};
  const double radius = scene.scatterer.disk_radius();
  if (length(beyond) < radius)
    throw InputError(key, "(" + number_text(point.x) + ", " + number_text(point.z) + ")",
                     "a cylinder may cover it; the exact solver needs points a radius (" +
                         number_text(radius) + ") and more outside of the box");
}

void require_solvable(const Scene& scene) {
  if (scene.domain.kind == Domain::Kind::slab)
    throw InputError("domain", "slab", "the wave solver needs a box");
  if (scene.profile && scene.scatterer.is_disk())
    throw InputError("layers: the exact solver needs points there");
  if (scene.scatterer.is_bulk())
    throw InputError("scatterer", "hg", "the wave solver needs point, soft, hard, tm or te");
  for (const View& view : scene.request.views)
    if (view.near) require_uncovered(scene, "near_sensors", view.point);
  for (const Light& light : scene.request.lights)
    if (light.kind == Light::Kind::point) require_uncovered(scene, "near_sources", light.point);
}

// What placements have at the least: disks, orders that their neighbours ask for as well.
void require_memory(const Scene& scene, double tolerance) {
  const bool disk = scene.scatterer.is_disk();
  const int order = disk ? isolated_order(scene.scatterer, scene.k, tolerance) : 0;
  const auto unknowns = static_cast<std::size_t>(scene.placement.mean_count * (2 * order + 1));
  if (method_for(unknowns, tolerance) == Method::dense)
    require_dense_memory(unknowns, omp_get_max_threads());
}

}  // namespace

FieldJob wave_job(const Scene& scene, std::uint64_t seed, double tolerance) {
  require_solvable(scene);
  require_placeable(scene.placement);
  require_memory(scene, tolerance);
  blas_single_thread();  // says now what it lacks
  const auto shared = std::make_shared<const Scene>(scene);
  const SolveOptions options = batch_options(scene, tolerance);
  const auto plan = std::make_shared<const FieldPlan>(field_plan(scene, tolerance));
  FieldJob job;
  job.mean = [shared](double samples, std::span<const Complex> sums) {
    return sample_mean(samples, sums.first(shared->request.channels.size()));
  };
  job.covariance = [shared](double samples, std::span<const Complex> sums) {
    return sample_covariance(shared->request, samples, sums);
  };
  job.batches.size = scene.request.channels.size() + scene.request.entries.size();
  job.batches.run = [shared, plan, options, seed](std::uint64_t number, std::span<Complex> sums) {
    const RandomStream random(seed, static_cast<std::uint64_t>(Stream::placement), number);
    const auto u = channel_fields(*shared, *plan, options, random);
    for (std::size_t i = 0; i < u.size(); ++i) sums[i] += u[i];
    for (std::size_t i = 0; i < shared->request.entries.size(); ++i) {
      const auto [a, b] = shared->request.entries[i];
      sums[u.size() + i] += u[a] * std::conj(u[b]);
    }
  };
  job.batches.relative_error = relative_error_of(job.covariance);
  return job;
}

}  // namespace flatspeckle::wave
