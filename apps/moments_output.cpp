#include "apps/moments_output.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/moments_group.h"
#include "apps/moves_output.h"

namespace flatspeckle::apps {

namespace {

using Kind = CovarianceRequest::Kind;

/// The mean field in the channels that stand on the light and view axes.
void write_mean(MomentsGroup& group, const CovarianceRequest& request, const Estimate& mean) {
  if (mean.value.empty() || request.kind == Kind::pairs) return;
  if (!request.has_reference()) {
    group.mean_field(mean, {light_axis(request), view_axis(request)}, "mean scattered field");
    return;
  }
  Estimate reference;
  for (std::size_t v = 0; v < request.reference_views; ++v) {
    const auto channel = request.entries[request.reference_intensity(v)].a;
    reference.value.push_back(mean.value[channel]);
    reference.error.push_back(mean.error[channel]);
  }
  group.mean_field(reference, {light_axis(request), view_axis(request)},
                   "mean scattered field of the reference light");
}

void write_pair_axis(ResultFile& file, const CovarianceRequest& request) {
  file.numbered_scale("pair", request.entries.size(), "requested pair");
  std::vector<double> angles[4];
  for (const auto& [a, b] : request.entries) {
    angles[0].push_back(request.lights[request.channels[a].light].angle);
    angles[1].push_back(request.views[request.channels[a].view].angle);
    angles[2].push_back(request.lights[request.channels[b].light].angle);
    angles[3].push_back(request.views[request.channels[b].view].angle);
  }
  const char* names[] = {"pair_light_1", "pair_view_1", "pair_light_2", "pair_view_2"};
  for (std::size_t i = 0; i < 4; ++i) file.dataset(names[i], angles[i], {"pair"}, "rad", "angle");
}

/// The second half of matrix_axes.
void write_second_axes(ResultFile& file, const CovarianceRequest& request) {
  const std::string light = light_axis(request) + "_2", view = view_axis(request) + "_2";
  if (light == "light_angle_2")
    file.scale(light, request.lights.angles(), "rad", "direction of the second light");
  else
    file.numbered_scale(light, request.lights.size(), "second light");
  std::vector<double> angles;
  for (const View& seen : request.views) angles.push_back(seen.angle);
  if (view == "view_angle_2")
    file.scale(view, angles, "rad", "direction of the second view");
  else
    file.numbered_scale(view, request.views.size(), "second near-field sensor");
}

}  // namespace

Estimate part(const Estimate& all, std::size_t first, std::size_t count) {
  const auto from = static_cast<std::ptrdiff_t>(first),
             to = from + static_cast<std::ptrdiff_t>(count);
  return {{all.value.begin() + from, all.value.begin() + to},
          {all.error.begin() + from, all.error.begin() + to}};
}

std::string light_axis(const CovarianceRequest& request) {
  return request.lights.all(Light::Kind::plane) ? "light_angle" : "light";
}

std::string view_axis(const CovarianceRequest& request) {
  return request.views.front().near ? "sensor" : "view_angle";
}

// Each axis has a scale of its own: xarray cannot tell two axes of one name apart.
std::vector<Axis> matrix_axes(const CovarianceRequest& request) {
  const std::string light = light_axis(request), view = view_axis(request);
  return {light, view, light + "_2", view + "_2"};
}

std::string covariance_units(const Scene& scene) {
  const bool far_field = !scene.request.views.front().near;
  return far_field && scene.domain.kind == Domain::Kind::box ? "length" : "1";
}

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
  file.numbered_scale("sensor", views.size(), "near-field sensor");
  file.dataset("sensor_x", x, {"sensor"}, "length", "transverse position");
  file.dataset("sensor_z", z, {"sensor"}, "length", "depth");
}

