#include "grin/design/problem/design_datasets.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/result/result_group.h"
#include "grin/trace/ray_tracing.h"

namespace flatspeckle::grin::design {

const DatasetTable design_table{
    .name = "design",
    .rows =
        {{"history/step", Data::numbers, "", "1", "number of a step of the search; 0: the start"},
         {"history/rms", Data::real, "history/step", "1",
          "root mean square residual of the rays after the step: a length (focus, throughput), a "
          "fraction of the delay (equal_path) or of a picture's largest value (irradiance), an "
          "angle (deflections, collimation)"},
         {"history/traces", Data::real, "history/step", "1",
          "cumulative traces per ray, forward or backward"},
         {"history/cpu_s", Data::real, "history/step", "s", "cumulative processor time"},
         {"history/coefficients", Data::count, "history/step", "1", "number of coefficients"},
         {"rms/seen", Data::real, "", "1", "root mean square residual of the rays of the search"},
         {"rms/seen_half_step", Data::real, "", "1", "rms/seen with half the step length"},
         {"rms/held_out", Data::real, "", "1",
          "root mean square residual of held-out rays, which the search does not use"},
         {"rms/held_out_half_step", Data::real, "", "1", "rms/held_out with half the step length"},
         {"rms/start_held_out", Data::real, "", "1",
          "root mean square residual of the held-out rays in the start field"},
         {"throughput", Data::real, "", "1",
          "fraction of the held-out rays that pass through the aperture, with half the step "
          "length"},
         {"invariants/derivatives", Data::invariant, "", "1",
          "relative difference between the derivatives of the measurements computed with reversed "
          "rays and with finite differences, along one direction in the space of coefficients"},
         {"at_bounds", Data::count, "", "1", "number of coefficients at a bound"},
         {"unseen", Data::count, "", "1",
          "number of coefficients within the field on which no ray of the search depends"},
         {"coefficient_x", Data::numbers, "", "1", "number of a coefficient along x"},
         {"coefficient_y", Data::numbers, "", "1", "number of a coefficient along y"},
         {"coefficient_z", Data::numbers, "", "1", "number of a coefficient along z"},
         {"coefficient", Data::numbers, "", "1", "number of a coefficient along r"},
         {"ball_spline", Data::real, "coefficient_x coefficient_y coefficient_z", "1",
          "coefficients of the spline s of a ball, n = host_index + (1 - r^2/R^2) s"},
         {"radial_spline", Data::real, "coefficient", "1",
          "coefficients of the spline s, n = host_index + (1 - r^2/R^2) s"},
         {"graded_spline", Data::real, "coefficient", "1",
          "coefficients of the spline s of q = (rho/R)^2, n^2 = n0^2 (1 - 2 delta (q^(exponent/2) "
          "+ "
          "q (1 - q) s))"},
         {"node_x", Data::numbers, "", "1", "number of a node along x"},
         {"node_y", Data::numbers, "", "1", "number of a node along y"},
         {"node_z", Data::numbers, "", "1", "number of a node along z"},
         {"excess", Data::real, "node_x node_y node_z", "1", "n - 1 at the nodes of a grid"},
         {"profile/r", Data::scale, "", "length", "distance from the centre"},
         {"profile/index", Data::real, "profile/r", "1",
          "mean index over all directions at the distance profile/r"},
         {"profile/spread", Data::real, "profile/r", "1",
          "largest deviation from profile/index over directions"},
         {"slice_x", Data::scale, "", "length", "x of the slice's points"},
         {"slice_z", Data::scale, "", "length", "z of the slice's points"},
         {"slice_index", Data::real, "slice_x slice_z", "1", "index in the plane y = 0"},
         {"path_ray", Data::numbers, "", "1",
          "number of a plotted ray, in the order of x before the field"},
         {"path_point", Data::numbers, "", "1",
          "number of a point; points are equidistant in arc length"},
         {"before/x", Data::real, "path_ray path_point", "length",
          "x of the points of rays in the start field"},
         {"before/z", Data::real, "path_ray path_point", "length",
          "z of the points of rays in the start field"},
         {"after/x", Data::real, "path_ray path_point", "length",
          "x of the points of rays in the designed field"},
         {"after/z", Data::real, "path_ray path_point", "length",
          "z of the points of rays in the designed field"},
         {"picture/view", Data::numbers, "", "1", "number of a beam"},
         {"picture/row", Data::numbers, "", "1", "number of a row of pixels, from the top"},
         {"picture/column", Data::numbers, "", "1", "number of a column"},
         {"picture/asked", Data::real, "picture/view picture/row picture/column", "1",
          "target fraction of a beam's light on each pixel"},
         {"picture/shown", Data::real, "picture/view picture/row picture/column", "1",
          "fraction of the light of held-out rays on each pixel"},
         {"picture/psnr_db", Data::real, "picture/view", "1",
          "20 log10 of the largest value of picture/asked divided by the root mean square "
          "difference between picture/shown and picture/asked"},
         {"picture/on_screen", Data::real, "picture/view", "1",
          "share of the light of held-out rays that falls on the screen: sum of picture/shown"}},
    .attributes = {
        {"ball_spline", "origin", "float64s",
         "three numbers: position of the first coefficient's knot"},
        {"ball_spline", "spacing", "float64s", "three numbers: spacing of the knots"},
        {"ball_spline", "host_index", "float64", "index around the ball; 1 if absent"},
        {"radial_spline", "host_index", "float64", "index around the ball; 1 if absent"},
        {"radial_spline", "centre", "float64s", "three numbers"},
        {"radial_spline", "radius", "float64", "R"},
        {"graded_spline", "index", "float64", "n0 on the axis"},
        {"graded_spline", "delta", "float64",
         "index contrast: n^2 = n0^2 (1 - 2 delta) at the radius"},
        {"graded_spline", "radius", "float64", "core radius R"},
        {"graded_spline", "exponent", "float64", "exponent of the power law"},
        {"excess", "origin", "float64s", "three numbers: position of the first node"},
        {"excess", "spacing", "float64s", "three numbers"},
        {"picture/asked", "width", "float64", "side of the pictures"},
        {"", "goal", "text", "objective of the design"},
        {"", "focus", "float64", "focal distance from the centre"},
        {"", "ended_by", "text", "rule by which the search ended"},
        {"", "stalled", "bool", "whether the search stopped without the expected decrease"}}};

namespace {

std::vector<double> listed_numbers(const Vec3& x) {
  return {x[0], x[1], x[2]};
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

// The following functions write coefficients of the index, given those of the index relative to the
// host index.

void write_coefficients(const ResultGroup& root, const BallForm& form,
                        const std::vector<double>& values, double host) {
  const FieldGrid grid = form.grid();
  const Vec3 first = grid.origin - grid.spacing;
  for (const char* axis : {"coefficient_x", "coefficient_y", "coefficient_z"})
    root.number(axis, static_cast<std::size_t>(form.nodes) + 2);
  root.put("ball_spline", scaled(values, host));
  root.attribute("ball_spline", "host_index", host);
  root.attribute("ball_spline", "origin", listed_numbers(first));
  root.attribute("ball_spline", "spacing", listed_numbers(grid.spacing));
}
void write_coefficients(const ResultGroup& root, const RadialForm& form,
                        const std::vector<double>& values, double host) {
  root.number("coefficient", values.size());
  root.put("radial_spline", scaled(values, host));
  root.attribute("radial_spline", "host_index", host);
  root.attribute("radial_spline", "centre", listed_numbers(form.centre));
  root.attribute("radial_spline", "radius", form.radius);
}

/// Writes the coefficients of the correction of a guide.
void write_coefficients(const ResultGroup& root, const GuideForm& form,
                        const std::vector<double>& values, double) {
  const GradedGuide field = form.field(values);
  const GradedProfile& profile = field.profile();
  root.number("coefficient", profile.correction().size());
  root.put("graded_spline", profile.correction());
  root.attribute("graded_spline", "index", 1 + profile.core().axis_excess);
  root.attribute("graded_spline", "delta", profile.core().delta);
  root.attribute("graded_spline", "radius", profile.core().radius);
  root.attribute("graded_spline", "exponent", profile.core().exponent);
}
/// Writes n - 1 at the nodes of a box. Two nodes with the host index are added beyond each face, so
/// that the spline through all nodes equals the designed field.
void write_coefficients(const ResultGroup& root, const BoxForm& form,
                        const std::vector<double>& values, double host) {
  constexpr int beyond = 2;
  const SplineField field = form.field(values);
  const FieldGrid grid = form.grid();
  const int nodes = form.nodes + 2 * beyond;
  const Vec3 origin = grid.origin - beyond * grid.spacing;
  std::vector<double> excess;
  const auto is_in = [&](int i) { return i >= beyond && i < form.nodes + beyond; };
  for (int i = 0; i < nodes; ++i)
    for (int j = 0; j < nodes; ++j)
      for (int k = 0; k < nodes; ++k) {
        const Vec3 x = origin + grid.spacing.cwiseProduct(Vec3(i, j, k));
        const double relative = is_in(i) && is_in(j) && is_in(k) ? field.excess(x) : 0;
        excess.push_back(host - 1 + host * relative);
      }
  for (const char* axis : {"node_x", "node_y", "node_z"})
    root.number(axis, static_cast<std::size_t>(nodes));
  root.put("excess", excess);
  root.attribute("excess", "origin", listed_numbers(origin));
  root.attribute("excess", "spacing", listed_numbers(grid.spacing));
}

void write_history(const ResultGroup& root, const DesignHistory& history) {
  root.number("history/step", history.rms.size());
  root.put("history/rms", history.rms);
  root.put("history/traces", history.traces);
  root.put("history/cpu_s", history.cpu_s);
  root.put("history/coefficients", history.coefficients);
}

void write_check(const ResultGroup& root, const DesignCheck& check) {
  const auto put = [&](const char* name, const std::optional<double>& rms) {
    if (rms) root.put(name, *rms);
  };
  put("rms/seen", check.seen);
  put("rms/seen_half_step", check.seen_half_step);
  put("rms/held_out", check.held_out);
  put("rms/held_out_half_step", check.held_out_half_step);
  put("rms/start_held_out", check.start_held_out);
  if (check.derivatives) root.check("invariants/derivatives", *check.derivatives);
}

/// Writes, for each distance from the centre or axis, the mean index over all directions
/// (transverse directions for a guide) and the largest deviation from this mean.
template <IndexField F>
void write_profile(const ResultGroup& root, const F& field, double radius, bool is_guide,
                   double host) {
  constexpr int radii = 101, directions = 50;
  std::vector<double> r, mean, spread;
  for (int i = 0; i < radii; ++i) {
    r.push_back(radius * i / (radii - 1));
    std::vector<double> found;
    double sum = 0, most = 0;
    for (int d = 0; d < directions; ++d) {
      const double z = is_guide ? 0 : 1 - (2 * d + 1.0) / directions, rho = std::sqrt(1 - z * z);
      const Vec3 along(rho * std::cos(2.4 * d), rho * std::sin(2.4 * d), z);
      found.push_back(host * index(field, (r.back() * along).eval()));
      sum += found.back();
    }
    mean.push_back(sum / directions);
    for (const double n : found) most = std::max(most, std::abs(n - mean.back()));
    spread.push_back(most);
  }
  root.put("profile/r", r);
  root.put("profile/index", mean);
  root.put("profile/spread", spread);
}

template <IndexField F>
void write_slice(const ResultGroup& root, const F& field, const Surface& hull, double radius,
                 double host) {
  constexpr int pixels = 101;
  std::vector<double> places, map;
  for (int i = 0; i < pixels; ++i) places.push_back(radius * (2.0 * i / (pixels - 1) - 1));
  for (const double x : places)
    for (const double z : places) {
      const Vec3 at(x, 0, z);
      map.push_back(host * (distance(hull, at) < 0 ? index(field, at) : 1));
    }
  root.put("slice_x", places);
  root.put("slice_z", places);
  root.put("slice_index", map);
}

/// Traces parallel rays along z for a plot: through a ball, each ray from slightly before it to
/// slightly behind it, or between the faces of a box.
template <class F>
std::vector<TracedRay> drawn_rays(const F& field, double radius, std::size_t points) {
  SceneField scene{facts(field), field};
  constexpr int rays = 21;
  const double start = scene.grid ? -(1 - 1e-9) * radius : -1.3 * radius;
  std::vector<RayStart> starts;
  for (int i = 0; i < rays; ++i)
    starts.push_back({{0.98 * radius * (2.0 * i / (rays - 1) - 1), 0, start}, Vec3::UnitZ()});
  const Plane stop{{0, 0, 1.5 * radius}, Vec3::UnitZ()};
  return trace_rays(scene, {}, {{stop}, 8 * radius, 1e-10 * radius}, {Sharma(), radius / 20, 1e-8},
                    starts, points);
}

void write_rays(const ResultGroup& root, const std::string& group,
                const std::vector<TracedRay>& rays) {
  for (const int axis : {0, 2}) {
    std::vector<double> values;
    for (const TracedRay& ray : rays)
      for (const Vec3& x : ray.path) values.push_back(x[axis]);
    root.put(group + '/' + "xyz"[axis], values);
  }
}

void write_drawings(const ResultGroup& root, const Surface& hull, const auto& form,
                    const DesignScene& scene, const std::vector<double>& coefficients) {
  constexpr std::size_t points = 61;
  const auto field = form.field(coefficients);
  write_slice(root, field, hull, form.radius, scene.start.host_index);
  const auto rays = drawn_rays(field, form.radius, points);
  root.number("path_ray", rays.size());
  root.number("path_point", points);
  std::vector<double> start(form.shape().size(), scene.start.coefficients.front());
  bounds_of(form, scene.start.least_index, scene.start.most_index).hold(start);
  write_rays(root, "before", drawn_rays(form.field(start), form.radius, points));
  write_rays(root, "after", rays);
}

/// Returns the peak signal-to-noise ratio, in dB, of a picture against the requested one.
double psnr_of(const ScreenPicture& picture, const ScreenPicture& requested) {
  double square = 0;
  for (std::size_t p = 0; p < picture.values.size(); ++p)
    square += std::pow(picture.values[p] - requested.values[p], 2) /
              static_cast<double>(picture.values.size());
  return 20 * std::log10(std::ranges::max(requested.values) / std::sqrt(square));
}

void write_pictures(const ResultGroup& root, const ScreenTarget& design_target,
                    const std::vector<double>& measurements) {
  std::vector<double> asked_all, shown_all;
  const auto pictures = design_target.shown_by(measurements, true);
  for (std::size_t v = 0; v < pictures.size(); ++v) {
    const ScreenPicture asked = shown(design_target.views()[v].picture);
    asked_all.insert(asked_all.end(), asked.values.begin(), asked.values.end());
    shown_all.insert(shown_all.end(), pictures[v].values.begin(), pictures[v].values.end());
  }
  const auto pixels = static_cast<std::size_t>(pictures.front().pixels);
  root.number("picture/view", pictures.size());
  root.number("picture/row", pixels);
  root.number("picture/column", pixels);
  root.put("picture/asked", asked_all);
  root.put("picture/shown", shown_all);
  const PictureQuality quality = picture_quality(design_target, measurements);
  root.put("picture/psnr_db", quality.psnr_db);
  root.put("picture/on_screen", quality.on_screen);
  root.attribute("picture/asked", "width", pictures.front().width);
}

}  // namespace

PictureQuality picture_quality(const ScreenTarget& design_target,
                               const std::vector<double>& measurements) {
  PictureQuality quality;
  const auto pictures = design_target.shown_by(measurements, true);
  for (std::size_t v = 0; v < pictures.size(); ++v) {
    const std::vector<double>& light = pictures[v].values;
    quality.psnr_db.push_back(psnr_of(pictures[v], shown(design_target.views()[v].picture)));
    quality.on_screen.push_back(std::accumulate(light.begin(), light.end(), 0.0));
  }
  return quality;
}

void write_design(ResultFile& file, const DesignScene& scene, const Designer& designer,
                  const DesignState& state, const DesignCheck& check) {
  const ResultGroup root(file, design_table);
  const std::vector<double>& coefficients = state.search.coefficients;
  write_history(root, state.history);
  write_check(root, check);
  root.put("at_bounds", static_cast<std::uint64_t>(designer.at_bounds(state)));
  root.put("unseen", static_cast<std::uint64_t>(check.unseen));
  if (scene.goal == ThroughputValues::word) root.put("throughput", check.in_place);
  root.attribute("goal", scene.goal);
  if (scene.focus) root.attribute("focus", *scene.focus);
  root.attribute("stalled", state.stalled);
  root.attribute("ended_by", state.ended_by);
  const FieldForm form = designer.form(state);
  const double host = scene.start.host_index;
  std::visit([&](const auto& of) { write_coefficients(root, of, coefficients, host); }, form);
  if (const auto* guide = std::get_if<GuideForm>(&form))
    write_profile(root, guide->field(coefficients), guide->core.radius, true, 1);
  const auto draw = [&]<class Form>(const Form& of) {
    if constexpr (!std::same_as<Form, GuideForm>) {
      write_profile(root, of.field(coefficients), of.radius, false, host);
      write_drawings(root, *hull_of(form), of, scene, coefficients);
    }
  };
  std::visit(draw, form);
  if (const auto* design_target = dynamic_cast<const ScreenTarget*>(scene.design_target.get());
      design_target && check.measurements)
    write_pictures(root, *design_target, *check.measurements);
}

}  // namespace flatspeckle::grin::design
