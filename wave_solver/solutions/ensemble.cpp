#include "wave_solver/solutions/ensemble.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <omp.h>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/numbers/blas.h"
#include "core/numbers/random.h"
#include "flatland/scene/frequency_shift.h"
#include "wave_solver/equations/wave_equations.h"
#include "wave_solver/graded/graded_fields.h"
#include "wave_solver/layered/layer_fields.h"
#include "wave_solver/solutions/space_solution.h"

namespace flatspeckle::wave {

namespace {

bool is_in_space(const Scene& scene) {
  return scene.domain.height > 0;
}

SolveOptions batch_options(const Scene& scene, double tolerance, Method method) {
  SolveOptions options{.tolerance = tolerance, .sensors = {}, .diagnose = false, .method = method};
  for (const View& view : scene.request.views)
    if (view.near) options.sensors.push_back(view.point);
  for (const Light& light : scene.request.lights)
    if (light.kind == Light::Kind::point) options.sensors.push_back(light.point);
  return options;
}

FieldPlan field_plan(const Scene& scene, double tolerance) {
  if (is_in_space(scene)) return {};
  const Domain& box = scene.domain;
  const double radius = std::hypot(box.width, box.depth) / 2 + scene.scatterer.disk_radius();
  return make_field_plan(scene.request.lights, scene.request.views, scene.k,
                         {{0, box.depth / 2}, radius}, tolerance);
}

// Solves placements for the lights and views of a scene.
struct PlacementFields {
  Scene scene;
  FieldPlan plan;
  SolveOptions options;
  std::optional<GradedFields> graded;  // set if the refractive index varies in space
  std::optional<LayerFields> layered;  // set if the faces of the medium reflect
  std::optional<SpaceFields> space;    // set in space

  PlacementFields(const Scene& of, double tolerance, Method method)
      : scene(of), plan(field_plan(of, tolerance)), options(batch_options(of, tolerance, method)) {
    if (scene.index && scene.index->is_around()) graded = graded_fields(scene);
    refuse_unpolarised(scene);
    if (scene.faces) layered = layer_fields(scene);
    if (is_in_space(scene)) space.emplace(scene, options);
  }

  // Returns the fields of a placement in every channel of the request.
  std::vector<Complex> of(const Placement& placement) const {
    const CovarianceRequest& request = scene.request;
    const auto fields = graded    ? graded->of(placement)
                        : layered ? layered->of(placement)
                        : space   ? space->of(placement)
                                  : scattered_fields(placement, scene.k, plan, options);
    std::vector<Complex> channels;
    channels.reserve(request.channels.size());
    for (const Channel& channel : request.channels)
      channels.push_back(fields[channel.light * request.views.size() + channel.view]);
    return channels;
  }
};

// Returns the unbiased covariance of u_a and u_b, (sum u_a u_b* - sum u_a sum u_b* / n) / (n - 1)
// for n samples; 0 for fewer than two samples.
Complex sample_covariance(double samples, Complex products, Complex a, Complex b) {
  return samples < 2 ? 0 : (products - a * std::conj(b) / samples) / (samples - 1);
}

// Accumulates the sums of placements at all frequencies: u of each channel and u_a u_b* of each
// entry. Then, for each frequency shift and each entry that changes with it (changing_entries): u_b
// and u_a u_b*, with u_b at the shifted frequency.
class Ensemble {
 public:
  Ensemble(const Scene& scene, const std::vector<double>& shifts, double tolerance, Method method)
      : first_(scene, tolerance, method), changing_(changing_entries(scene.request)) {
    others_.reserve(shifts.size());
    for (const double shift : shifts)
      others_.emplace_back(at_frequency(scene, shift), tolerance, method);
  }

  std::size_t channels() const { return request().channels.size(); }
  std::size_t entries() const { return request().entries.size(); }
  std::size_t size() const { return channels() + entries() + 2 * changing_ * others_.size(); }

  void add(RandomStream random, std::span<Complex> sums) const {
    const Scene& scene = first_.scene;
    const auto placement = draw_placement(scene, random);
    const auto u = first_.of(placement);
    for (std::size_t c = 0; c < u.size(); ++c) sums[c] += u[c];
    for (std::size_t e = 0; e < entries(); ++e) {
      const auto [a, b] = request().entries[e];
      sums[u.size() + e] += u[a] * std::conj(u[b]);
    }
    for (std::size_t s = 0; s < others_.size(); ++s) {
      const auto second = others_[s].of(placement);
      for (std::size_t e = 0; e < changing_; ++e) {
        sums[at(s) + e] += second[e];
        sums[at(s) + changing_ + e] += u[request().entries[e].a] * std::conj(second[e]);
      }
    }
  }

  std::vector<Complex> mean(double samples, std::span<const Complex> sums) const {
    return sample_mean(samples, sums.first(channels()));
  }

  std::vector<Complex> covariance(double samples, std::span<const Complex> sums) const {
    return placement_covariance(request(), samples, sums);
  }

  // Returns the covariances without a frequency shift, then the covariances for each shift: [1 +
  // shift][entry].
  std::vector<Complex> all(double samples, std::span<const Complex> sums) const {
    auto values = covariance(samples, sums);
    for (std::size_t s = 0; s < others_.size(); ++s) {
      for (std::size_t e = 0; e < changing_; ++e)
        values.push_back(sample_covariance(samples, sums[at(s) + changing_ + e],
                                           sums[request().entries[e].a], sums[at(s) + e]));
      values.resize((2 + s) * entries());
    }
    return values;
  }

