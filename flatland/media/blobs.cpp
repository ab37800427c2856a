#include "flatland/media/blobs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace flatspeckle {

namespace {

/// int exp(-(t - middle)^2 / (2 radius^2)) dt
double gaussian_between(double from, double to, double middle, double radius) {
  const double scale = 1 / (std::numbers::sqrt2 * radius);
  return std::sqrt(std::numbers::pi / 2) * radius *
         (std::erf((to - middle) * scale) - std::erf((from - middle) * scale));
}

}  // namespace

Blobs::Blobs(Domain box, Material material, std::vector<Blob> blobs)
    : DensityMap(box, std::move(material)), blobs_(std::move(blobs)) {}

double Blobs::relative_density(Vec2 x) const {
  double density = 1;
  for (const auto& [centre, radius, amplitude] : blobs_) {
    const Vec2 from = x - centre;
    density += amplitude * std::exp(-dot(from, from) / (2 * radius * radius));
  }
  return std::max(0.0, density);  // what rounding leaves of a hole
}

double Blobs::met(Vec2 x, Vec2 w, double length) const {
  double sum = length;
  for (const auto& [centre, radius, amplitude] : blobs_) {
    const Vec2 way = centre - x;
    const double along = dot(way, w), across = way.x * w.z - way.z * w.x;
    sum += amplitude * std::exp(-across * across / (2 * radius * radius)) *
           gaussian_between(0, length, along, radius);
  }
  return std::max(0.0, sum);
}

double Blobs::most_relative() const {
  double most = 1;
  for (const Blob& blob : blobs_) most += std::max(0.0, blob.amplitude);
  return most;
}

double Blobs::mean_relative() const {
  double sum = 0;
  for (const auto& [centre, radius, amplitude] : blobs_)
    sum += amplitude * gaussian_between(-box().width / 2, box().width / 2, centre.x, radius) *
           gaussian_between(0, box().depth, centre.z, radius);
  return 1 + sum / box().area();
}

std::string Blobs::describe() const {
  return "density of " + std::to_string(blobs_.size()) + " blobs";
}

}  // namespace flatspeckle
