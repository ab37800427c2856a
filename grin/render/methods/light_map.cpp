#include "grin/render/methods/light_map.h"

#include <cmath>
#include <numbers>

namespace flatspeckle::grin {

namespace {

std::vector<double> middles(double first, double spacing, int count) {
  std::vector<double> all;
  for (int i = 0; i < count; ++i) all.push_back(first + (i + 0.5) * spacing);
  return all;
}

}  // namespace

BoxCells::BoxCells(const Box& box, const std::array<int, 3>& counts)
    : box_(box),
      counts_(counts),
      sides_((box.high - box.low).cwiseQuotient(Vec3(counts[0], counts[1], counts[2]))) {}

int BoxCells::cell_at(const Vec3& x) const {
  int cell = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double at = (x[axis] - box_.low[axis]) / sides_[axis];
    if (!(at >= 0 && at < counts_[axis])) return -1;
    cell = cell * counts_[axis] + static_cast<int>(at);
  }
  return cell;
}

std::vector<double> BoxCells::centres(int axis) const {
  return middles(box_.low[axis], sides_[axis], counts_[axis]);
}

RingCells::RingCells(const Vec3& from, const Vec3& to, double radius,
                     const std::array<int, 2>& counts)
    : from_(from),
      axis_((to - from).normalized()),
      counts_(counts),
      width_(radius / counts[0]),
      height_((to - from).norm() / counts[1]),
      rings_per_length_(1 / width_),
      slices_per_length_(1 / height_) {}

Box RingCells::bounds() const {
  const Vec3 to = from_ + height_ * counts_[1] * axis_;
  const Vec3 reach = Vec3::Constant(width_ * counts_[0]);
  return {from_.cwiseMin(to) - reach, from_.cwiseMax(to) + reach};
}

double RingCells::volume(int cell) const {
  const int ring = cell / counts_[1];
  return std::numbers::pi * (2 * ring + 1) * width_ * width_ * height_;
}

int RingCells::cell_at(const Vec3& x) const {
  const Vec3 away = x - from_;
  const double along = away.dot(axis_), depth = along * slices_per_length_;
  if (!(depth >= 0 && depth < counts_[1])) return -1;
  const double radius = (away - along * axis_).norm() * rings_per_length_;
  if (!(radius < counts_[0])) return -1;
  return static_cast<int>(radius) * counts_[1] + static_cast<int>(depth);
}

std::vector<double> RingCells::radii() const {
  return middles(0, width_, counts_[0]);
}
std::vector<double> RingCells::depths() const {
  return middles(0, height_, counts_[1]);
}

int cells(const LightMap& map) {
  return std::visit(
      [](const auto& of) {
        int product = 1;
        for (const int count : of.counts()) product *= count;
        return product;
      },
      map);
}

}  // namespace flatspeckle::grin