 private:
  const CovarianceRequest& request() const { return first_.scene.request; }
  std::size_t at(std::size_t shift) const { return channels() + entries() + 2 * changing_ * shift; }

  PlacementFields first_;
  std::size_t changing_;
  std::vector<PlacementFields> others_;
};

// Throws InputError if a disk or sphere may cover the point. Its centre may be anywhere in the box.
// A point less than one radius outside the box can therefore still be covered.
void require_uncovered(const Scene& scene, const std::string& key, Vec point) {
  const Domain& box = scene.domain;
  const Vec beyond{std::max(0.0, std::abs(point.x) - box.width / 2),
                   std::max({0.0, -point.z, point.z - box.depth}),
                   std::max(0.0, std::abs(point.y) - box.height / 2)};
  const double radius = scene.scatterer.disk_radius();
  if (length(beyond) < radius)
    throw InputError(key, "(" + number_text(point.x) + ", " + number_text(point.z) + ")",
                     "must be at least a radius (" + number_text(radius) +
                         ") outside the box for the exact solver, because a " +
                         (is_in_space(scene) ? "sphere" : "cylinder") + " may cover it");
}

void require_solvable_in_space(const Scene& scene) {
  if (scene.profile || scene.index || scene.faces)
    throw InputError("dimension", 3,
                     "the exact solver requires a medium without layers, index_field and "
                     "medium_index");
  if (!scene.scatterer.is_disk()) return;
  const Scatterer reach{.radius = scene.scatterer.radius + scene.placement.min_gap / 2};
  check_packing(scene.domain, scene.placement.kind,
                std::round(scene.placement.mean_count) * reach.content(3) / scene.domain.content(),
                2 * reach.radius);
}

void require_solvable(const Scene& scene, double tolerance) {
  if (scene.domain.kind == Domain::Kind::slab)
    throw InputError("domain", "slab", "the wave solver requires a box");
  if (scene.profile && scene.placement.kind == PlacementRule::Kind::equilibrium)
    throw InputError("placement", "equilibrium",
                     "requires a medium without layers or density maps; use hard_disk");
  if (scene.scatterer.is_bulk())
    throw InputError("scatterer", "hg",
                     is_in_space(scene) ? "the wave solver requires point, soft, hard or penetrable"
                                        : "the wave solver requires point, soft, hard, tm or te");
  if (is_in_space(scene)) require_solvable_in_space(scene);
  if (scene.faces && tolerance < LayerGreen::accuracy)
    throw InputError(
        "wave_tolerance", tolerance,
        "must be at least " + number_text(LayerGreen::accuracy) + " if medium_index is given");
  for (const View& view : scene.request.views)
    if (view.near) require_uncovered(scene, "near_sensors", view.point);
  for (const Light& light : scene.request.lights)
    if (light.kind == Light::Kind::point) require_uncovered(scene, "near_sources", light.point);
}

// Throws InputError if the memory is certainly insufficient. The estimate is a lower bound: it uses
// the basis orders of isolated disks, and neighbours may require higher orders.
void require_memory(const Scene& scene, double tolerance) {
  const bool disk = scene.scatterer.is_disk(), space = is_in_space(scene);
  const int order = disk ? isolated_order(scene.scatterer, scene.k, tolerance,
                                          space ? Radial::spherical : Radial::cylindrical)
                         : 0;
  const int waves = space ? (order + 1) * (order + 1) : 2 * order + 1;
  const auto unknowns = static_cast<std::size_t>(scene.placement.mean_count * waves);
  const bool around = scene.index && scene.index->is_around();
  const Method method = space ? method_in_space(unknowns, !disk) : method_for(unknowns, tolerance);
  if (around || scene.faces || method == Method::dense)
    require_dense_memory(unknowns, omp_get_max_threads());
}

}  // namespace

std::vector<Complex> placement_covariance(const CovarianceRequest& request, double samples,
                                          std::span<const Complex> sums) {
  std::vector<Complex> values;
  for (std::size_t e = 0; e < request.entries.size(); ++e) {
    const auto [a, b] = request.entries[e];
    values.push_back(
        sample_covariance(samples, sums[request.channels.size() + e], sums[a], sums[b]));
  }
  return values;
}

FieldJob wave_job(const Scene& scene, std::uint64_t seed, double tolerance, Method method) {
  return frequency_job(scene, {}, seed, tolerance, method).field;
}

FrequencyJob frequency_job(const Scene& scene, const std::vector<double>& shifts,
                           std::uint64_t seed, double tolerance, Method method) {
  require_solvable(scene, tolerance);
  require_placeable(scene.placement);
  require_memory(scene, tolerance);
  blas_single_thread();  // throws before the run if BLAS lacks memory
  const auto ensemble = std::make_shared<const Ensemble>(scene, shifts, tolerance, method);
  const auto estimator = [&](auto of) -> Estimator {
    return [=](double samples, std::span<const Complex> sums) {
      return ((*ensemble).*of)(samples, sums);
    };
  };
  FrequencyJob job;
  job.all = estimator(&Ensemble::all);
  job.field.mean = estimator(&Ensemble::mean);
  job.field.covariance = estimator(&Ensemble::covariance);
  job.field.batches.size = ensemble->size();
  job.field.batches.run = [=](std::uint64_t number, std::span<Complex> sums) {
    ensemble->add(RandomStream(seed, static_cast<std::uint64_t>(Stream::placement), number), sums);
  };
  job.field.batches.relative_error = relative_error_of(job.all);
  job.field.batches.deterministic = scene.medium.mu_s == 0;
  return job;
}

}  // namespace flatspeckle::wave
