#include "apps/moments_output.h"

#include <cstdio>
#include <numeric>

namespace flatspeckle::apps {

namespace {

using Kind = CovarianceRequest::Kind;
using Axes = std::vector<Axis>;

std::vector<double> counting(std::size_t n) {
  std::vector<double> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0.0);
  return numbers;
}

std::vector<double> real_parts(const std::vector<Complex>& values) {
  std::vector<double> real;
  for (Complex value : values) real.push_back(value.real());
  return real;
}

Estimate part(const Estimate& all, std::size_t first, std::size_t count) {
  const auto from = static_cast<std::ptrdiff_t>(first),
             to = from + static_cast<std::ptrdiff_t>(count);
  return {{all.value.begin() + from, all.value.begin() + to},
          {all.error.begin() + from, all.error.begin() + to}};
}

std::string view_axis(const CovarianceRequest& request) {
  return request.views.front().near ? "sensor" : "view_angle";
}

/// Writes datasets of one group; each estimate with its `_error`.
class Group {
 public:
  /// Covariances are in units of the square of the field: far fields are lengths^(1/2), and a
  /// slab's covariance counts per unit length.
  Group(ResultFile& file, const std::string& name, const Scene& scene)
      : file_(file), prefix_(name.empty() ? "" : name + "/") {
    const bool far_field = !scene.request.views.front().near;
    if (far_field && scene.domain.kind == Domain::Kind::box) {
      field_units_ = "length^(1/2)";
      covariance_units_ = "length";
    }
  }

  template <typename Number>
  void write(const std::string& name, const std::vector<Number>& values,
             const std::vector<double>& errors, const Axes& axes, const std::string& units,
             const std::string& long_name) {
    file_.dataset(prefix_ + name, values, axes, units, long_name);
    file_.dataset(prefix_ + name + "_error", errors, axes, units, "standard error: " + long_name);
  }
  void covariance(const Estimate& estimate, const Axes& axes, const std::string& long_name) {
    write("covariance", estimate.value, estimate.error, axes, covariance_units_, long_name);
  }
  void intensity(const std::string& name, const Estimate& estimate, const Axes& axes,
                 const std::string& long_name) {
    write(name, real_parts(estimate.value), estimate.error, axes, covariance_units_, long_name);
  }
  void mean_field(const Estimate& estimate, const Axes& axes, const std::string& long_name) {
    write("mean_field", estimate.value, estimate.error, axes, field_units_, long_name);
  }
  void attribute(const std::string& name, const std::string& key, const Attribute& value) {
    file_.attribute(prefix_ + name, key, value);
  }

 private:
  ResultFile& file_;
  std::string prefix_, field_units_ = "1", covariance_units_ = "1";
};

Estimate unpack_full(const CovarianceRequest& request, const Estimate& triangle) {
  const std::size_t n = request.channels.size();
  Estimate full{std::vector<Complex>(n * n), std::vector<double>(n * n)};
  std::size_t entry = 0;
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b <= a; ++b, ++entry) {
      full.value[b * n + a] = std::conj(triangle.value[entry]);
      full.value[a * n + b] = triangle.value[entry];
      full.error[a * n + b] = full.error[b * n + a] = triangle.error[entry];
    }
  }
  return full;
}

void write_memory_effect(Group& group, const FieldJob& job, const Scene& scene,
                         const GroupedSums& sums, const Estimate& covariance) {
  const CovarianceRequest& request = scene.request;
  const std::size_t views = request.reference_views, tilts = request.tilts.size();
  group.covariance(part(covariance, 0, tilts * views), {"tilt", "view_angle"},
                   "covariance of reference and tilted field");
  group.intensity("reference_intensity", part(covariance, request.reference_intensity(0), views),
                  {"view_angle"}, "variance of the reference field");
  group.intensity("tilted_intensity",
                  part(covariance, request.tilted_intensity(0, 0), tilts * views),
                  {"tilt", "view_angle"}, "variance of the tilted field in the matched view");
  const auto effect = mc::memory_effect(request, sums, job.covariance);
  group.write("field_correlation", effect.correlation, effect.correlation_error, {"tilt"}, "1",
              "field correlation C_E, summed over views");
  const double depth = scene.domain.depth;
  group.write<double>("memory_effect_range", {effect.range.value * depth},
                      {effect.range_error * depth}, {std::size_t{1}}, "1",
                      "q L at C_I = 1/2, L the depth");
  group.attribute("memory_effect_range", "censored",
                  static_cast<std::uint64_t>(effect.range.censored));
}

/// The mean field in the channels that stand on the light and view axes.
void write_mean(Group& group, const CovarianceRequest& request, const Estimate& mean) {
  if (mean.value.empty() || request.kind == Kind::pairs) return;
  if (request.kind != Kind::memory_effect) {
    group.mean_field(mean, {"light_angle", view_axis(request)}, "mean scattered field");
    return;
  }
  Estimate reference;
  for (std::size_t v = 0; v < request.reference_views; ++v) {
    const auto channel = request.entries[request.reference_intensity(v)].a;
    reference.value.push_back(mean.value[channel]);
    reference.error.push_back(mean.error[channel]);
  }
  group.mean_field(reference, {"light_angle", "view_angle"},
                   "mean scattered field of the reference light");
}

