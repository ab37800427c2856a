#include "mc/estimators/gradient.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>

#include "core/error.h"
#include "core/result/result_group.h"
#include "mc/estimators/directional_slope.h"
#include "mc/estimators/gradient_scorer.h"
#include "mc/estimators/scored_paths.h"
#include "mc/estimators/single_scattering.h"
#include "mc/theory/memory_effect.h"
#include "mc/theory/moments_datasets.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

/// Central differences in mu_t of the closed form, of fourth order. It varies over a mean free path
/// or the whole medium, whichever is less.
template <typename ClosedForm>
Values extinction_slope(const Scene& scene, const ClosedForm& closed_form) {
  const double mu_t = scene.medium.mu_t, across = std::max(scene.domain.depth, scene.domain.width),
               step = 1e-3 * mu_t / std::max(1.0, mu_t * across);
  Values slope(scene.request.entries.size());
  const auto add = [&](double steps, double factor) {
    Scene other = scene;
    other.medium.mu_t += steps * step;
    other.medium.mu_s = scene.medium.albedo * other.medium.mu_t;
    const Values values = closed_form(other);
    for (std::size_t e = 0; e < slope.size(); ++e) slope[e] += factor / (12 * step) * values[e];
  };
  add(1, 8);
  add(-1, -8);
  add(2, -1);
  add(-2, 1);
  return slope;
}

/// d log of the amplitudes' product of every entry.
Values amplitude_slopes(const Scene& scene, const AmplitudeSlope& slope) {
  Values slopes;
  for (const Entry entry : scene.request.entries) {
    const FarField a(scene, entry.a), b(scene, entry.b);
    slopes.push_back(slope(a.light, a.view) + std::conj(slope(b.light, b.view)));
  }
  return slopes;
}

/// Of paths of one scatterer.
Values single_gradient(const PathWalks& walks, const std::vector<MediumSlope>& slopes) {
  const Scene& scene = walks.scene();
  const auto closed_form = [&](const Scene& any) {
    return single_scattering(any, walks.scattering());
  };
  const Values single = closed_form(scene), by_mu_t = extinction_slope(scene, closed_form);
  Values all = single;
  for (const MediumSlope& slope : slopes) {
    const Values turned = amplitude_slopes(scene, slope.amplitude);
    const double mu_t = slope.log_mu_t * scene.medium.mu_t;
    for (std::size_t e = 0; e < single.size(); ++e)
      all.push_back(mu_t * by_mu_t[e] + product(single[e], turned[e] + slope.log_albedo));
  }
  return all;
}

/// [parameter][entry] with the optical depth last.
Estimator gradient_of(const PathJob& job, double depth) {
  return
      [all = job.all, entries = job.entries, depth](double samples, std::span<const Complex> sums) {
        Values values = all(samples, sums);
        values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(entries));
        for (std::size_t e = 0; e < entries; ++e) values.push_back(values[e] / depth);
        return values;
      };
}

/// What f makes of the estimates of each parameter, one after the other.
Estimate each(const Estimate& all, std::size_t parameters,
              const std::function<Estimate(const Estimate&)>& f) {
  const std::size_t size = all.value.size() / parameters;
  Estimate made;
  for (std::size_t p = 0; p < parameters; ++p) append(made, f(part(all, p * size, size)));
  return made;
}

}  // namespace

std::vector<BulkParameter> bulk_parameters(const Scene& scene) {
  switch (scene.scatterer.kind) {
    case Scatterer::Kind::hg:
      return {BulkParameter::mu_t, BulkParameter::g, BulkParameter::albedo};
    case Scatterer::Kind::other_bulk:
    case Scatterer::Kind::point:
      return {BulkParameter::mu_t, BulkParameter::albedo};
    default:
      break;
  }
  if (!scene.scatterer.is_disk() || !scene.medium.structure.independent())
    return {BulkParameter::mu_t};
  if (!scene.scatterer.is_penetrable()) return {BulkParameter::mu_t, BulkParameter::radius};
  return {BulkParameter::mu_t, BulkParameter::radius, BulkParameter::index};
}

GradientJob gradient_job(const PathJob& paths, const std::vector<BulkParameter>& parameters,
                         const Scene& scene) {
  GradientJob job{paths, {}, gradient_of(paths, scene.domain.depth)};
  for (const BulkParameter parameter : parameters) job.parameters.push_back(name_of(parameter));
  job.parameters.emplace_back("optical_depth");
  return job;
}

void check_gradient(const Scene& scene) {
  if (scene.medium.mu_s == 0)
    throw InputError("gradient: a medium that does not scatter has no derivatives");
  if (scene.domain.kind == Domain::Kind::slab && has_near_ends(scene.request))
    throw InputError("gradient: a slab needs plane waves and far views");
  constexpr std::size_t most = 20000;
  if (scene.request.entries.size() > most)
    throw InputError("gradient: " + std::to_string(scene.request.entries.size()) +
                     " entries of the covariance are too many, at most " + std::to_string(most));
}

