#include "flatland/scene/scene_datasets.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/result/result_group.h"

namespace flatspeckle {

const DatasetTable scene_table{
    .name = "scene",
    .rows = {},
    .attributes = {
        {"", "wavelength", "float64",
         "wavelength in the medium around the scatterers, in the unit of the scene's lengths"},
        {"", "vacuum_wavelength", "float64", "wavelength in vacuum, if medium_index is given"},
        {"", "medium_index", "float64", "refractive index around the scatterers, if given"},
        {"", "outside_index", "float64",
         "refractive index outside the faces, if medium_index is given; all angles are then those "
         "outside"},
        {"", "polarisation", "text", "reflection at the faces: tm, te or unpolarised"},
        {"", "depth", "float64", "depth L of the medium"},
        {"", "width", "float64", "width of a box"},
        {"", "height", "float64", "height of a box in space"},
        {"", "optical_depth", "float64", "mu_t L"},
        {"", "dimension", "uint64",
         "3 for scalar waves in space, where covariances of slabs are per illuminated area; absent "
         "in "
         "2D"},
        {"", "g", "float64", "mean cosine of scattering"},
        {"", "albedo", "float64", "mu_s/mu_t"},
        {"", "mu_t", "float64", "extinction coefficient"},
        {"", "mu_s", "float64", "scattering coefficient"},
        {"", "reduced_scattering", "float64", "mu_s' = mu_s (1 - g)"},
        {"", "mean_free_path", "float64", "1/mu_t"},
        {"", "transport_mean_free_path", "float64", "l* = 1/(mu_a + mu_s (1 - g))"},
        {"", "k_mean_free_path", "float64", "k/mu_t"},
        {"", "sigma_s", "float64", "scattering cross section (in 2D a length) of one scatterer"},
        {"", "sigma_e", "float64", "extinction cross section of one scatterer"},
        {"", "scattering_efficiency", "float64",
         "Q_sca, sigma_s divided by the geometric cross section (in 2D the diameter)"},
        {"", "extinction_efficiency", "float64",
         "Q_ext, sigma_e divided by the geometric cross section"},
        {"", "diameter", "float64", "diameter of the cylinders or spheres"},
        {"", "size_parameter", "float64", "k times the radius of the cylinders or spheres"},
        {"", "density", "float64", "scatterers per area, in 3D per volume"},
        {"", "packing_fraction", "float64",
         "fraction of the area (in 3D of the volume) that scatterers fill"},
        {"", "k_shift", "float64", "real part of the effective wavenumber, minus k"},
        {"", "index_front", "float64",
         "index around the scatterers at x = z = 0, where n^2 is linear or parabolic"},
        {"", "index_back", "float64",
         "index around the scatterers at x = 0, z = depth, where n^2 is linear or parabolic"},
    }};

const DatasetTable axes_table{
    .name = "axes",
    .rows = {{"light_angle", Data::scale, "", "rad", "direction of the light, from +z towards +x"},
             {"light_azimuth", Data::real, "light_angle", "rad",
              "azimuth of the light, from x towards y, if it is not in the plane y = 0"},
             {"light", Data::numbers, "", "1", "number of the beam or point source"},
             {"light_x", Data::real, "light", "length",
              "transverse position of the focus or source"},
             {"light_y", Data::real, "light", "length",
              "second transverse position of the focus or source, in space"},
             {"light_z", Data::real, "light", "length", "depth of the focus or source"},
             {"view_angle", Data::scale, "", "rad", "direction of view, from +z towards +x"},
             {"view_azimuth", Data::real, "view_angle", "rad",
              "azimuth of the view, from x towards y, if it is not in the plane y = 0"},
             {"camera_x", Data::scale, "", "1", "direction cosine along x of a column of pixels"},
             {"camera_y", Data::scale, "", "1", "direction cosine along y of a row of pixels"},
             {"sensor", Data::numbers, "", "1", "number of the near-field sensor"},
             {"sensor_x", Data::real, "sensor", "length", "transverse position"},
             {"sensor_y", Data::real, "sensor", "length", "second transverse position, in space"},
             {"sensor_z", Data::real, "sensor", "length", "depth"},
             {"light_angle_2", Data::scale, "", "rad", "direction of the second light"},
             {"light_2", Data::numbers, "", "1", "number of the second light"},
             {"view_angle_2", Data::scale, "", "rad", "direction of the second view"},
             {"sensor_2", Data::numbers, "", "1", "number of the second near-field sensor"},
             {"pair", Data::numbers, "", "1", "number of the requested pair"},
             {"pair_light_1", Data::real, "pair", "rad", "angle of the first light"},
             {"pair_view_1", Data::real, "pair", "rad", "angle of the first view"},
             {"pair_light_2", Data::real, "pair", "rad", "angle of the second light"},
             {"pair_view_2", Data::real, "pair", "rad", "angle of the second view"},
             {"tilt", Data::scale, "", "rad", "rotation of the light"},
             {"tilt_q", Data::real, "tilt", "1/length", "transverse wavenumber of the tilt"},
             {"shift", Data::scale, "", "SHIFT", "change of k sin(view), or translation along x"}},
    .attributes = {{"tilt_q", "azimuth", "float64",
                    "azimuth of the tilts, from x towards y, if they are not in the plane y = 0"}},
    .roles = {{"LIGHT", {"light_angle", "light", "map_wave"}},
              {"VIEW", {"view_angle", "sensor", "camera_y camera_x", "image_y image_x"}},
              {"LIGHT_2", {"light_angle_2", "light_2"}},
              {"VIEW_2", {"view_angle_2", "sensor_2"}},
              {"SHIFT", {"1/length", "length"}},
              {"FIELD", {"length^(1/2)", "length", "1"}},
              {"COVARIANCE", {"length", "length^2", "1"}}}};

const DatasetTable beams_table{
    .name = "beams",
    .rows = {{"light_angle", Data::real, "light", "rad",
              "direction of the light, from +z towards +x"}},
    .attributes = {{"", "beam_waist", "float64", "1/e radius of the field"}}};

namespace {

using Kind = CovarianceRequest::Kind;

// Writes the axes of the second light and view. They repeat the values of the first ones under
// other names, because xarray cannot distinguish two axes with one name.
void write_second_axes(ResultFile& file, const CovarianceRequest& request) {
  const ResultGroup root(file, axes_table);
  const bool plane = request.lights.all(Light::Kind::plane), near = request.views.front().near;
  file.bind("LIGHT_2", {plane ? "light_angle_2" : "light_2"});
  file.bind("VIEW_2", {near ? "sensor_2" : "view_angle_2"});
  if (plane) root.put("light_angle_2", request.lights.angles());
  if (!plane) root.number("light_2", request.lights.size());
  if (near) root.number("sensor_2", request.views.size());
  if (!near) root.put("view_angle_2", column(request.views, &View::angle));
}

void write_pair_axis(const ResultGroup& root, const CovarianceRequest& request) {
  root.number("pair", request.entries.size());
  const auto write = [&](const std::string& number, std::uint32_t Entry::*end) {
    const auto channel = [&](const Entry& entry) { return request.channels[entry.*end]; };
    root.put("pair_light_" + number, column(request.entries, [&](const Entry& entry) {
               return request.lights[channel(entry).light].angle;
             }));
    root.put("pair_view_" + number, column(request.entries, [&](const Entry& entry) {
               return request.views[channel(entry).view].angle;
             }));
  };
  write("1", &Entry::a);
  write("2", &Entry::b);
}

void write_move_axes(ResultFile& file, const CovarianceRequest& request) {
  const ResultGroup root(file, axes_table);
  if (!request.tilts.empty()) {
    root.put("tilt", request.tilts);
    root.put("tilt_q", request.tilt_q);
    if (request.tilt_azimuth != 0) root.attribute("tilt_q", "azimuth", request.tilt_azimuth);
  }
  const bool far = request.kind == Kind::tilt_shift && !request.views.front().near;
  file.bind("SHIFT", {far ? "1/length" : "length"});
  if (!request.shifts.empty()) root.put("shift", request.shifts);
}

/// Writes the azimuths of lights or views if any of them is not 0.
template <typename Ends>
void put_azimuths(const ResultGroup& root, const std::string& name, const Ends& ends) {
  const auto azimuths = column(ends, [](const auto& end) { return end.azimuth; });
  if (std::ranges::any_of(azimuths, [](double azimuth) { return azimuth != 0; }))
    root.put(name, azimuths);
}

/// Writes the properties of the scatterers, if the medium is not only a phase function.
void write_scatterers(const ResultGroup& root, const Scene& scene) {
  const BulkMedium& medium = scene.medium;
  if (!medium.has_scatterers && !(medium.density > 0)) return;
  root.attribute("density", medium.density);
  root.attribute("packing_fraction", medium.packing_fraction);
  if (medium.has_scatterers) root.attribute("k_shift", medium.k_shift);
  if (scene.profile) return;
  root.attribute("sigma_s", medium.cross_sections.scattering);
  root.attribute("sigma_e", medium.cross_sections.extinction);
  const double radius = scene.scatterer.radius;
  if (!(radius > 0)) return;
  const double geometric = medium.dimension == 3 ? std::numbers::pi * radius * radius : 2 * radius;
  root.attribute("scattering_efficiency", medium.cross_sections.scattering / geometric);
  root.attribute("extinction_efficiency", medium.cross_sections.extinction / geometric);
  root.attribute("diameter", 2 * radius);
  root.attribute("size_parameter", scene.k * radius);
}

}  // namespace

void write_domain(ResultFile& file, const Scene& scene) {
  const ResultGroup root(file, scene_table);
  if (scene.medium.dimension == 3) root.attribute("dimension", std::uint64_t{3});
  root.attribute("wavelength", scene.wavelength);
  if (scene.faces) {
    root.attribute("vacuum_wavelength", scene.wavelength * scene.faces->inside);
    root.attribute("medium_index", scene.faces->inside);
    root.attribute("outside_index", scene.faces->outside);
    root.attribute("polarisation",
                   polarisation_words[static_cast<std::size_t>(scene.faces->polarisation)]);
  }
  root.attribute("depth", scene.domain.depth);
  if (scene.domain.kind == Domain::Kind::box) root.attribute("width", scene.domain.width);
  if (scene.domain.height > 0) root.attribute("height", scene.domain.height);
}

void write_medium(ResultFile& file, const Scene& scene) {
  const auto& medium = scene.medium;
  const ResultGroup root(file, scene_table);
  write_domain(file, scene);
  root.attribute("g", medium.g);
  root.attribute("albedo", medium.albedo);
  root.attribute("optical_depth", medium.mu_t * scene.domain.depth);
  root.attribute("mu_t", medium.mu_t);
  root.attribute("mu_s", medium.mu_s);
  root.attribute("reduced_scattering", medium.reduced_scattering());
  if (medium.mu_t > 0) {
    root.attribute("mean_free_path", medium.mean_free_path());
    root.attribute("transport_mean_free_path", medium.transport_mean_free_path());
    root.attribute("k_mean_free_path", scene.k * medium.mean_free_path());
  }
  if (scene.profile) scene.profile->write(file);
  if (scene.index && scene.index->is_quadratic()) {
    root.attribute("index_front", std::sqrt(scene.index->square({0, 0})));
    root.attribute("index_back", std::sqrt(scene.index->square({0, scene.domain.depth})));
  }
  write_scatterers(root, scene);
}

void bind_units(ResultFile& file, const Scene& scene) {
  const bool lengths = !scene.request.views.front().near && scene.domain.kind == Domain::Kind::box,
             space = scene.medium.dimension == 3;
  file.bind("FIELD", {!lengths ? "1" : space ? "length" : "length^(1/2)"});
  file.bind("COVARIANCE", {!lengths ? "1" : space ? "length^2" : "length"});
}

void write_light_axis(ResultFile& file, const Lights& lights) {
  const ResultGroup root(file, axes_table);
  const bool plane = lights.all(Light::Kind::plane);
  file.bind("LIGHT", {plane ? "light_angle" : "light"});
  if (plane) {
    root.put("light_angle", lights.angles());
    return put_azimuths(root, "light_azimuth", lights);
  }
  root.number("light", lights.size());
  root.put("light_x", column(lights, [](const Light& light) { return light.point.x; }));
  if (std::ranges::any_of(lights, [](const Light& light) { return light.point.y != 0; }))
    root.put("light_y", column(lights, [](const Light& light) { return light.point.y; }));
  root.put("light_z", column(lights, [](const Light& light) { return light.point.z; }));
  if (!lights.all(Light::Kind::beam)) return;
  const ResultGroup beams(file, beams_table);
  beams.put("light_angle", lights.angles());
  beams.attribute("beam_waist", lights.front().waist);
}

void write_view_axis(ResultFile& file, const std::vector<View>& views,
                     const std::optional<FarCamera>& camera) {
  const ResultGroup root(file, axes_table);
  if (camera) {
    file.bind("VIEW", {"camera_y", "camera_x"});
    std::vector<double> x, y;
    for (std::size_t i = 0; i < camera->pixels; ++i) {
      x.push_back(camera->cosine(camera->axis.x, i));
      y.push_back(camera->cosine(camera->axis.y, i));
    }
    root.put("camera_x", x);
    return root.put("camera_y", y);
  }
  const bool near = views.front().near;
  file.bind("VIEW", {near ? "sensor" : "view_angle"});
  if (!near) {
    root.put("view_angle", column(views, &View::angle));
    return put_azimuths(root, "view_azimuth", views);
  }
  root.number("sensor", views.size());
  root.put("sensor_x", column(views, [](const View& view) { return view.point.x; }));
  if (std::ranges::any_of(views, [](const View& view) { return view.point.y != 0; }))
    root.put("sensor_y", column(views, [](const View& view) { return view.point.y; }));
  root.put("sensor_z", column(views, [](const View& view) { return view.point.z; }));
}

void write_axes(ResultFile& file, const Scene& scene) {
  const CovarianceRequest& request = scene.request;
  bind_units(file, scene);
  if (request.kind == Kind::pairs) return write_pair_axis({file, axes_table}, request);
  Lights lights = request.lights;
  auto views = request.views;
  if (request.has_reference()) {
    lights.resize(1);
    views.resize(request.reference_views);
  }
  write_light_axis(file, lights);
  write_view_axis(file, views, request.camera);
  write_move_axes(file, request);
  if (request.kind == Kind::full) write_second_axes(file, request);
}

}  // namespace flatspeckle
