#include "grin/rays/surfaces/turned_shape.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "grin/media/geometry/frame.h"
#include "grin/rays/surfaces/straight_crossing.h"

namespace flatspeckle::grin {

namespace {

Box bounds_of(const TurnedShape::Shape& shape) {
  return std::visit([](const auto& s) -> Box { return s.bounds(); }, shape);
}

}  // namespace

TurnedShape::TurnedShape(const Shape& shape, const Vec3& rotation) : shape_(shape) {
  const auto [low, high] = bounds_of(shape);
  const Vec3 middle = (low + high) / 2;
  turn_ = Eigen::AngleAxisd(rotation.norm(), rotation.stableNormalized()).toRotationMatrix();
  origin_ = middle - turn_ * middle;
}

TurnedShape TurnedShape::cylinder(const Vec3& from, const Vec3& to, double radius) {
  const Vec3 along = to - from;
  Mat3 turn;
  turn << frame_across(along), along.normalized();
  return {*Lens::make(Vec3::Zero(), radius, 0, 0, along.norm()), from, turn};
}

double TurnedShape::distance(const Vec3& x) const {
  return std::visit([&](const auto& s) { return s.distance(own(x)); }, shape_);
}
Vec3 TurnedShape::normal(const Vec3& x) const {
  return turn_ * std::visit([&](const auto& s) -> Vec3 { return s.normal(own(x)); }, shape_);
}
Mat3 TurnedShape::curvature(const Vec3& x) const {
  const Mat3 curvature =
      std::visit([&](const auto& s) -> Mat3 { return s.curvature(own(x)); }, shape_);
  return turn_ * curvature * turn_.transpose();
}

Box TurnedShape::bounds() const {
  const auto [low, high] = bounds_of(shape_);
  const bool is_box = std::holds_alternative<Box>(shape_);
  const Vec3 middle = origin_ + turn_ * ((low + high) / 2), half = (high - low) / 2;
  const Mat3 size = turn_.cwiseAbs();
  Vec3 reach = size * half;
  if (!is_box)
    for (int a = 0; a < 3; ++a) {
      const double across = std::hypot(turn_(a, 0), turn_(a, 1));
      reach[a] = across * half[0] + size(a, 2) * half[2];
    }
  return {middle - reach, middle + reach};
}

double TurnedShape::volume() const {
  if (const auto* box = std::get_if<Box>(&shape_)) return (box->high - box->low).prod();
  if (const auto* lens = std::get_if<Lens>(&shape_)) return lens->volume();
  return std::get<AsphericLens>(shape_).volume();
}
bool TurnedShape::is_convex() const {
  return std::visit([](const auto& s) { return grin::is_convex(s); }, shape_);
}

double TurnedShape::exit_distance(const Vec3& x, const Vec3& d) const {
  return std::visit(
      [&](const auto& s) { return grin::exit_distance(s, own(x), turn_.transpose() * d); }, shape_);
}
double TurnedShape::entry_distance(const Vec3& x, const Vec3& d) const {
  return std::visit(
      [&](const auto& s) { return grin::entry_distance(s, own(x), turn_.transpose() * d); },
      shape_);
}

}  // namespace flatspeckle::grin
