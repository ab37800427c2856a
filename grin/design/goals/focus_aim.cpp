#include "grin/design/goals/focus_aim.h"

#include "grin/design/goals/even_points.h"

namespace flatspeckle::grin::design {

namespace {

struct FocusLight {
  Sphere ball;
  double focus;     ///< from the centre
  double aperture;  ///< of the ball's radius
  int directions, rays_each;
};

/// Rays of one direction, and how they are read.
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
  ScreenReading beyond() const { return {focus_, along_, frame_}; }
  SurfaceReading on_end() const { return {focus_, frame_}; }

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

class FocusAim : public Aim {
 public:
  explicit FocusAim(const FocusLight& light) : light_(light) {}

  double rays() const override { return static_cast<double>(light_.directions) * light_.rays_each; }

  DesignTask task(const RayWalk& walk, bool held_out) const override {
    const double turn = held_out ? 0.5 : 0;
    const int around = held_out ? light_.directions * 3 / 4 + 1 : light_.directions;
    std::vector<DesignRay> starts;
    std::vector<ScreenReading> beyond;
    std::vector<SurfaceReading> on_end;
    for (int d = 0; d < around; ++d) {
      const FocusRays rays(light_, even_direction(d, around, turn));
      for (int i = 0; i < light_.rays_each; ++i) {
        starts.push_back(rays.ray(even_point(i, light_.rays_each, d + 7 * turn)));
        is_beyond() ? beyond.push_back(rays.beyond()) : on_end.push_back(rays.on_end());
      }
    }
    std::vector<double> targets(2 * starts.size(), 0.0);
    Readings readings = is_beyond() ? Readings(beyond) : Readings(on_end);
    return {make_ray_system(std::move(starts), std::move(readings), walk),
            make_target_goal(std::move(targets))};
  }

 private:
  bool is_beyond() const { return light_.focus > light_.ball.radius; }

  FocusLight light_;
};

}  // namespace

void add_keys(Keys& keys, FocusValues& values) {
  keys.add("focus", values.focus,
           "Where parallel light is to meet, from the centre along its direction (default: radius)")
      .positive()
      .unit("length");
  keys.add("directions", values.directions, "Directions of light, evenly all around")
      .from(1, 100'000);
  keys.add("rays_per_direction", values.rays_per_direction, "Rays of each, evenly over the disk")
      .from(1, 1'000'000);
  keys.add("aperture", values.aperture, "Radius of that disk over the ball's").positive_to(1);
}

std::unique_ptr<Aim> make_aim(const Keys& keys, const FocusValues& values, const FieldForm& form) {
  const auto hull = hull_of(form);
  const Sphere* ball = hull ? std::get_if<Sphere>(&*hull) : nullptr;
  if (!ball) throw InputError("goal", "focus", "needs a ball: design = ball or radial");
  return std::make_unique<FocusAim>(
      FocusLight{*ball, keys.read(values.focus).value_or(ball->radius), keys.read(values.aperture),
                 static_cast<int>(keys.read(values.directions)),
                 static_cast<int>(keys.read(values.rays_per_direction))});
}

}  // namespace flatspeckle::grin::design
