#include "mc/paths/walk/first_scatterer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/error.h"
#include "core/numbers/normal.h"
#include "grin/media/scattering/free_flight.h"
#include "grin/media/scattering/start_directions.h"
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
Vec kept_inside(const Domain& box, Vec x) {
  return {std::clamp(x.x, -box.width / 2, box.width / 2), std::clamp(x.z, 0.0, box.depth),
          std::clamp(x.y, -box.height / 2, box.height / 2)};
}

Vec after_flight(const Domain& box, const Extinction& extinction, Vec origin, Vec w,
                 const Chord& chord, RandomStream& random) {
  const double flight =
      extinction.sample_flight(origin + chord.enter * w, w, chord.length(), random.uniform());
  return kept_inside(box, origin + (chord.enter + flight) * w);
}

/// Returns half the extent of the box along a unit vector, about the centre of the box.
double half_extent(const Domain& box, Vec w) {
  return (box.width * std::abs(w.x) + box.depth * std::abs(w.z) + box.height * std::abs(w.y)) / 2;
}

double gaussian_share(double low, double high, double sigma) {
  const double scale = 1 / (std::numbers::sqrt2 * sigma);
  return (std::erf(high * scale) - std::erf(low * scale)) / 2;
}

/// Whether two point sources or beams are so close that paths from one also sample the other well.
bool alike(const Light& a, const Light& b, double spacing, double wavelength) {
  if (a.kind != b.kind) return false;
  if (a.kind == Light::Kind::point) return length(a.point - b.point) <= wavelength / 2;
  const double turn = 2 * std::asin(std::min(1.0, length(a.direction() - b.direction()) / 2));
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
  for (const Vec place : edge_places(domain_, per_side)) {
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
  const Vec entry{launch, cosine > 0 ? 0 : domain_.depth};
  const double n2 = medium_.square(entry), up = std::sqrt(std::max(n2 - sine * sine, 0.0));
  return {entry, 1 / std::sqrt(n2) * Vec{sine, std::copysign(up, cosine)}};
}

GradedFirst::Sample GradedFirst::sample(RandomStream& random) const {
  if (straight_) return straight_->sample(random);
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

double GradedFirst::density(const Rays& rays, const Arrival& arrival, Vec x) const {
  const double whole = arrival.inside + medium_.inside(x, arrival.w),
               wide = rays.low == rays.high ? 1 : rays.high - rays.low;
  return grin::BoundedFlight{mu_t_, whole}.density(arrival.inside) * arrival.amplitude *
         arrival.amplitude / (rays.per_launch * wide);
}

double GradedFirst::density(Vec x) const {
  if (straight_) return straight_->density(x);
  double sum = 0;
  for (const Rays& rays : lights_)
    if (const auto arrival = rays.wave->at(x)) sum += density(rays, *arrival, x);
  return sum / static_cast<double>(lights_.size());
}

double GradedFirst::density(Vec x, Vec start, const GradedScattering& scattering) const {
  if (straight_) return straight_->density(x, start, scattering);
  double sum = 0;
  for (const Rays& rays : lights_)
    if (const auto arrival = rays.wave->at(x))
      sum += density(rays, *arrival, x) * scattering.form().density(arrival->w, start);
  return sum / static_cast<double>(lights_.size());
}

Chord chord_through(const Domain& box, Vec origin, Vec w, double least) {
  Chord chord{least, std::numeric_limits<double>::max()};
  narrow(chord, origin.x, w.x, -box.width / 2, box.width / 2);
  narrow(chord, origin.z, w.z, 0, box.depth);
  if (box.height > 0) narrow(chord, origin.y, w.y, -box.height / 2, box.height / 2);
  return chord;
}

PointRays::PointRays(const Domain& box, const Extinction& extinction, Vec source)
    : box_(box), extinction_(extinction), source_(source) {
  const bool in_space = box.height > 0;
  const double whole = in_space ? 4 * pi : 2 * pi;
  first_angle_ = -pi;
  measure_ = whole;
  const Vec centre{0, box.depth / 2}, offset = centre - source;
  axis_ = length(offset) > 0 ? 1 / length(offset) * offset : Vec{0, 1};
  const bool inside = std::abs(source.x) < box.width / 2 && source.z > 0 && source.z < box.depth &&
                      (!in_space || std::abs(source.y) < box.height / 2);
  if (inside) return;
  double low = 0, high = 0, least_cosine = 1;
  const double middle = angle_of(offset);
  for (const double x : {-box.width / 2, box.width / 2})
    for (const double z : {0.0, box.depth})
      for (const double y : {-box.height / 2, box.height / 2}) {
        const Vec to = Vec{x, z, y} - source;
        if (length(to) == 0) continue;
        least_cosine = std::min(least_cosine, dot(to, axis_) / length(to));
        const double angle = std::remainder(angle_of(to) - middle, 2 * pi);
        low = std::min(low, angle);
        high = std::max(high, angle);
      }
  first_angle_ = middle + low;
  measure_ = in_space ? 2 * pi * (1 - least_cosine) : high - low;
}

Vec PointRays::sample_direction(RandomStream& random) const {
  if (box_.height == 0) return direction(first_angle_ + measure_ * random.uniform());
  const grin::Vec3 w = grin::random_turn({axis_.x, axis_.y, axis_.z},
                                         measure_ / (2 * pi) * random.uniform(), random);
  return {w[0], w[2], w[1]};
}

std::optional<Vec> PointRays::sample(RandomStream& random) const {
  while (true) {  // because of rounding, a ray that grazes a corner may miss the box
    const Vec w = sample_direction(random);
    const Chord chord = chord_through(box_, source_, w, 0);
    if (chord.length() > 0) return after_flight(box_, extinction_, source_, w, chord, random);
    if (box_.height > 0) return std::nullopt;
  }
}

double PointRays::density(Vec x) const {
  const double r = length(x - source_);
  const Vec w = arrival(x);
  const Chord chord = chord_through(box_, source_, w, 0);
  if (!(chord.length() > 0)) return 0;
  return extinction_.flight_density(source_ + chord.enter * w, w, chord.length(), r - chord.enter) /
         ((box_.height > 0 ? r * r : r) * measure_);
}

Vec PointRays::arrival(Vec x) const {
  const Vec offset = x - source_;
  return 1 / length(offset) * offset;
}

BeamRays::BeamRays(const Domain& box, const Extinction& extinction, const GaussianBeam& beam,
                   double width)
    : box_(box), extinction_(extinction), beam_(beam), sigma_(width / 2) {
  for (std::size_t i = 0; i < beam.transverse(); ++i) {
    const double middle = beam.across({0, box.depth / 2}, i),
                 half = half_extent(box, beam.across_axis(i));
    across_.push_back({middle - half, middle + half, std::max(0.0, std::abs(middle) - half),
                       gaussian_share(middle - half, middle + half, sigma_)});
  }
}

bool BeamRays::misses() const {
  return std::ranges::any_of(across_, [&](const Across& one) { return one.nearest > 4 * sigma_; });
}

/// Samples a Gaussian restricted to [low, high] by rejection. The candidates are Gaussian, or
/// uniform if little of the Gaussian lies in this interval.
double BeamRays::sample(const Across& of, RandomStream& random) const {
  constexpr double little = 0.2;
  while (true) {
    if (of.share > little) {
      const double across = sigma_ * standard_normal(random);
      if (across > of.low && across < of.high) return across;
      continue;
    }
    const double across = of.low + (of.high - of.low) * random.uniform();
    const double exponent = (of.nearest * of.nearest - across * across) / (2 * sigma_ * sigma_);
    if (std::log(random.uniform()) < exponent) return across;
  }
}

/// Returns the part inside the box of the line through `origin` parallel to the axis.
Chord BeamRays::chord(Vec origin) const {
  constexpr double anywhere = std::numeric_limits<double>::lowest();
  return chord_through(box_, origin, beam_.axis(), anywhere);
}

std::optional<Vec> BeamRays::sample(RandomStream& random) const {
  while (true) {
    Vec origin = beam_.focus();
    for (std::size_t i = 0; i < across_.size(); ++i)
      origin = origin + sample(across_[i], random) * beam_.across_axis(i);
    const Chord inside = chord(origin);
    if (inside.length() > 0)
      return after_flight(box_, extinction_, origin, beam_.axis(), inside, random);
    if (box_.height > 0) return std::nullopt;
  }
}

double BeamRays::density(Vec x) const {
  Vec origin = beam_.focus();
  double gaussian = 1;
  for (std::size_t i = 0; i < across_.size(); ++i) {
    const double across = beam_.across(x, i), deviation = across / sigma_;
    origin = origin + across * beam_.across_axis(i);
    gaussian *=
        std::exp(-deviation * deviation / 2) / (std::sqrt(2 * pi) * sigma_) / across_[i].share;
  }
  const Chord inside = chord(origin);
  if (!(inside.length() > 0)) return 0;
  return gaussian * extinction_.flight_density(origin + inside.enter * beam_.axis(), beam_.axis(),
                                               inside.length(), beam_.along(x) - inside.enter);
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
  std::vector<Vec> waves;  // directions of the chosen plane waves
  for (const Light& light : lights) {
    const bool plane = light.kind == Light::Kind::plane;
    const bool known = plane ? reached(scene, light.direction(), waves, spacing)
                             : std::any_of(chosen.begin(), chosen.end(), [&](const Light& other) {
                                 return alike(light, other, spacing, scene.wavelength);
                               });
    if (known) continue;
    chosen.push_back(light);
    if (plane) waves.push_back(light.direction());
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
        plane_.emplace_back(domain_, light.direction());
        break;
      case Light::Kind::point:
        point_.emplace_back(domain_, extinction, light.point);
        break;
      case Light::Kind::beam:
        for (const auto& rays :
             beam_rays(domain_, extinction, GaussianBeam(light, scene.k, scene.medium.dimension)))
          beam_.push_back(rays);
        break;
    }
  }
  count_ = static_cast<double>(plane_.size() + point_.size() + beam_.size());
}

}  // namespace flatspeckle::mc
