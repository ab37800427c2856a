#pragma once

#include <algorithm>
#include <cmath>

#include "flatland/media/domain.h"

namespace flatspeckle {

/// Polarisation at a face (conventions, C45). tm, also for scalar waves in space: u and its normal
/// derivative are continuous. te: u and n^-2 times its normal derivative are continuous, with n the
/// refractive index. unpolarised: equal power of both, without amplitudes.
enum class Polarisation { tm, te, unpolarised };

/// A plane face, seen by a wave that travels from one refractive index to another.
struct Face {
  double from, to;
  Polarisation polarisation = Polarisation::tm;

  /// Returns the cosine of the angle of refraction, where `cosine` is that of the angle of
  /// incidence. It is 0 if the wave is totally reflected.
  double refracted(double cosine) const {
    const double ratio = from / to;
    return std::sqrt(std::max(0.0, 1 - ratio * ratio * (1 - cosine) * (1 + cosine)));
  }
  /// Returns the direction behind the face of a ray that travels along w.
  Vec refracted(Vec w) const {
    const double ratio = from / to;
    return {w.x * ratio, std::copysign(refracted(std::abs(w.z)), w.z), w.y * ratio};
  }
  /// Returns the amplitude of the reflected field (C45): 1 or -1 if the wave is totally
  /// reflected, whose phase is not computed.
  double reflected(double cosine) const { return reflected(cosine, polarisation); }
  /// Returns the fraction of the power that is reflected.
  double reflectance(double cosine) const {
    const auto power = [&](Polarisation of) { return std::pow(reflected(cosine, of), 2); };
    if (polarisation != Polarisation::unpolarised) return power(polarisation);
    return (power(Polarisation::tm) + power(Polarisation::te)) / 2;
  }

 private:
  /// The admittance is the quantity proportional to the normal derivative that is continuous,
  /// divided by the field.
  double reflected(double cosine, Polarisation of) const {
    const auto admittance = [of](double index, double cosine_there) {
      return of == Polarisation::te ? cosine_there / index : index * cosine_there;
    };
    const double before = admittance(from, cosine), behind = admittance(to, refracted(cosine));
    return (before - behind) / (before + behind);
  }
};

/// Faces z = 0 and z = depth between a medium and its surroundings, which have different refractive
/// indices.
struct Faces {
  double inside = 1, outside = 1;  ///< refractive indices
  Polarisation polarisation = Polarisation::tm;

  bool operator==(const Faces&) const = default;

  Face entering() const { return {outside, inside, polarisation}; }
  Face leaving() const { return {inside, outside, polarisation}; }
};

}  // namespace flatspeckle
