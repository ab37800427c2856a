#include "mc/jobs/gradient_job.h"

#include <functional>
#include <span>

#include "core/error.h"
#include "core/result/result_group.h"
#include "flatland/request/field_moments.h"
#include "mc/theory/memory_effect.h"
#include "mc/theory/moments_datasets.h"

namespace flatspeckle::mc {

namespace {

using Values = std::vector<Complex>;

/// Returns an estimator of the derivatives, [parameter][entry]. The last parameter is the optical
/// depth.
Estimator gradient_of(const PathJob& job, double depth) {
  return
      [all = job.all, entries = job.entries, depth](double samples, std::span<const Complex> sums) {
        Values values = all(samples, sums);
        values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(entries));
        for (std::size_t e = 0; e < entries; ++e) values.push_back(values[e] / depth);
        return values;
      };
}

/// Applies f to the estimates of each parameter and concatenates the results.
Estimate each(const Estimate& all, std::size_t parameters,
              const std::function<Estimate(const Estimate&)>& f) {
  const std::size_t size = all.value.size() / parameters;
  Estimate made;
  for (std::size_t p = 0; p < parameters; ++p) append(made, f(part(all, p * size, size)));
  return made;
}

CorrelationGradient memory_effect_gradient(const CovarianceRequest& request,
                                           const GroupedSums& sums, const GradientJob& job) {
  const std::size_t parameters = job.parameters.size(), entries = request.entries.size();
  const Estimate derivatives = jackknife(sums, [&](double samples, std::span<const Complex> total) {
    const Values covariance = job.field.covariance(samples, total);
    const Values gradient = job.gradient(samples, total);
    Values all;
    for (std::size_t p = 0; p < parameters; ++p) {
      const auto along = std::span(gradient).subspan(p * entries, entries);
      const Values derivative = directional_derivative(
          [&](const Values& moved) { return correlation_and_ranges(request, moved); }, covariance,
          along);
      all.insert(all.end(), derivative.begin(), derivative.end());
    }
    return all;
  });
  CorrelationGradient gradient;
  const std::size_t tilts = request.tilts.size();
  for (std::size_t first = 0; first < derivatives.value.size(); first += tilts + 1) {
    append(gradient.correlation, part(derivatives, first, tilts));
    append(gradient.range, part(derivatives, first + tilts, 1));
  }
  return gradient;
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
  if (scene.domain.kind == Domain::Kind::slab && has_near_endpoints(scene.request))
    throw InputError("gradient: domain = slab requires plane waves and far views");
  constexpr std::size_t most = 20000;
  if (scene.request.entries.size() > most)
    throw InputError("gradient: the covariance has " +
                     std::to_string(scene.request.entries.size()) +
                     " entries, but must have at most " + std::to_string(most));
}

GradientEstimates gradient_estimates(const Scene& scene, const GroupedSums& sums,
                                     const GradientJob& job) {
  GradientEstimates gradient{jackknife(sums, job.gradient), {}};
  if (scene.request.kind != CovarianceRequest::Kind::memory_effect) return gradient;
  gradient.effect = memory_effect_gradient(scene.request, sums, job);
  for (Complex& derivative : gradient.effect.range.value) derivative *= scene.domain.depth;
  for (double& error : gradient.effect.range.error) error *= scene.domain.depth;
  return gradient;
}

const DatasetTable gradient_table{
    .name = "gradient",
    .rows = {{"parameter", Data::numbers, "", "1",
              "index of a parameter of the derivatives; the attribute names contains its name"}},
    .attributes = {
        {"parameter", "names", "texts",
         "the parameters of the scene: some of mu_t, g, albedo, radius, index, optical_depth"}}};

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
