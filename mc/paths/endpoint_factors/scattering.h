#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/random.h"
#include "flatland/media/domain.h"
#include "flatland/media/medium.h"
#include "grin/media/scattering/phase_function.h"

namespace flatspeckle::mc {

/// A list of unit vectors and, in the plane, their angles (C2), stored by component for vectorised
/// loops.
struct Directions {
  std::vector<double> x, z, y, angle;

  explicit Directions(std::size_t size = 0) : x(size), z(size), y(size), angle(size) {}
  std::size_t size() const { return x.size(); }
  Vec operator[](std::size_t i) const { return {x[i], z[i], y[i]}; }
  void set(std::size_t i, Vec w) { x[i] = w.x, z[i] = w.z, y[i] = w.y, angle[i] = angle_of(w); }
};

/// Returns 1 - cos of the angle between unit vectors, without cancellation.
inline double one_minus_cosine(Vec from, Vec to) {
  const Vec step = to - from;
  return dot(step, step) / 2;
}

/// Rotates w from +z towards +x by the angle of the unit vector `turn`.
inline Vec turned(Vec w, Vec turn) {
  return {w.x * turn.z + w.z * turn.x, w.z * turn.z - w.x * turn.x};
}

/// Returns the unit vector at twice the angle of the vector (a, b). Both angles are measured from
/// the second axis.
inline Vec doubled_angle(double a, double b) {
  const double per_square = 1 / (a * a + b * b);
  return {2 * a * b * per_square, (b * b - a * a) * per_square};
}

/// Samples a point of the unit disk uniformly, except its centre. The angle of the point is then a
/// uniform angle, found without trigonometric functions.
inline Vec sample_disk(RandomStream& random) {
  while (true) {
    const Vec point{2 * random.uniform() - 1, 2 * random.uniform() - 1};
    if (const double square = dot(point, point); square <= 1 && square > 0) return point;
  }
}

/// Three forms of scattering, of which Plan::phase selects one. amplitude() is A of C14 divided by
/// sqrt(sigma_s), so that |amplitude|^2 is the phase function; towards() multiplies out[j] by the
/// amplitude for scattering from `from` to to[j]; sample() draws a new direction from the phase
/// function. The forms for media in space are in space_scattering.h.

struct IsotropicScattering {
  static constexpr grin::Isotropic<2> phase{};

  double density(Vec, Vec) const { return phase.value; }
  double amplitude(Vec, Vec) const { return std::sqrt(phase.value); }
  void towards(Vec, const Directions&, std::span<Complex> out) const {
    const double a = std::sqrt(phase.value);
    for (Complex& value : out) value *= a;
  }
  Vec sample(Vec from, RandomStream& random) const {
    const Vec uniform = sample_disk(random);
    return turned(from, doubled_angle(uniform.x, uniform.z));
  }
};

/// Multiplies out[j] by the real amplitude of `scattering` for scattering from `from` to to[j].
template <typename Scattering>
void multiply_by_amplitudes(const Scattering& scattering, Vec from, const Directions& to,
                            std::span<Complex> out) {
  // Amplitudes are computed in a separate loop, which the compiler can vectorise
  constexpr std::size_t most = 128;
  std::array<double, most> amplitudes;
  for (std::size_t begin = 0; begin < out.size(); begin += most) {
    const std::size_t count = std::min(most, out.size() - begin);
    for (std::size_t j = 0; j < count; ++j)
      amplitudes[j] = scattering.amplitude(from, to[begin + j]);
    for (std::size_t j = 0; j < count; ++j) out[begin + j] *= amplitudes[j];
  }
}

struct HenyeyGreensteinScattering {
  grin::HenyeyGreenstein<2> phase;

  double density(Vec from, Vec to) const {
    return phase.density_beside(one_minus_cosine(from, to));
  }
  double amplitude(Vec from, Vec to) const { return std::sqrt(density(from, to)); }
  void towards(Vec from, const Directions& to, std::span<Complex> out) const {
    multiply_by_amplitudes(*this, from, to, out);
  }
  /// Samples theta by tan(theta/2) = (1-g)/(1+g) tan(a), with a uniform angle a (C22).
  Vec sample(Vec from, RandomStream& random) const {
    const Vec uniform = sample_disk(random);
    return turned(from, doubled_angle((1 - phase.g) * uniform.x, (1 + phase.g) * uniform.z));
  }
};

/// Scattering by a tabulated amplitude, linear between the nodes: the complex amplitude of a
/// circular scatterer with the structure factor of its medium (C16), or the square root of a bulk
/// phase function.
class TabulatedScattering {
 public:
  TabulatedScattering(const BulkMedium& medium, double k)
      : intervals_(4096 *
                   (medium.phase.density ? 16 : std::max<std::size_t>(medium.t_matrix.size(), 2))),
        amplitude_(normalised_amplitudes(medium, k, intervals_)),
        phase_([this](double angle) { return std::norm(at(angle)); }, intervals_) {}

  double density(Vec from, Vec to) const { return phase_.density(angle_between(from, to)); }
  Complex amplitude(Vec from, Vec to) const { return at(angle_between(from, to)); }
  void towards(Vec from, const Directions& to, std::span<Complex> out) const {
    const double angle = angle_of(from);
    for (std::size_t j = 0; j < out.size(); ++j) out[j] = product(out[j], at(to.angle[j] - angle));
  }
  Vec sample(Vec from, RandomStream& random) const {
    return turned(from, direction(phase_.sample(random.uniform())));
  }

 private:
  static double angle_between(Vec from, Vec to) {
    return std::atan2(from.z * to.x - from.x * to.z, dot(from, to));
  }

  /// Returns the interpolated amplitude at an angle of up to a few turns.
  Complex at(double angle) const {
    const double turns = std::abs(angle) / (2 * std::numbers::pi);
    const int nearest = (static_cast<int>(2 * turns) + 1) / 2;
    const double part = std::abs(turns - nearest);
    const double position = 2 * part * static_cast<double>(intervals_);
    const std::size_t i = std::min(static_cast<std::size_t>(position), intervals_ - 1);
    const double t = position - static_cast<double>(i);
    return (1 - t) * amplitude_[i] + t * amplitude_[i + 1];
  }

  std::size_t intervals_;
  /// Values at angles from 0 to pi; the amplitude is even in the angle
  std::vector<Complex> amplitude_;
  grin::TabulatedPhaseFunction phase_;
};

}  // namespace flatspeckle::mc
