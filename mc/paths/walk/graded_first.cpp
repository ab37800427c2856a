#include "mc/paths/walk/graded_first.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grin/media/scattering/free_flight.h"
#include "mc/paths/bent/graded_ends.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// The launches that lead to a domain's edge. Beyond an extreme that is no corner the next place
/// of the edge may have one that is a little more so.
std::pair<double, double> launches(const std::vector<double>& around, std::size_t per_side) {
  const auto widened = [&](std::vector<double>::const_iterator at, double sign) {
    const auto i = static_cast<std::size_t>(at - around.begin());
    if (i % per_side == 0) return *at;
    const std::size_t size = around.size();
    return *at + sign * std::max(std::abs(around[(i + 1) % size] - *at),
                                 std::abs(around[(i + size - 1) % size] - *at));
  };
  const auto [low, high] = std::minmax_element(around.begin(), around.end());
  return {widened(low, -1), widened(high, 1)};
}

}  // namespace

GradedFirst::GradedFirst(const Scene& scene, const GradedScattering& scattering)
    : domain_(scene.domain), mu_t_(scene.medium.mu_t), medium_(scattering.medium()) {
  if (!scene.index->is_around())
    straight_.emplace(scene);
  else
    for (const Light& light : representative_lights(scene)) lights_.push_back(rays_of(light));
}

GradedFirst::Rays GradedFirst::rays_of(const Light& light) const {
  const bool point = light.kind == Light::Kind::point;
  Rays rays{point ? medium_.from_point(light.point) : medium_.from_afar(light.angle), light, -pi,
            pi, point ? 1 : std::abs(std::cos(light.angle))};
  if (domain_.kind == Domain::Kind::slab) {
    rays.low = rays.high = 0;
    return rays;
  }
  if (point && domain_.contains(light.point)) return rays;
  constexpr std::size_t per_side = 128;
  std::vector<double> around;
  const double middle = point ? rays.wave->at({0, domain_.depth / 2})->launch : 0;
  for (const Vec2 place : edge_places(domain_, per_side)) {
    const double launch = rays.wave->at(place)->launch;
    around.push_back(point ? std::remainder(launch - middle, 2 * pi) : launch);
  }
  const auto [low, high] = launches(around, per_side);
  rays.low = middle + low;
  rays.high = middle + high;
  return rays;
}

RayPlace GradedFirst::launched(const Rays& rays, double launch) const {
  if (rays.light.kind == Light::Kind::point) return {rays.light.point, direction(launch)};
  const double sine = std::sin(rays.light.angle), cosine = std::cos(rays.light.angle);
  const Vec2 entry{launch, cosine > 0 ? 0 : domain_.depth};
  const double n2 = medium_.square(entry), up = std::sqrt(std::max(n2 - sine * sine, 0.0));
  return {entry, 1 / std::sqrt(n2) * Vec2{sine, std::copysign(up, cosine)}};
}

GradedFirst::Sample GradedFirst::sample(RandomStream& random) const {
  if (straight_) {
    const auto [x, arrival] = straight_->sample(random);
    return {x, arrival};
  }
  const auto number =
      static_cast<std::size_t>(random.uniform() * static_cast<double>(lights_.size()));
  const Rays& rays = lights_[number];
  const bool one_ray = rays.low == rays.high;
  const auto [x, w] =
      launched(rays, one_ray ? rays.low : rays.low + (rays.high - rays.low) * random.uniform());
  const double inside = medium_.inside(x, w);
  const double sigma = grin::BoundedFlight{mu_t_, inside}.sample(random.uniform());
  const auto place = inside > 0 ? medium_.flown(x, w, sigma) : std::nullopt;
  if (!place) return {{}, {}, false};
  return {place->x, place->w};
}

double GradedFirst::density(const Rays& rays, const Arrival& arrival, Vec2 x) const {
  const double whole = arrival.inside + medium_.inside(x, arrival.w),
               wide = rays.low == rays.high ? 1 : rays.high - rays.low;
  return grin::BoundedFlight{mu_t_, whole}.density(arrival.inside) * arrival.amplitude *
         arrival.amplitude / (rays.per_launch * wide);
}

double GradedFirst::density(Vec2 x) const {
  if (straight_) return straight_->density(x);
  double sum = 0;
  for (const Rays& rays : lights_)
    if (const auto arrival = rays.wave->at(x)) sum += density(rays, *arrival, x);
  return sum / static_cast<double>(lights_.size());
}

double GradedFirst::density(Vec2 x, Vec2 start, const GradedScattering& scattering) const {
  if (straight_) return straight_->density(x, start, scattering);
  double sum = 0;
  for (const Rays& rays : lights_)
    if (const auto arrival = rays.wave->at(x))
      sum += density(rays, *arrival, x) * scattering.form().density(arrival->w, start);
  return sum / static_cast<double>(lights_.size());
}

}  // namespace flatspeckle::mc