void write_light_axis(ResultFile& file, const Lights& lights) {
  std::vector<double> angle, x, z;
  for (const Light& light : lights) {
    angle.push_back(light.angle);
    x.push_back(light.point.x);
    z.push_back(light.point.z);
  }
  const char* direction = "direction of the light, from +z towards +x";
  if (lights.all(Light::Kind::plane)) {
    file.scale("light_angle", angle, "rad", direction);
    return;
  }
  const bool beams = lights.all(Light::Kind::beam);
  file.numbered_scale("light", lights.size(), beams ? "Gaussian beam" : "point source");
  file.dataset("light_x", x, {"light"}, "length", "transverse position of the focus or source");
  file.dataset("light_z", z, {"light"}, "length", "depth of the focus or source");
  if (!beams) return;
  file.dataset("light_angle", angle, {"light"}, "rad", direction);
  file.attribute("/", "beam_waist", lights.front().waist);
}

void write_move_axes(ResultFile& file, const CovarianceRequest& request) {
  if (!request.tilts.empty()) {
    file.scale("tilt", request.tilts, "rad", "rotation of the light");
    file.dataset("tilt_q", request.tilt_q, {"tilt"}, "1/length",
                 "transverse wavenumber of the tilt");
  }
  if (request.shifts.empty()) return;
  const bool far = request.kind == Kind::tilt_shift && !request.views.front().near;
  file.scale("shift", request.shifts, far ? "1/length" : "length",
             far ? "change of k sin(view)" : "translation along x");
}

void write_axes(ResultFile& file, const CovarianceRequest& request) {
  if (request.kind == Kind::pairs) {
    write_pair_axis(file, request);
    return;
  }
  auto lights = request.lights;
  auto views = request.views;
  if (request.has_reference()) {
    lights.resize(1);
    views.resize(request.reference_views);
  }
  write_light_axis(file, lights);
  write_view_axis(file, views);
  write_move_axes(file, request);
  if (request.kind == Kind::full) write_second_axes(file, request);
}

std::size_t steps_below(const std::vector<double>& steps, const mc::Range& range) {
  return static_cast<std::size_t>(std::count_if(steps.begin(), steps.end(), [&](double step) {
    return std::abs(step) > 0 && std::abs(step) < range.value;
  }));
}

bool few_steps(const std::vector<double>& steps, const mc::Range& range) {
  constexpr std::size_t enough = 4;
  return range.censored == mc::Range::Censoring::none && steps_below(steps, range) < enough;
}

void note_few_steps() {
  std::fputs(
      "note: a range is read off a curve with fewer than four points below it; its error bar does "
      "not know what the curve does between them\n",
      stderr);
}

std::string range_text(const mc::Range& range, double error) {
  using Censoring = mc::Range::Censoring;
  char text[64];
  if (range.censored == Censoring::above_value)
    std::snprintf(text, sizeof text, "above %.4g, the largest step", range.value);
  else if (range.censored == Censoring::below_value)
    std::snprintf(text, sizeof text, "below %.4g, the smallest step", range.value);
  else
    std::snprintf(text, sizeof text, "%.4g +- %.2g", range.value, error);
  return text;
}

void write_moments(ResultFile& file, const std::string& group_name, const FieldJob& job,
                   const Scene& scene, const GroupedSums& sums, const FieldMoments& moments) {
  const CovarianceRequest& request = scene.request;
  MomentsGroup group(file, group_name, scene);
  write_mean(group, request, moments.mean);
  const std::string light = light_axis(request), view = view_axis(request);
  switch (request.kind) {
    case Kind::intensity:
      group.intensity("intensity", moments.covariance, {light, view}, "variance of the field");
      break;
    case Kind::pairs:
      group.covariance("covariance", moments.covariance, {"pair"}, "covariance of the pair");
      break;
    case Kind::full:
      group.covariance("covariance", unpack_full(request, moments.covariance), matrix_axes(request),
                       "covariance of the fields");
      break;
    case Kind::memory_effect:
    case Kind::tilt_shift:
    case Kind::translation:
      write_moves(group, job, scene, sums, moments.covariance);
      break;
  }
}

}  // namespace flatspeckle::apps
