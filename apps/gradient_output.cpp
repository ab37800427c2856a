#include "apps/gradient_output.h"

#include <algorithm>
#include <cstdio>
#include <functional>

#include "apps/moments_output.h"
#include "apps/moments_table.h"

namespace flatspeckle::apps {

namespace {

using Kind = CovarianceRequest::Kind;
using Axes = std::vector<Axis>;

/// One estimate per parameter.
using ByParameter = std::vector<Estimate>;

ByParameter by_parameter(const Estimate& all, std::size_t parameters) {
  const std::size_t size = all.value.size() / parameters;
  ByParameter parts;
  for (std::size_t p = 0; p < parameters; ++p) parts.push_back(part(all, p * size, size));
  return parts;
}

ByParameter each(ByParameter parts, const std::function<Estimate(const Estimate&)>& f) {
  for (Estimate& estimate : parts) estimate = f(estimate);
  return parts;
}

/// Writes derivatives, [parameter] before all other axes.
class Gradients {
 public:
  Gradients(ResultFile& file, const std::vector<std::string>& parameters) : file_(file) {
    file_.numbered_scale("parameter", parameters.size(),
                         "what derivatives are by: see the attribute names");
    file_.attribute("parameter", "names", parameters);
  }

  void complex(const std::string& name, const ByParameter& parts, const Axes& axes,
               const std::string& of) {
    std::vector<Complex> values;
    for (const Estimate& part : parts)
      values.insert(values.end(), part.value.begin(), part.value.end());
    write(name, values, parts, axes, of);
  }
  void real(const std::string& name, const ByParameter& parts, const Axes& axes,
            const std::string& of) {
    std::vector<double> values;
    for (const Estimate& part : parts)
      for (const Complex value : part.value) values.push_back(value.real());
    write(name, values, parts, axes, of);
  }

 private:
  template <typename Number>
  void write(const std::string& name, const std::vector<Number>& values, const ByParameter& parts,
             Axes axes, const std::string& of) {
    std::vector<double> errors;
    for (const Estimate& part : parts)
      errors.insert(errors.end(), part.error.begin(), part.error.end());
    axes.insert(axes.begin(), "parameter");
    file_.dataset(name, values, axes, "", "derivative of the " + of);
    file_.dataset(name + "_error", errors, axes, "", "standard error: derivative of the " + of);
  }

  ResultFile& file_;
};

void write_memory_effect(Gradients& out, const CovarianceRequest& request, const ByParameter& parts,
                         const mc::CorrelationGradient& correlation) {
  const std::size_t views = request.reference_views, tilts = request.tilts.size();
  const auto entries = [&](std::size_t first, std::size_t count) {
    return each(parts, [=](const Estimate& all) { return part(all, first, count); });
  };
  const Axes tilt_view = {"tilt", "view_angle"};
  out.complex("gradient", entries(0, tilts * views), tilt_view,
              "covariance of reference and tilted field");
  out.real("reference_intensity_gradient", entries(request.reference_intensity(0), views),
           {"view_angle"}, "variance of the reference field");
  out.real("tilted_intensity_gradient", entries(request.tilted_intensity(0, 0), tilts * views),
           tilt_view, "variance of the tilted field in the matched view");
  out.real("field_correlation_gradient", by_parameter(correlation.correlation, parts.size()),
           {"tilt"}, "field correlation C_E, summed over views");
  out.real("memory_effect_range_gradient", by_parameter(correlation.range, parts.size()), {},
           "range q L at C_I = 1/2; 0 where that is censored");
}

void print_range(const std::vector<std::string>& parameters, const Estimate& range) {
  const bool censored = std::all_of(range.value.begin(), range.value.end(),
                                    [](Complex slope) { return slope == 0.0; });
  if (censored) return;
  for (std::size_t p = 0; p < parameters.size(); ++p)
    std::printf("d/d %-13s of the range q L at C_I = 1/2: %11.5g +- %.2g\n", parameters[p].c_str(),
                range.value[p].real(), range.error[p]);
}

}  // namespace

void write_gradient(ResultFile& file, const Scene& scene, const mc::GradientJob& job,
                    const GroupedSums& sums) {
  const CovarianceRequest& request = scene.request;
  const auto parts = by_parameter(jackknife(sums, job.gradient), job.parameters.size());
  for (std::size_t p = 0; p < parts.size(); ++p)
    print_entries(request, parts[p], "d/d " + job.parameters[p]);
  Gradients out(file, job.parameters);
  const Axes channel = {"light_angle", view_axis(request)};
  switch (request.kind) {
    case Kind::intensity:
      return out.real("gradient", parts, channel, "variance of the field");
    case Kind::pairs:
      return out.complex("gradient", parts, {"pair"}, "covariance of the pair");
    case Kind::full:
      return out.complex(
          "gradient",
          each(parts, [&](const Estimate& triangle) { return unpack_full(request, triangle); }),
          matrix_axes(request), "covariance of the fields");
    case Kind::tilt_shift:
    case Kind::translation:
      return;  // refused before the run
    case Kind::memory_effect:
      auto correlation = mc::memory_effect_gradient(request, sums, job);
      for (Complex& range : correlation.range.value) range *= scene.domain.depth;
      for (double& error : correlation.range.error) error *= scene.domain.depth;
      print_range(job.parameters, correlation.range);
      return write_memory_effect(out, request, parts, correlation);
  }
}

}  // namespace flatspeckle::apps
