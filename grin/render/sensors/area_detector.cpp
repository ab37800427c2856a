#include "grin/render/sensors/area_detector.h"

#include <cmath>
#include <numbers>

#include "core/keys/number_text.h"
#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

namespace {

using std::numbers::pi;

/// Fraction of positions that are chosen uniformly over the detector, since curved rays may arrive
/// anywhere.
constexpr double anywhere = 0.1;

BoundaryPoint centre_on(const Surface& boundary, const Vec3& centre) {
  const auto at = boundary_point(boundary, centre);
  if (!at)
    throw InputError("sensor_at", listed(centre),
                     "must be on the boundary of the stage, a sphere or a box");
  return *at;
}

}  // namespace

const DatasetTable area_table = sensor_table(
    {.name = "area",
     .axes = {{"row", Data::scale, "", "length", "height on the detector, along sensor_up"},
              {"column", Data::scale, "", "length",
               "position to the right, seen along the arriving light"}},
     .unit = "1/length^2",
     .pixel = "irradiance averaged over the pixel",
     .mean = "mean over the pixels",
     .total = "power on the detector"});

PixelRectangle picture_of(const AreaDetector& detector) {
  return {detector.pixels, detector.width / 2, detector.height / 2};
}

AreaDetectorEnd::AreaDetectorEnd(const AreaDetector& detector, const Stage& stage)
    : face_(picture_of(detector)),
      boundary_(stage.boundary),
      centre_(centre_on(stage.boundary, detector.centre).x),
      view_("sensor_at", -centre_on(stage.boundary, detector.centre).inward, detector.up),
      acceptance_(detector.acceptance),
      regions_(stage) {
  require_in_stage(stage, "sensor_at", centre_);
  const auto* sphere = std::get_if<Sphere>(&boundary_);
  for (const double right : {-1, 1})
    for (const double up : {-1, 1}) {
      const Vec3 corner =
          right * face_.half_width() * view_.right + up * face_.half_height() * view_.up;
      const bool fits = sphere ? corner.norm() < sphere->radius
                               : boundary_point(boundary_, centre_ + corner).has_value();
      if (!fits)
        throw InputError("sensor_size", number_text(std::vector{detector.width, detector.height}),
                         "must be within one face of the boundary");
    }
}

Vec3 AreaDetectorEnd::inward(const Vec3& x) const {
  if (const auto* sphere = std::get_if<Sphere>(&boundary_)) return -sphere->normal(x);
  return -view_.forward;
}

EndPosition AreaDetectorEnd::on_face(const Vec3& x, int pixel) const {
  const Vec3 normal = inward(x);
  return {.point = {x, regions_.at(x)},
          .inward = normal,
          .position_density = -normal.dot(view_.forward) / face_.area(),
          .pixel = pixel};
}

EndPosition AreaDetectorEnd::at(double u, double v, int pixel) const {
  Vec3 x = centre_ + u * view_.right + v * view_.up;
  if (const auto* sphere = std::get_if<Sphere>(&boundary_)) {
    // u^2 + v^2 = s (2 R - s), with R the radius and s the distance of the sphere from the tangent
    // plane
    const double squared = u * u + v * v, r = sphere->radius;
    x -= squared / (r + std::sqrt(r * r - squared)) * view_.forward;
  }
  return on_face(x, pixel);
}

EndPosition AreaDetectorEnd::sample_position(double stratum, RandomStream& random) const {
  const PicturePoint point = face_.sample(stratum, random);
  return at(point.u, point.v, point.pixel);
}

Window AreaDetectorEnd::accepting_from(const Vec3& x) const {
  constexpr double bounds_of_curves = 1.25;
  const Vec3 from_centre = x - centre_;
  const double before = std::max(0.0, -from_centre.dot(view_.forward));
  return face_.near(from_centre.dot(view_.right), from_centre.dot(view_.up),
                    bounds_of_curves * acceptance_.tangent() * before);
}

double AreaDetectorEnd::choice_of(double u, double v, const Window& accepting) const {
  const double within = accepting.contains(u, v) ? face_.area() / accepting.area() : 0;
  return anywhere + (1 - anywhere) * within;
}

EndPosition AreaDetectorEnd::choose_position(const Vec3& x, RandomStream& random) const {
  const Window accepting = accepting_from(x);
  const Window part = random.uniform() < anywhere ? face_.all() : accepting;
  const double u = part.u_low + (part.u_high - part.u_low) * random.uniform();
  const double v = part.v_low + (part.v_high - part.v_low) * random.uniform();
  EndPosition chosen = at(u, v, face_.pixel_at(u, v));
  chosen.choice = choice_of(u, v, accepting);
  return chosen;
}

double AreaDetectorEnd::choice(const Vec3& position, const Vec3& x) const {
  const Vec3 from_centre = position - centre_;
  return choice_of(from_centre.dot(view_.right), from_centre.dot(view_.up), accepting_from(x));
}

std::optional<EndPosition> AreaDetectorEnd::position_at(const Vec3& x) const {
  if (!(normal(boundary_, x).dot(view_.forward) > 0))
    return std::nullopt;  // the far side of the sphere, or another face
  const Vec3 from_centre = x - centre_;
  const int pixel = face_.pixel_at(from_centre.dot(view_.right), from_centre.dot(view_.up));
  if (pixel < 0) return std::nullopt;
  return on_face(x, pixel);
}

EndDirection AreaDetectorEnd::sample_direction(const EndPosition& at, double,
                                               RandomStream& random) const {
  return acceptance_.sample(at, sensitivity(at), random);
}

EndDirection AreaDetectorEnd::towards(const EndPosition& at, const Vec3& direction) const {
  return acceptance_.towards(at, direction, sensitivity(at));
}

void add_keys(Keys& keys, AreaValues& values) {
  add_vectors(keys, "sensor_at", values.sensor_at, "Centre of the area, on the boundary")
      .unit("length");
  keys.add("sensor_size", values.sensor_size, "Width and height")
      .each_of(2, "width height")
      .positive()
      .unit("length");
  keys.add("acceptance", values.acceptance, "Light is accepted within this angle from the normal")
      .positive_to(pi / 2)
      .unit("rad");
}

AreaDetector make_sensor(const OneSensor& of, const AreaValues& values, const Picture& picture) {
  const auto size = of.part(values.sensor_size, 2);
  return {of.vector(values.sensor_at), picture.up, size[0], size[1], picture.pixels,
          of.number(values.acceptance)};
}

/// The returned function finds the nearest point of the rectangle in the tangent plane; on a sphere
/// it returns the point of the sphere in front of that point.
NearestPlace nearest_place(const AreaDetector& detector, const Surface& boundary) {
  const Vec3 normal = grin::normal(boundary, detector.centre);
  const Vec3 right = normal.cross(detector.up).normalized(), up = right.cross(normal);
  const auto* sphere = std::get_if<Sphere>(&boundary);
  return [=, centre = detector.centre, half_width = detector.width / 2,
          half_height = detector.height / 2,
          radius = sphere ? sphere->radius : 0](const Vec3& x) -> Vec3 {
    const Vec3 away = x - centre;
    const double u = std::clamp(away.dot(right), -half_width, half_width);
    const double v = std::clamp(away.dot(up), -half_height, half_height);
    const Vec3 flat = centre + u * right + v * up;
    if (radius == 0) return flat;
    const double height = std::max(0.0, radius * radius - u * u - v * v);
    return flat - (radius - std::sqrt(height)) * normal;
  };
}

}  // namespace flatspeckle::grin
