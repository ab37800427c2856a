#include "grin/rays/surfaces/lens.h"

#include <cmath>

namespace flatspeckle::grin {

namespace {

/// How far a face of this radius of curvature is off its vertex at the edge.
double sag(double curvature, double radius) {
  if (curvature == 0) return 0;
  const double rest = std::sqrt(curvature * curvature - radius * radius);
  return radius * radius / std::copysign(std::abs(curvature) + rest, curvature);
}

LensFace face_of(const Vec3& vertex, double outwards, double curvature, double radius) {
  return {vertex, outwards, curvature, vertex[2] + sag(curvature, radius)};
}

bool is_wide_enough(double curvature, double radius) {
  return curvature == 0 || std::abs(curvature) >= radius;
}

}  // namespace

std::optional<Lens> Lens::make(const Vec3& vertex, double radius, double front, double back,
                               double thickness) {
  if (!is_wide_enough(front, radius) || !is_wide_enough(back, radius)) return std::nullopt;
  const Lens lens({face_of(vertex, -1, front, radius),
                   face_of(vertex + thickness * Vec3::UnitZ(), 1, back, radius)},
                  radius);
  const double at_edge = lens.faces_[1].edge - lens.faces_[0].edge;
  if (!(thickness > 0) || !(at_edge >= -1e-12 * thickness)) return std::nullopt;
  return lens;
}

const LensFace* Lens::face_at(const Vec3& x) const {
  const double front = faces_[0].distance(x), back = faces_[1].distance(x);
  if (across(x).norm() - radius_ > std::max(front, back)) return nullptr;
  return &faces_[front < back];
}

Mat3 Lens::curvature(const Vec3& x) const {
  const LensFace* const face = face_at(x);
  if (face && face->is_plane()) return Mat3::Zero();
  const Vec3 n = normal(x), flat = face ? Vec3(Vec3::Zero()) : Vec3(Vec3::UnitZ());
  const double radius = face ? -face->outwards * face->curvature : radius_;
  return (Mat3::Identity() - n * n.transpose() - flat * flat.transpose()) / radius;
}

Box Lens::bounds() const {
  const Vec3& middle = faces_[0].vertex;
  const auto [front, back] = faces_;
  return {{middle[0] - radius_, middle[1] - radius_, std::min(front.vertex[2], front.edge)},
          {middle[0] + radius_, middle[1] + radius_, std::max(back.vertex[2], back.edge)}};
}

}  // namespace flatspeckle::grin
