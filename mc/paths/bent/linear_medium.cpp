#include "mc/paths/bent/linear_medium.h"

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/keys/number_text.h"
#include "mc/paths/bent/bent_chords.h"

namespace flatspeckle::mc {

namespace {

/// Returns the sigma at which a ray with initial velocity v touches the caustic of all rays from
/// the same start.
double until_caustic(Vec v, Vec force) {
  const double against = -dot(force, v);
  return against > 0 ? dot(v, v) / against : std::numeric_limits<double>::max();
}

class LinearPoint : public Wavefront {
 public:
  LinearPoint(const LinearMedium& medium, Vec source) : medium_(medium), source_(source) {}

  std::optional<Arrival> at(Vec x) const override {
    const auto curve = medium_.curve(source_, x);
    if (!curve) return std::nullopt;
    return Arrival{curve->arrive, curve->path, 1 / std::sqrt(curve->spread), curve->inside,
                   angle_of(curve->leave)};
  }

 private:
  const LinearMedium& medium_;
  Vec source_;
};

/// A plane wave in a medium whose n^2 depends only on z, so that v_x = sin(angle) everywhere.
class StratifiedWave : public Wavefront {
 public:
  StratifiedWave(const LinearMedium& medium, double angle)
      : medium_(medium),
        sine_(std::sin(angle)),
        cosine_(std::cos(angle)),
        face_(cosine_ > 0 ? 0 : medium.domain().depth) {
    const double other = medium.domain().depth - face_;
    for (const double z : {face_, other})
      if (!(vertical_square(z) > 1e-6)) refuse_turning(angle);
  }

  std::optional<Arrival> at(Vec x) const override {
    const double before = std::sqrt(vertical_square(face_)), here = std::sqrt(vertical_square(x.z)),
                 distance = std::abs(x.z - face_), sigma = 2 * distance / (before + here);
    const double through =  // int v_z dz
        2.0 / 3 * distance * (before * before + before * here + here * here) / (before + here);
    const Vec v{sine_, std::copysign(here, cosine_)};
    const double n = length(v);
    return Arrival{1 / n * v, sine_ * x.x + cosine_ * face_ + through,
                   std::sqrt(std::abs(cosine_) / here), medium_.inside_until(x, -v, sigma),
                   x.x - sine_ * sigma};
  }

 private:
  double vertical_square(double z) const { return medium_.square({0, z}) - sine_ * sine_; }
  [[noreturn]] void refuse_turning(double angle) const {
    const double z = (sine_ * sine_ - medium_.square({0, 0})) / medium_.derivative_along_z();
    throw InputError("light or view of angle", angle,
                     "turns round at z = " + number_text(z) +
                         ", where n = |sin(angle)|: a caustic in the medium");
  }

  const LinearMedium& medium_;
  double sine_, cosine_, face_;
};

}  // namespace

Vec LinearMedium::velocity(Vec x, Vec w) const {
  return std::sqrt(std::max(square(x), 0.0)) * w;
}

double LinearMedium::inside_until(Vec x, Vec v, double sigma) const {
  return BentChords(domain_, x, v, force_, sigma).length();
}

/// In a slab the ray ends where it leaves the slab. It does not return, because the index outside
/// is constant and equal to the index at the face.
double LinearMedium::end_of(Vec x, Vec v) const {
  const double caustic = until_caustic(v, force_);
  if (domain_.kind == Domain::Kind::box) return caustic;
  const BentChords chords(domain_, x, v, force_, caustic);
  return chords.begin() == chords.end() ? 0 : chords.begin()->leave;
}

double LinearMedium::inside(Vec x, Vec w) const {
  const Vec v = velocity(x, w);
  return inside_until(x, v, end_of(x, v));
}

std::optional<RayPlace> LinearMedium::after_flight(Vec x, Vec w, double sigma) const {
  const Vec v = velocity(x, w);
  const double end = end_of(x, v), s = BentChords(domain_, x, v, force_, end).at(sigma);
  if (!(s < end)) return std::nullopt;
  const Vec later = v + s * force_;
  return RayPlace{x + s * v + s * s / 2 * force_, 1 / length(later) * later};
}

std::optional<RayCurve> LinearMedium::curve(Vec from, Vec to) const {
  const Vec offset = to - from;
  const double r2 = dot(offset, offset), a2 = dot(field_.gradient, field_.gradient);
  const double mean = (square(from) + square(to)) / 2, root = mean * mean - a2 * r2 / 4;
  if (!(root > 0)) return std::nullopt;
  const double sigma = std::sqrt(2 * r2 / (mean + std::sqrt(root)));
  const Vec half = sigma / 2 * force_, straight = 1 / sigma * offset, v = straight - half,
            later = straight + half;
  return RayCurve{1 / length(v) * v, 1 / length(later) * later,
                  sigma * (mean - dot(force_, force_) * sigma * sigma / 6), sigma * dot(v, later),
                  inside_until(from, v, sigma)};
}

std::shared_ptr<const Wavefront> LinearMedium::wave_from_point(Vec source) const {
  return std::make_shared<LinearPoint>(*this, source);
}

std::shared_ptr<const Wavefront> LinearMedium::wave_from_afar(double angle) const {
  if (field_.gradient.x != 0)
    throw InputError("index_slope", field_.gradient.x,
                     "plane waves and far views require a slope along z alone");
  return std::make_shared<StratifiedWave>(*this, angle);
}

}  // namespace flatspeckle::mc