Plan gradient_plan(const Scene& scene, ReversedPaths reversed) {
  check_gradient(scene);
  Plan plan = make_plan(scene, reversed);
  plan.rank_k = false;
  if (plan.phase == Plan::Phase::isotropic && scene.scatterer.kind == Scatterer::Kind::hg)
    plan.phase = Plan::Phase::henyey_greenstein;
  return plan;
}

GradientJob gradient_job(const Scene& scene, const Plan& plan, std::uint64_t seed) {
  assert(!scene.profile);
  const auto parameters = bulk_parameters(scene);
  std::vector<MediumSlope> slopes;
  for (const BulkParameter parameter : parameters) slopes.push_back(medium_slope(scene, parameter));
  return gradient_job(slope_job(scene, plan, slopes, seed), parameters, scene);
}

PathJob slope_job(const Scene& scene, const Plan& plan, const std::vector<MediumSlope>& slopes,
                  std::uint64_t seed) {
  assert(slopes.size() <= most_slopes);
  const auto shared = std::make_shared<const std::vector<MediumSlope>>(slopes);
  return path_job({1 + slopes.size(),
                   [shared](const PathWalks& walks, std::span<Complex> sums) {
                     return std::make_unique<GradientScorer>(walks, *shared, sums);
                   },
                   [shared](const PathWalks& walks) { return single_gradient(walks, *shared); }},
                  scene, plan, seed);
}

CorrelationGradient memory_effect_gradient(const CovarianceRequest& request,
                                           const GroupedSums& sums, const GradientJob& job) {
  const std::size_t parameters = job.parameters.size(), entries = request.entries.size();
  const Estimate slopes = jackknife(sums, [&](double samples, std::span<const Complex> total) {
    const Values covariance = job.field.covariance(samples, total);
    const Values gradient = job.gradient(samples, total);
    Values all;
    for (std::size_t p = 0; p < parameters; ++p) {
      const auto along = std::span(gradient).subspan(p * entries, entries);
      const Values slope = directional_slope(
          [&](const Values& moved) { return correlation_and_ranges(request, moved); }, covariance,
          along);
      all.insert(all.end(), slope.begin(), slope.end());
    }
    return all;
  });
  CorrelationGradient gradient;
  const std::size_t tilts = request.tilts.size();
  for (std::size_t first = 0; first < slopes.value.size(); first += tilts + 1) {
    append(gradient.correlation, part(slopes, first, tilts));
    append(gradient.range, part(slopes, first + tilts, 1));
  }
  return gradient;
}

GradientEstimates gradient_estimates(const Scene& scene, const GroupedSums& sums,
                                     const GradientJob& job) {
  GradientEstimates gradient{jackknife(sums, job.gradient), {}};
  if (scene.request.kind != CovarianceRequest::Kind::memory_effect) return gradient;
  gradient.effect = memory_effect_gradient(scene.request, sums, job);
  for (Complex& slope : gradient.effect.range.value) slope *= scene.domain.depth;
  for (double& error : gradient.effect.range.error) error *= scene.domain.depth;
  return gradient;
}

const DatasetTable gradient_table{
    .name = "gradient",
    .rows = {{"parameter", Data::numbers, "", "1",
              "what derivatives are by: see the attribute names"}},
    .attributes = {
        {"parameter", "names", "texts",
         "mu_t, g, albedo, radius, index, optical_depth, as far as the scene has them"}}};

void write_gradient(ResultFile& file, const CovarianceRequest& request, const GradientJob& job,
                    const GradientEstimates& gradient) {
  using Kind = CovarianceRequest::Kind;
  const std::size_t parameters = job.parameters.size(), views = request.reference_views,
                    moved = request.moves * views;
  const ResultGroup root(file, gradient_table), out(file, request_table(request.kind));
  root.number("parameter", parameters);
  root.attribute("parameter", "names", job.parameters);
  const auto of_each = [&](const auto& f) { return each(gradient.entries, parameters, f); };
  if (request.kind == Kind::full)
    return out.put("gradient",
                   of_each([&](const Estimate& lower) { return unpack_full(request, lower); }));
  if (request.kind != Kind::memory_effect) return out.put("gradient", gradient.entries);
  const auto entries = [&](std::size_t first, std::size_t count) {
    return of_each([&](const Estimate& all) { return part(all, first, count); });
  };
  out.put("gradient", entries(0, moved));
  out.put("reference_intensity_gradient", entries(request.reference_intensity(0), views));
  out.put("tilted_intensity_gradient", entries(request.tilted_intensity(0, 0), moved));
  out.put("field_correlation_gradient", gradient.effect.correlation);
  out.put("memory_effect_range_gradient", gradient.effect.range);
}

}  // namespace flatspeckle::mc
