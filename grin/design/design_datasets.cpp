#include "grin/design/design_datasets.h"

#include <cmath>
#include <numbers>

#include "core/result/result_group.h"
#include "grin/scene/ray_tracing.h"

namespace flatspeckle::grin::design {

const DatasetTable design_table{
    .name = "design",
    .rows =
        {{"history/step", Data::numbers, "", "1", "number of a step of the search; 0: the start"},
         {"history/rms", Data::real, "history/step", "length",
          "what rays miss by after it, root mean square"},
         {"history/traces", Data::real, "history/step", "1",
          "how often each ray was traced by then, forward or backward"},
         {"history/cpu_s", Data::real, "history/step", "s", "processor time by then"},
         {"history/coefficients", Data::count, "history/step", "1", "how many there were"},
         {"rms/seen", Data::real, "", "length", "what the rays of the search miss by"},
         {"rms/seen_half_step", Data::real, "", "length", "the same by steps of half the length"},
         {"rms/held_out", Data::real, "", "length", "what rays that it has not seen miss by"},
         {"rms/held_out_half_step", Data::real, "", "length",
          "the same by steps of half the length"},
         {"coefficient_x", Data::numbers, "", "1", "number of a coefficient along x"},
         {"coefficient_y", Data::numbers, "", "1", "number of a coefficient along y"},
         {"coefficient_z", Data::numbers, "", "1", "number of a coefficient along z"},
         {"coefficient", Data::numbers, "", "1", "number of a coefficient along r^2"},
         {"ball_spline", Data::real, "coefficient_x coefficient_y coefficient_z", "1",
          "coefficients of the spline s of a ball, n = 1 + (1 - r^2/R^2) s"},
         {"radial_spline", Data::real, "coefficient", "1",
          "coefficients of the spline s of r^2/R^2, n = 1 + (1 - r^2/R^2) s"},
         {"profile/r", Data::scale, "", "length", "distance from the centre"},
         {"profile/index", Data::real, "profile/r", "1", "index there, mean over directions"},
         {"profile/spread", Data::real, "profile/r", "1",
          "largest difference from it over directions"},
         {"slice_x", Data::scale, "", "length", "x of the slice's points"},
         {"slice_z", Data::scale, "", "length", "z of the slice's points"},
         {"slice_index", Data::real, "slice_x slice_z", "1", "index in the plane y = 0"},
         {"path_ray", Data::numbers, "", "1", "number of a drawn ray, along x before the field"},
         {"path_point", Data::numbers, "", "1", "number of a point, evenly in arc length"},
         {"before/x", Data::real, "path_ray path_point", "length", "x of the points at the start"},
         {"before/z", Data::real, "path_ray path_point", "length", "z of the points at the start"},
         {"after/x", Data::real, "path_ray path_point", "length", "x of the points at the end"},
         {"after/z", Data::real, "path_ray path_point", "length", "z of the points at the end"}},
    .attributes = {{"ball_spline", "origin", "float64s",
                    "three numbers: where the first coefficient's knot lies"},
                   {"ball_spline", "spacing", "float64s", "three numbers: of the knots"},
                   {"radial_spline", "centre", "float64s", "three numbers"},
                   {"radial_spline", "radius", "float64", "R"},
                   {"", "focus", "float64", "where light is to meet, from the centre"},
                   {"", "stalled", "bool", "the search found no way on"}}};

namespace {

void write_coefficients(const ResultGroup& root, const BallForm& form,
                        const std::vector<double>& values) {
  const FieldGrid grid = form.grid();
  const Vec3 first = grid.origin - grid.spacing;
  for (const char* axis : {"coefficient_x", "coefficient_y", "coefficient_z"})
    root.number(axis, static_cast<std::size_t>(form.nodes) + 2);
  root.put("ball_spline", values);
  root.attribute("ball_spline", "origin", std::vector<double>{first[0], first[1], first[2]});
  root.attribute("ball_spline", "spacing",
                 std::vector<double>{grid.spacing[0], grid.spacing[1], grid.spacing[2]});
}
void write_coefficients(const ResultGroup& root, const RadialForm& form,
                        const std::vector<double>& values) {
  root.number("coefficient", values.size());
  root.put("radial_spline", values);
  root.attribute("radial_spline", "centre",
                 std::vector<double>{form.centre[0], form.centre[1], form.centre[2]});
  root.attribute("radial_spline", "radius", form.radius);
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
}

template <IndexField F>
void write_profile(const ResultGroup& root, const F& field, const Sphere& ball) {
  constexpr int radii = 101, directions = 50;
  std::vector<double> r, mean, spread;
  for (int i = 0; i < radii; ++i) {
    r.push_back(ball.radius * i / (radii - 1));
    std::vector<double> found;
    double sum = 0, most = 0;
    for (int d = 0; d < directions; ++d) {
      const double z = 1 - (2 * d + 1.0) / directions, rho = std::sqrt(1 - z * z), turn = 2.4 * d;
      const Vec3 along(rho * std::cos(turn), rho * std::sin(turn), z);
      found.push_back(index(field, (ball.centre + r.back() * along).eval()));
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
void write_slice(const ResultGroup& root, const F& field, const Sphere& ball) {
  constexpr int pixels = 101;
  std::vector<double> places, map;
  for (int i = 0; i < pixels; ++i) places.push_back(ball.radius * (2.0 * i / (pixels - 1) - 1));
  for (const double x : places)
    for (const double z : places) {
      const Vec3 at(x, 0, z);
      map.push_back(ball.distance(at) < 0 ? index(field, at) : 1);
    }
  root.put("slice_x", places);
  root.put("slice_z", places);
  root.put("slice_index", map);
}

/// Parallel rays along z through the ball and a little on.
template <class F>
std::vector<TracedRay> drawn_rays(const F& field, const Sphere& ball, std::size_t points) {
  SceneField scene{facts(field), field};
  constexpr int rays = 21;
  std::vector<RayStart> starts;
  for (int i = 0; i < rays; ++i)
    starts.push_back(
        {{0.98 * ball.radius * (2.0 * i / (rays - 1) - 1), 0, -1.3 * ball.radius}, Vec3::UnitZ()});
  const Plane stop{{0, 0, 1.5 * ball.radius}, Vec3::UnitZ()};
  return trace_rays(scene, {{stop}, 8 * ball.radius, 1e-10 * ball.radius},
                    {Sharma(), ball.radius / 20, 1e-8}, starts, points);
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

}  // namespace

void write_design(ResultFile& file, const DesignScene& scene, const FieldForm& form,
                  const DesignState& state, const DesignCheck& check) {
  const ResultGroup root(file, design_table);
  const Sphere& ball = scene.light.ball;
  constexpr std::size_t points = 61;
  write_history(root, state.history);
  write_check(root, check);
  root.attribute("focus", scene.light.focus);
  root.attribute("stalled", state.stalled);
  const auto write_field = [&](const auto& of) {
    const auto field = of.field(state.search.coefficients);
    write_coefficients(root, of, state.search.coefficients);
    write_profile(root, field, ball);
    write_slice(root, field, ball);
    const auto rays = drawn_rays(field, ball, points);
    root.number("path_ray", rays.size());
    root.number("path_point", points);
    const std::vector<double> start(of.shape().size(), scene.start_excess);
    write_rays(root, "before", drawn_rays(of.field(start), ball, points));
    write_rays(root, "after", rays);
  };
  std::visit(write_field, form);
}

}  // namespace flatspeckle::grin::design
