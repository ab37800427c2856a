#include "grin/design/design_light.h"

#include <cmath>
#include <numbers>

namespace flatspeckle::grin::design {

namespace {

constexpr double golden_angle = std::numbers::pi * (3 - 2.23606797749978969641);

double share(int i, int count) {
  return (i + 0.5) / count;
}

/// The i-th of so many directions all around, evenly.
Vec3 direction(int i, int count, double turn) {
  const double z = 1 - 2 * share(i, count), rho = std::sqrt(1 - z * z);
  const double azimuth = golden_angle * i + turn;
  return {rho * std::cos(azimuth), rho * std::sin(azimuth), z};
}

/// The i-th of so many points of a unit disk, evenly.
Eigen::Vector2d point_of_disk(int i, int count, double turn) {
  const double rho = std::sqrt(share(i, count)), azimuth = golden_angle * i + turn;
  return {rho * std::cos(azimuth), rho * std::sin(azimuth)};
}

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

}  // namespace

DesignTask FocusLight::task(const RayWalk& walk, bool turned) const {
  const double turn = turned ? 0.5 : 0;
  const int around = turned ? directions * 3 / 4 + 1 : directions;
  std::vector<DesignRay> starts;
  std::vector<ScreenReading> beyond;
  std::vector<SurfaceReading> on_end;
  for (int d = 0; d < around; ++d) {
    const FocusRays rays(*this, direction(d, around, turn));
    for (int i = 0; i < rays_each; ++i) {
      starts.push_back(rays.ray(point_of_disk(i, rays_each, d + 7 * turn)));
      if (focus > ball.radius)
        beyond.push_back(rays.beyond());
      else
        on_end.push_back(rays.on_end());
    }
  }
  std::vector<double> targets(2 * starts.size(), 0.0);
  Readings readings = focus > ball.radius ? Readings(beyond) : Readings(on_end);
  return {make_ray_system(std::move(starts), std::move(readings), walk),
          make_target_goal(std::move(targets))};
}

}  // namespace flatspeckle::grin::design
