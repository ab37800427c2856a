#include "grin/rays/surfaces/lens.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flatspeckle::grin {

namespace {

/// Returns the axial distance from the vertex of a face to its edge.
double sag(double curvature, double radius) {
  const double ratio = curvature * radius;
  return ratio * radius / (1 + std::sqrt(std::max(0.0, (1 - ratio) * (1 + ratio))));
}

/// Returns a face of a lens. If radius_of_curvature is 0, the face is a plane.
LensFace face_of(const Vec3& vertex, double outwards, double radius_of_curvature, double radius) {
  const double curvature = radius_of_curvature == 0 ? 0 : 1 / radius_of_curvature;
  return {vertex, outwards, curvature, vertex[2] + sag(curvature, radius)};
}

bool is_wide_enough(double radius_of_curvature, double radius) {
  return radius_of_curvature == 0 || std::abs(radius_of_curvature) >= radius;
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
  if (barrel_distance(x) > std::max(front, back)) return nullptr;
  return &faces_[front < back];
}

Mat3 Lens::curvature(const Vec3& x) const {
  const LensFace* const face = face_at(x);
  const Vec3 n = normal(x), flat = face ? Vec3(Vec3::Zero()) : Vec3(Vec3::UnitZ());
  const double bend = face ? -face->outwards * face->curvature : 1 / radius_;
  return bend * (Mat3::Identity() - n * n.transpose() - flat * flat.transpose());
}

/// Adds the volume of the cylinder between the edges of the faces and the volumes of the two caps.
/// A cap of height h has the volume pi h (3 radius^2 + h^2) / 6.
double Lens::volume() const {
  double volume = radius_ * radius_ * (faces_[1].edge - faces_[0].edge);
  for (const LensFace& face : faces_) {
    const double h = face.outwards * (face.vertex[2] - face.edge);
    volume += h * (3 * radius_ * radius_ + h * h) / 6;
  }
  return std::numbers::pi * volume;
}

Box Lens::bounds() const {
  const Vec3& middle = faces_[0].vertex;
  const auto [front, back] = faces_;
  return {{middle[0] - radius_, middle[1] - radius_, std::min(front.vertex[2], front.edge)},
          {middle[0] + radius_, middle[1] + radius_, std::max(back.vertex[2], back.edge)}};
}

}  // namespace flatspeckle::grin
