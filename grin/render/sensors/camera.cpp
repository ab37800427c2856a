#include "grin/render/sensors/camera.h"

#include <cmath>
#include <numbers>

#include "grin/render/sensors/sensor_kind.h"

namespace flatspeckle::grin {

const DatasetTable camera_table = sensor_table(
    {.name = "camera",
     .axes = {{"row", Data::scale, "", "1", "tangent of the angle above the line of sight"},
              {"column", Data::scale, "", "1",
               "tangent of the angle to the right of the line of sight"}},
     .unit = "1/(length^2 sr)",
     .pixel = "L/n^2 averaged over the pixel",
     .mean = "mean over the pixels"});

PixelRectangle picture_of(const Camera& camera) {
  const double half_width = std::tan(camera.field_of_view / 2);
  return {camera.pixels, half_width, half_width * camera.pixels.rows / camera.pixels.columns};
}

CameraEnd::CameraEnd(const Camera& camera, const Stage& stage)
    : view_("sensor_direction", camera.forward, camera.up),
      film_(picture_of(camera)),
      centre_(camera.x),
      focus_distance_(1),
      regions_(stage) {
  if (camera.lens_radius != 0) place_lens(camera, stage);
  require_in_stage(stage, "sensor_at", centre_);
}

void CameraEnd::place_lens(const Camera& camera, const Stage& stage) {
  lens_.emplace(stage.boundary, centre_, camera.lens_radius, "sensor_at", "lens_radius");
  centre_ = boundary_point(stage.boundary, centre_)->x;
  if (!(camera.focus_distance > camera.lens_radius && std::isfinite(camera.focus_distance)))
    throw InputError("focus_distance", camera.focus_distance, "must be more than lens_radius");
  if (!(view_.forward.dot(lens_->inward(centre_)) > 0))
    throw InputError("sensor_direction", listed(camera.forward),
                     "must point from the lens into the stage");
  focus_distance_ = camera.focus_distance;
}

EndPosition CameraEnd::on_lens(const BoundaryPoint& at) const {
  return {.point = {at.x, regions_.at(at.x)},
          .inward = at.inward,
          .position_density = 1 / lens_->area()};
}

EndPosition CameraEnd::sample_position(double, RandomStream& random) const {
  if (lens_) return on_lens(lens_->sample(random));
  return {.point = {centre_, regions_.at(centre_)}, .is_point = true};
}

std::optional<EndPosition> CameraEnd::position_at(const Vec3& x) const {
  if (!lens_ || !lens_->contains(x)) return std::nullopt;
  return on_lens({x, lens_->inward(x)});
}

EndDirection CameraEnd::along(const EndPosition& at, const Vec3& direction, int pixel) const {
  EndDirection to{.direction = direction};
  const double cosine = direction.dot(view_.forward);
  const double ahead = focus_distance_ - (at.point.x - centre_).dot(view_.forward);
  const double relative_distance = ahead / focus_distance_;
  const double film_per_angle = relative_distance * relative_distance / (cosine * cosine * cosine);
  to.density = film_per_angle / film_.area();
  if (!at.is_point && !(direction.dot(at.inward) > 0)) return to;  // behind the lens
  to.pixel = pixel;
  to.strength = at.position_density * film_per_angle / film_.pixel_area();
  return to;
}

EndDirection CameraEnd::sample_direction(const EndPosition& at, double stratum,
                                         RandomStream& random) const {
  const PicturePoint seen = film_.sample(stratum, random);
  const Vec3 focus =
      centre_ + focus_distance_ * (view_.forward + seen.u * view_.right + seen.v * view_.up);
  return along(at, (focus - at.point.x).normalized(), seen.pixel);
}

EndDirection CameraEnd::towards(const EndPosition& at, const Vec3& direction) const {
  const Vec3 from_centre = at.point.x - centre_;
  const double cosine = direction.dot(view_.forward);
  if (!(cosine > 0)) return {.direction = direction};
  const double t = (focus_distance_ - from_centre.dot(view_.forward)) / cosine;
  const Vec3 focus = (from_centre + t * direction) / focus_distance_;
  const int pixel = film_.pixel_at(focus.dot(view_.right), focus.dot(view_.up));
  if (pixel < 0) return {.direction = direction};
  return along(at, direction, pixel);
}

void add_keys(Keys& keys, CameraValues& values) {
  add_vectors(keys, "sensor_at", values.sensor_at, "Position of the pinhole, or centre of the lens")
      .unit("length");
  add_vectors(keys, "sensor_direction", values.sensor_direction, "View direction of the camera");
  keys.add("field_of_view", values.field_of_view, "Full angle of view along a row of pixels")
      .between(0, std::numbers::pi)
      .unit("rad");
  keys.add("lens_radius", values.lens_radius,
           "Radius of a thin lens on the stage's boundary (default 0: pinhole)")
      .not_negative()
      .unit("length");
  keys.add("focus_distance", values.focus_distance, "Focus distance of the lens")
      .positive()
      .unit("length")
      .only_of("a camera with lens_radius");
}

Camera make_sensor(const OneSensor& of, const CameraValues& values, const Picture& picture) {
  Camera camera{of.vector(values.sensor_at), of.vector(values.sensor_direction), picture.up,
                of.number(values.field_of_view), picture.pixels};
  if (values.lens_radius.empty() || of.number(values.lens_radius) == 0) return camera;
  camera.lens_radius = positive("lens_radius", of.number(values.lens_radius));
  camera.focus_distance = of.number(values.focus_distance);
  return camera;
}

}  // namespace flatspeckle::grin
