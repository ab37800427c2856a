#include "grin/design/objectives/focus_target.h"

#include "grin/design/objectives/even_points.h"

namespace flatspeckle::grin::design {

namespace {

struct FocusLight {
  Sphere ball;
  double focus;     ///< distance of the focus from the centre of the ball
  double aperture;  ///< beam radius divided by the radius of the ball
  int directions, rays_each;
};

/// Rays that come from one direction, and their measurements.
class FocusRays {
 public:
  FocusRays(const FocusLight& light, const Vec3& along)
      : light_(light),
        along_(along),
        frame_(frame_across(along)),
        focus_(light.ball.centre + light.focus * along) {}

  DesignRay ray(const Eigen::Vector2d& in_disk) const {
    const double radius = light_.ball.radius;
    const Vec3 across = light_.aperture * radius * (frame_ * in_disk);
    const double back = std::sqrt(radius * radius - across.squaredNorm());
    return {light_.ball.centre + across - back * along_, along_, end()};
  }
  ScreenMeasurement beyond() const { return {focus_, along_, frame_}; }
  SurfaceMeasurement on_end() const { return {focus_, frame_}; }

 private:
  Surface end() const {
    if (light_.focus < light_.ball.radius) return Plane{focus_, along_};
    return light_.ball;
  }

  const FocusLight& light_;
  Vec3 along_;
  Frame frame_;
  Vec3 focus_;
};

class FocusTarget : public DesignTarget {
 public:
  explicit FocusTarget(const FocusLight& light) : light_(light) {}

  double rays() const override { return static_cast<double>(light_.directions) * light_.rays_each; }

  DesignTask task(const RayWalk& walk, bool held_out) const override {
    const double turn = held_out ? 0.5 : 0;
    const int around = held_out ? light_.directions * 3 / 4 + 1 : light_.directions;
    std::vector<DesignRay> starts;
    std::vector<ScreenMeasurement> beyond;
    std::vector<SurfaceMeasurement> on_end;
    for (int d = 0; d < around; ++d) {
      const FocusRays rays(light_, even_direction(d, around, turn));
      for (int i = 0; i < light_.rays_each; ++i) {
        starts.push_back(rays.ray(even_point(i, light_.rays_each, d + 7 * turn)));
        is_beyond() ? beyond.push_back(rays.beyond()) : on_end.push_back(rays.on_end());
      }
    }
    std::vector<double> targets(2 * starts.size(), 0.0);
    Measurements measurements = is_beyond() ? Measurements(beyond) : Measurements(on_end);
    return {make_ray_system(std::move(starts), std::move(measurements), walk),
            make_target_objective(std::move(targets))};
  }

 private:
  bool is_beyond() const { return light_.focus > light_.ball.radius; }

  FocusLight light_;
};

}  // namespace

void add_keys(Keys& keys, FocusValues& values) {
  keys.add("focus", values.focus,
           "Distance from the ball's centre to the focus of parallel light, along the light's "
           "direction (default: radius)")
      .positive()
      .unit("length");
  keys.add("directions", values.directions,
           "Number of light directions, distributed evenly over the sphere")
      .from(1, 100'000);
  keys.add("rays_per_direction", values.rays_per_direction,
           "Number of rays per direction, distributed evenly over the beam's disk")
      .from(1, 1'000'000);
  keys.add("aperture", values.aperture, "Radius of the beam's disk divided by the ball's radius")
      .positive_to(1);
}

std::unique_ptr<DesignTarget> make_target(const Keys& keys, const FocusValues& values,
                                          const FieldForm& form) {
  const auto hull = hull_of(form);
  const Sphere* ball = hull ? std::get_if<Sphere>(&*hull) : nullptr;
  if (!ball) throw InputError("goal", "focus", "requires design = ball or radial");
  return std::make_unique<FocusTarget>(
      FocusLight{*ball, keys.read(values.focus).value_or(ball->radius), keys.read(values.aperture),
                 static_cast<int>(keys.read(values.directions)),
                 static_cast<int>(keys.read(values.rays_per_direction))});
}

}  // namespace flatspeckle::grin::design