void write_pair_axis(ResultFile& file, const CovarianceRequest& request) {
  file.scale("pair", counting(request.entries.size()), "1", "requested pair");
  std::vector<double> angles[4];
  for (const auto& [a, b] : request.entries) {
    angles[0].push_back(request.lights[request.channels[a].light]);
    angles[1].push_back(request.views[request.channels[a].view].angle);
    angles[2].push_back(request.lights[request.channels[b].light]);
    angles[3].push_back(request.views[request.channels[b].view].angle);
  }
  const char* names[] = {"pair_light_1", "pair_view_1", "pair_light_2", "pair_view_2"};
  for (std::size_t i = 0; i < 4; ++i) file.dataset(names[i], angles[i], {"pair"}, "rad", "angle");
}

}  // namespace

void write_domain(ResultFile& file, const Scene& scene) {
  file.attribute("/", "wavelength", scene.wavelength);
  file.attribute("/", "depth", scene.domain.depth);
  if (scene.domain.kind == Domain::Kind::box) file.attribute("/", "width", scene.domain.width);
}

void write_medium(ResultFile& file, const Scene& scene) {
  const auto& medium = scene.medium;
  const auto root = [&](const char* name, double value) { file.attribute("/", name, value); };
  write_domain(file, scene);
  root("g", medium.g);
  root("albedo", medium.albedo);
  root("optical_depth", medium.mu_t * scene.domain.depth);
  if (medium.mu_t > 0) {
    root("mean_free_path", medium.mean_free_path());
    root("transport_mean_free_path", medium.transport_mean_free_path());
    root("k_mean_free_path", scene.k * medium.mean_free_path());
  }
  if (!medium.has_scatterers) return;
  root("sigma_s", medium.cross_sections.scattering);
  root("sigma_e", medium.cross_sections.extinction);
  root("density", medium.density);
  root("packing_fraction", medium.packing_fraction);
  root("k_shift", medium.k_shift);
}

void write_view_axis(ResultFile& file, const std::vector<View>& views) {
  std::vector<double> angle, x, z;
  for (const auto& view : views) {
    angle.push_back(view.angle);
    x.push_back(view.point.x);
    z.push_back(view.point.z);
  }
  if (!views.front().near) {
    file.scale("view_angle", angle, "rad", "direction of view, from +z towards +x");
    return;
  }
  file.scale("sensor", counting(views.size()), "1", "near-field sensor");
  file.dataset("sensor_x", x, {"sensor"}, "length", "transverse position");
  file.dataset("sensor_z", z, {"sensor"}, "length", "depth");
}

void write_axes(ResultFile& file, const CovarianceRequest& request) {
  if (request.kind == Kind::pairs) {
    write_pair_axis(file, request);
    return;
  }
  const bool memory_effect = request.kind == Kind::memory_effect;
  auto lights = request.lights;
  auto views = request.views;
  if (memory_effect) {
    lights.resize(1);
    views.resize(request.reference_views);
  }
  file.scale("light_angle", lights, "rad", "direction of the light, from +z towards +x");
  write_view_axis(file, views);
  if (!memory_effect) return;
  file.scale("tilt", request.tilts, "rad", "rotation of the light");
  file.dataset("tilt_q", request.tilt_q, {"tilt"}, "1/length", "transverse wavenumber of the tilt");
}

std::string range_text(const mc::Range& range, double error) {
  using Censoring = mc::Range::Censoring;
  char text[64];
  if (range.censored == Censoring::above_value)
    std::snprintf(text, sizeof text, "above %.4g, the largest tilt", range.value);
  else if (range.censored == Censoring::below_value)
    std::snprintf(text, sizeof text, "below %.4g, the smallest tilt", range.value);
  else
    std::snprintf(text, sizeof text, "%.4g +- %.2g", range.value, error);
  return text;
}

void write_moments(ResultFile& file, const std::string& group_name, const FieldJob& job,
                   const Scene& scene, const GroupedSums& sums, const FieldMoments& moments) {
  const CovarianceRequest& request = scene.request;
  Group group(file, group_name, scene);
  write_mean(group, request, moments.mean);
  const std::string view = view_axis(request);
  switch (request.kind) {
    case Kind::intensity:
      group.intensity("intensity", moments.covariance, {"light_angle", view},
                      "variance of the field");
      break;
    case Kind::pairs:
      group.covariance(moments.covariance, {"pair"}, "covariance of the pair");
      break;
    case Kind::full:
      group.covariance(unpack_full(request, moments.covariance),
                       {"light_angle", view, "light_angle", view}, "covariance of the fields");
      break;
    case Kind::memory_effect:
      write_memory_effect(group, job, scene, sums, moments.covariance);
      break;
  }
}

}  // namespace flatspeckle::apps
