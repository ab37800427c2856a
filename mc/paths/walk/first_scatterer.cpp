#include "mc/paths/walk/first_scatterer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "grin/media/scattering/free_flight.h"
#include "mc/paths/bent/graded_endpoints.h"
#include "mc/paths/walk/importance.h"

namespace flatspeckle::mc {

namespace {

using std::numbers::pi;

/// Returns the range of launch parameters (Arrival::launch) of the rays that reach the edge of a
/// domain. around: the parameters of the rays to sampled places along the edge, per_side of them on
/// each side. If the largest or smallest parameter is not at a corner, places between the samples
/// may slightly exceed it; the range is then widened.
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

using std::numbers::pi;

/// Limits a chord to the distances t with low <= position + t speed <= high.
void narrow(Chord& chord, double position, double speed, double low, double high) {
  if (speed == 0) {
    if (position < low || position > high) chord.leave = chord.enter;
    return;
  }
  const double a = (low - position) / speed, b = (high - position) / speed;
  chord.enter = std::max(chord.enter, std::min(a, b));
  chord.leave = std::min(chord.leave, std::max(a, b));
}

/// Moves x into the box if rounding has put it outside.
Vec2 kept_inside(const Domain& box, Vec2 x) {
  return {std::clamp(x.x, -box.width / 2, box.width / 2), std::clamp(x.z, 0.0, box.depth)};
}

Vec2 after_flight(const Domain& box, const Extinction& extinction, Vec2 origin, Vec2 w,
                  const Chord& chord, RandomStream& random) {
  const double flight =
      extinction.sample_flight(origin + chord.enter * w, w, chord.length(), random.uniform());
  return kept_inside(box, origin + (chord.enter + flight) * w);
}

/// Returns half the extent of the box along a unit vector, about the centre of the box.
double half_extent(const Domain& box, Vec2 w) {
  return (box.width * std::abs(w.x) + box.depth * std::abs(w.z)) / 2;
}

double gaussian_share(double low, double high, double sigma) {
  const double scale = 1 / (std::numbers::sqrt2 * sigma);
  return (std::erf(high * scale) - std::erf(low * scale)) / 2;
}

double sample_gaussian(RandomStream& random) {
  const double radius = std::sqrt(-2 * std::log(random.uniform()));
  return radius * std::cos(2 * pi * random.uniform());
}

/// Whether two point sources or beams are so close that paths from one also sample the other well.
bool alike(const Light& a, const Light& b, double spacing, double wavelength) {
  if (a.kind != b.kind) return false;
  if (a.kind == Light::Kind::point) return length(a.point - b.point) <= wavelength / 2;
  const double turn = std::abs(std::remainder(a.angle - b.angle, 2 * std::numbers::pi));
  const double divergence = wavelength / (std::numbers::pi * b.waist);
  return turn <= std::min(spacing, divergence / 2) && a.waist == b.waist &&
         length(a.point - b.point) <= b.waist / 2;
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
  const auto place = inside > 0 ? medium_.after_flight(x, w, sigma) : std::nullopt;
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

Chord chord_through(const Domain& box, Vec2 origin, Vec2 w, double least) {
  Chord chord{least, std::numeric_limits<double>::max()};
  narrow(chord, origin.x, w.x, -box.width / 2, box.width / 2);
  narrow(chord, origin.z, w.z, 0, box.depth);
  return chord;
}

PointRays::PointRays(const Domain& box, const Extinction& extinction, Vec2 source)
    : box_(box), extinction_(extinction), source_(source), first_angle_(-pi), wedge_(2 * pi) {
  const double half = box.width / 2;
  const bool inside = std::abs(source.x) < half && source.z > 0 && source.z < box.depth;
  if (inside) return;
  const double middle = angle_of(Vec2{0, box.depth / 2} - source);
  double low = 0, high = 0;
  for (Vec2 corner : {Vec2{-half, 0}, {half, 0}, {-half, box.depth}, {half, box.depth}}) {
    const Vec2 offset = corner - source;
    if (length(offset) == 0) continue;
    const double angle = std::remainder(angle_of(offset) - middle, 2 * pi);
    low = std::min(low, angle);
    high = std::max(high, angle);
  }
  first_angle_ = middle + low;
  wedge_ = high - low;
}

Vec2 PointRays::sample(RandomStream& random) const {
  while (true) {  // because of rounding, a ray that grazes a corner may miss the box
    const Vec2 w = direction(first_angle_ + wedge_ * random.uniform());
    const Chord chord = chord_through(box_, source_, w, 0);
    if (chord.length() > 0) return after_flight(box_, extinction_, source_, w, chord, random);
  }
}

double PointRays::density(Vec2 x) const {
  const double r = length(x - source_);
  const Vec2 w = arrival(x);
  const Chord chord = chord_through(box_, source_, w, 0);
  if (!(chord.length() > 0)) return 0;
  return extinction_.flight_density(source_ + chord.enter * w, w, chord.length(), r - chord.enter) /
         (r * wedge_);
}

Vec2 PointRays::arrival(Vec2 x) const {
  const Vec2 offset = x - source_;
  return 1 / length(offset) * offset;
}

BeamRays::BeamRays(const Domain& box, const Extinction& extinction, const GaussianBeam& beam,
                   double width)
    : box_(box), extinction_(extinction), beam_(beam), sigma_(width / 2) {
  const double middle = beam.across({0, box.depth / 2}),
               half = half_extent(box, beam.across_axis());
  low_ = middle - half;
  high_ = middle + half;
  nearest_ = std::max(0.0, std::abs(middle) - half);
  share_ = gaussian_share(low_, high_, sigma_);
}

/// Samples a Gaussian restricted to [low_, high_] by rejection. The candidates are Gaussian, or
/// uniform if little of the Gaussian lies in this interval.
double BeamRays::sample_across(RandomStream& random) const {
  constexpr double little = 0.2;
  while (true) {
    if (share_ > little) {
      const double across = sigma_ * sample_gaussian(random);
      if (across > low_ && across < high_) return across;
      continue;
    }
    const double across = low_ + (high_ - low_) * random.uniform();
    const double exponent = (nearest_ * nearest_ - across * across) / (2 * sigma_ * sigma_);
    if (std::log(random.uniform()) < exponent) return across;
  }
}

Vec2 BeamRays::sample(RandomStream& random) const {
  constexpr double anywhere = std::numeric_limits<double>::lowest();
  while (true) {
    const double across = sample_across(random);
    const Vec2 origin = beam_.focus() + across * beam_.across_axis();
    const Chord chord = chord_through(box_, origin, beam_.axis(), anywhere);
    if (chord.length() > 0)
      return after_flight(box_, extinction_, origin, beam_.axis(), chord, random);
  }
}

double BeamRays::density(Vec2 x) const {
  constexpr double anywhere = std::numeric_limits<double>::lowest();
  const double across = beam_.across(x);
  const Vec2 origin = beam_.focus() + across * beam_.across_axis();
  const Chord chord = chord_through(box_, origin, beam_.axis(), anywhere);
  if (!(chord.length() > 0)) return 0;
  const double deviation = across / sigma_;
  const double gaussian = std::exp(-deviation * deviation / 2) / (std::sqrt(2 * pi) * sigma_);
  return gaussian / share_ *
         extinction_.flight_density(origin + chord.enter * beam_.axis(), beam_.axis(),
                                    chord.length(), beam_.along(x) - chord.enter);
}

std::vector<BeamRays> beam_rays(const Domain& box, const Extinction& extinction,
                                const GaussianBeam& beam) {
  const double middle = beam.along({0, box.depth / 2}), half = half_extent(box, beam.axis());
  const double narrowest = beam.width(std::max(0.0, std::abs(middle) - half)),
               widest = beam.width(std::abs(middle) + half);
  constexpr double alike = 1.3;
  std::vector<BeamRays> rays{{box, extinction, beam, widest}};
  if (widest > alike * narrowest) rays.emplace_back(box, extinction, beam, narrowest);
  std::erase_if(rays, [](const BeamRays& some) { return some.misses(); });
  if (rays.empty())
    throw InputError("beam focused at x", beam.focus().x,
                     "misses the medium; move the focus or turn the beam");
  return rays;
}

Lights representative_lights(const Scene& scene) {
  const double spacing = std::max(0.5 * (1 - std::abs(scene.medium.g)), 0.01);
  // The first light, which is the reference of tilted lights, stays first. The most oblique lights
  // follow, because their rays reach deep places along the sides that the rays of other lights do
  // not reach.
  std::vector<Light> lights(scene.request.lights.begin(), scene.request.lights.end());
  std::stable_sort(lights.begin() + 1, lights.end(), [](const Light& a, const Light& b) {
    return std::abs(std::sin(a.angle)) > std::abs(std::sin(b.angle));
  });
  Lights chosen;
  std::vector<Vec2> waves;  // directions of the chosen plane waves
  for (const Light& light : lights) {
    const bool plane = light.kind == Light::Kind::plane;
    const bool known = plane ? reached(scene, direction(light.angle), waves, spacing)
                             : std::any_of(chosen.begin(), chosen.end(), [&](const Light& other) {
                                 return alike(light, other, spacing, scene.wavelength);
                               });
    if (known) continue;
    chosen.push_back(light);
    if (plane) waves.push_back(direction(light.angle));
  }
  return chosen;
}

FirstScatterer::FirstScatterer(const Scene& scene, double mean_derivative)
    : domain_(scene.domain),
      profile_(scene.profile.get()),
      mu_t_(scene.medium.mu_t),
      bias_(mean_derivative / scene.medium.mu_t) {
  const Extinction extinction(scene);
  for (const Light& light : representative_lights(scene)) {
    switch (light.kind) {
      case Light::Kind::plane:
        plane_.push_back(direction(light.angle));
        break;
      case Light::Kind::point:
        point_.emplace_back(domain_, extinction, light.point);
        break;
      case Light::Kind::beam:
        for (const auto& rays : beam_rays(domain_, extinction, GaussianBeam(light, scene.k)))
          beam_.push_back(rays);
        break;
    }
  }
  count_ = static_cast<double>(plane_.size() + point_.size() + beam_.size());
}

}  // namespace flatspeckle::mc
