#include "mc/slab/slab_jobs.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

#include "core/error.h"
#include "flatland/media/layers.h"
#include "mc/slab/adding/plane.h"
#include "mc/slab/adding/space.h"
#include "mc/slab/scene_slab.h"
#include "mc/slab/slab_covariance.h"
#include "mc/theory/memory_effect.h"

namespace flatspeckle::mc {

namespace {

void require_layers(const Scene& scene) {
  if (!scene.profile) return;
  if (dynamic_cast<const Layers*>(scene.profile.get()) == nullptr)
    throw InputError("method", "transport",
                     "supports no varying media except layers; use method = mc");
  if (has_near_endpoints(scene.request))
    throw InputError("layers: method = transport requires plane waves and far views");
}

/// Throws InputError if a phase function has a peak that the ordinates cannot resolve. Truncation
/// of its moments does not remove the peak from the first scattering of a pair of illuminations.
template <typename Geometry>
void require_resolved_peaks(const Scene& scene, double least_width) {
  for (const auto& layer : slab_of<Geometry>(scene).layers)
    if (layer.law.has_sharp_peak() && layer.law.width() < least_width)
      throw InputError("method", "transport",
                       "does not resolve the forward or backward peak of the phase function, "
                       "which is too narrow; use method = mc");
}

/// Makes a job from a solution for several quantities, [quantity][entry]. The first quantity is the
/// covariance. units: for a derivative, the unit of its parameter, so that derivative times unit is
/// comparable with the entry; 0 for a covariance.
PathJob two_batch_job(const Scene& scene, const std::vector<double>& units,
                      const std::function<Refined()>& solve) {
  require_layers(scene);
  refuse_unpolarised(scene);
  if (scene.medium.mu_s > 0)
    scene.medium.dimension == 3 ? require_resolved_peaks<SpaceGeometry>(scene, 1e-3)
                                : require_resolved_peaks<PlaneGeometry>(scene, 1e-4);
  const std::size_t quantities = units.size();
  const std::size_t entries = scene.request.entries.size();
  PathJob job;
  job.entries = entries;
  job.all = sample_mean;
  job.field.covariance = [entries](double samples, std::span<const Complex> sums) {
    return sample_mean(samples, sums.first(entries));
  };
  const auto list = scene.request.entries;
  job.field.batches =
      two_batches(quantities * entries, solve, [=](std::span<const Complex> values) {
        const auto of_entries = scales(list, values.first(entries));
        std::vector<double> all;
        for (std::size_t quantity = 0; quantity < quantities; ++quantity) {
          auto own = scales(list, values.subspan(quantity * entries, entries));
          for (std::size_t e = 0; e < entries && units[quantity] > 0; ++e)
            own[e] = std::max(own[e], of_entries[e] / units[quantity]);
          all.insert(all.end(), own.begin(), own.end());
        }
        return all;
      });
  return job;
}

/// Returns the relative change of the range of the memory effect if the errors are added to the
/// entries; 0 if only a bound of the range is known.
double range_error(const CovarianceRequest& request, const Refined& refined) {
  auto moved = refined.value;
  for (std::size_t e = 0; e < moved.size(); ++e) moved[e] += refined.error[e];
  const double range = correlation_and_ranges(request, refined.value).back().real(),
               other = correlation_and_ranges(request, moved).back().real();
  return std::abs(other / range - 1);
}

/// Solves the slab; for a memory_effect request, decreases the tolerance until the error of the
/// range is at most twice the tolerance of `refinement`. If the correlation curve is flat, small
/// errors of the entries may cause a large error of the tilt at which it crosses a given level.
Refined refined_range(const Scene& scene, bool reversed, Refinement refinement) {
  if (scene.request.kind == CovarianceRequest::Kind::memory_effect)
    refinement.suffices = [&request = scene.request,
                           most = 2 * refinement.tolerance](const Refined& refined) {
      return !(range_error(request, refined) > most);
    };
  return slab_covariance(scene, reversed, refinement);
}

/// Returns the parameters by which transport computes derivatives: bulk_parameters() and, for
/// spheres at independent positions, the radius and the index.
std::vector<BulkParameter> slab_parameters(const Scene& scene) {
  auto parameters = bulk_parameters(scene);
  if (scene.scatterer.kind == Scatterer::Kind::mie && scene.medium.structure.independent())
    parameters.insert(parameters.end(), {BulkParameter::radius, BulkParameter::index});
  return parameters;
}

}  // namespace

FieldJob slab_covariance_job(const Scene& scene, bool reversed, const Refinement& refinement) {
  return two_batch_job(scene, {0}, [=] { return refined_range(scene, reversed, refinement); })
      .field;
}

PathJob slab_change_job(const Scene& scene, bool reversed, const Refinement& refinement,
                        const std::vector<FieldChange>& changes) {
  return two_batch_job(scene, std::vector<double>(1 + changes.size()), [=] {
    Refined all = slab_covariance(scene, reversed, refinement);
    for (const FieldChange& change : changes) {
      Refined changed = slab_covariance(scene, reversed, refinement, change);
      for (Complex& error : changed.error) error *= turn_of_errors;
      all.append(changed);
    }
    return all;
  });
}

GradientJob slab_gradient_job(const Scene& scene, bool reversed, const Refinement& refinement) {
  const auto parameters = slab_parameters(scene);
  const auto solve = [=] {
    Refined all = slab_derivatives(scene, reversed, refinement, parameters.front());
    for (std::size_t p = 1; p < parameters.size(); ++p) {
      Refined one = slab_derivatives(scene, reversed, refinement, parameters[p]);
      for (auto* list : {&one.value, &one.error})
        list->erase(list->begin(), list->begin() + std::ssize(scene.request.entries));
      all.append(one);
    }
    return all;
  };
  std::vector<double> units{0};
  for (const BulkParameter parameter : parameters) units.push_back(unit_of(scene, parameter));
  return gradient_job(two_batch_job(scene, units, solve), parameters, scene);
}

}  // namespace flatspeckle::mc
