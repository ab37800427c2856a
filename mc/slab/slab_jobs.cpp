#include "mc/slab/slab_jobs.h"

#include <cmath>
#include <functional>

#include "core/error.h"
#include "flatland/media/layers.h"
#include "mc/slab/slab_covariance.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

namespace {

void require_layers(const Scene& scene) {
  if (!scene.profile) return;
  if (dynamic_cast<const Layers*>(scene.profile.get()) == nullptr)
    throw InputError("method", "transport", "of a medium that varies takes layers alone");
  if (has_near_ends(scene.request))
    throw InputError("layers: by transport take plane waves and far views");
}

/// Solutions of several quantities, [quantity][entry], of which the first is the covariance.
PathJob two_batch_job(const Scene& scene, std::size_t quantities,
                      const std::function<Refined()>& solve) {
  require_layers(scene);
  const std::size_t entries = scene.request.entries.size();
  PathJob job;
  job.entries = entries;
  job.all = sample_mean;
  job.field.covariance = [entries](double samples, std::span<const Complex> sums) {
    return sample_mean(samples, sums.first(entries));
  };
  job.field.batches = two_batches(quantities * entries, solve);
  return job;
}

/// By how much the differences move the range, relative to it; 0 of bounds.
double range_error(const CovarianceRequest& request, const Refined& refined) {
  auto moved = refined.value;
  for (std::size_t e = 0; e < moved.size(); ++e) moved[e] += refined.difference[e];
  const double range = correlation_and_ranges(request, refined.value).back().real(),
               other = correlation_and_ranges(request, moved).back().real();
  return std::abs(other / range - 1);
}

/// Smaller and smaller tolerances until the range is within that of `refinement` too: the entries
/// of a flat curve may be, and where it crosses not.
Refined refined_range(const Scene& scene, bool reversed, Refinement refinement) {
  constexpr double step = 4, flattest = 256;  // curves move their range by so much more
  const double tolerance = refinement.tolerance;
  Refined refined = slab_covariance(scene, reversed, refinement);
  if (scene.request.kind != CovarianceRequest::Kind::memory_effect) return refined;
  for (double finer = step; finer <= flattest && range_error(scene.request, refined) > tolerance;
       finer *= step) {
    refinement.tolerance = tolerance / finer;
    refined = slab_covariance(scene, reversed, refinement);
  }
  return refined;
}

/// By what transport differentiates: bulk_parameters(), and of spheres the radius and the index.
std::vector<BulkParameter> slab_parameters(const Scene& scene) {
  auto parameters = bulk_parameters(scene);
  if (scene.scatterer.kind == Scatterer::Kind::mie)
    parameters.insert(parameters.end(), {BulkParameter::radius, BulkParameter::index});
  return parameters;
}

}  // namespace

FieldJob slab_covariance_job(const Scene& scene, bool reversed, const Refinement& refinement) {
  return two_batch_job(scene, 1, [=] { return refined_range(scene, reversed, refinement); }).field;
}

PathJob slab_change_job(const Scene& scene, bool reversed, const Refinement& refinement,
                        const std::vector<FieldChange>& changes) {
  return two_batch_job(scene, 1 + changes.size(), [=] {
    Refined all = slab_covariance(scene, reversed, refinement);
    for (const FieldChange& change : changes)
      all.append(slab_covariance(scene, reversed, refinement, change));
    return all;
  });
}

GradientJob slab_gradient_job(const Scene& scene, bool reversed, const Refinement& refinement) {
  const auto parameters = slab_parameters(scene);
  const auto solve = [=] {
    Refined all = slab_slopes(scene, reversed, refinement, parameters.front());
    for (std::size_t p = 1; p < parameters.size(); ++p) {
      Refined one = slab_slopes(scene, reversed, refinement, parameters[p]);
      for (auto* list : {&one.value, &one.difference})
        list->erase(list->begin(), list->begin() + std::ssize(scene.request.entries));
      all.append(one);
    }
    return all;
  };
  return gradient_job(two_batch_job(scene, 1 + parameters.size(), solve), parameters, scene);
}

}  // namespace flatspeckle::mc
