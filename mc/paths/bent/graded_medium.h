#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/numbers/complex.h"
#include "flatland/media/domain.h"
#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

/// Computes the field of a unit plane wave in a homogeneous box of wavenumber K in surroundings of
/// wavenumber k. Solves the Lippmann-Schwinger equation on nearly square cells, by FFT convolution
/// and BiCGSTAB iteration.
class HomogenisedBox {
 public:
  /// inside: the wavenumber K in the box, complex if it absorbs. Throws InputError for a box with
  /// more cells than memory and time allow.
  HomogenisedBox(const Domain& box, double k, Complex inside);

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  Vec cell() const { return {dx_, dz_}; }
  Vec centre(std::size_t column, std::size_t row) const;

  /// Returns the field [row][column] at the centres of the cells.
  std::vector<Complex> field(double angle) const;

 private:
  void find_spectrum();
  std::vector<Complex> applied(const std::vector<Complex>& field) const;

  Domain box_;
  double k_;
  Complex contrast_;  ///< K^2 - k^2
  std::size_t columns_, rows_, wide_, high_;
  double dx_, dz_;
  /// Fourier transform of the Green function times the area of a cell
  std::vector<Complex> spectrum_;
};

/// A place on a ray and its unit direction there.
struct RayPlace {
  Vec x, w;
};

/// The only ray that connects two points without touching a caustic (conventions, C32).
struct RayCurve {
  Vec leave, arrive;  ///< unit directions of the ray at both ends
  double path;        ///< optical path S = int n ds
  double spread;      ///< geometric spreading J (C32)
  double inside;      ///< growth of sigma (C30) along the part of the ray in the domain
};

/// The ray by which a wave arrives at a place.
struct Arrival {
  Vec w;             ///< unit direction of the ray at this place
  double path;       ///< optical path; the phase of the wave is k times this
  double amplitude;  ///< amplitude of a unit plane wave, or J^(-1/2) for a point source
  double inside;     ///< growth of sigma along the part of the ray in the domain
  /// Launch parameter of the ray. Plane wave: x where the ray crosses the entry face. Point source:
  /// angle of the ray at the source
  double launch;
};

/// A wave with exactly one ray to every place.
class Wavefront {
 public:
  virtual ~Wavefront() = default;
  virtual std::optional<Arrival> at(Vec x) const = 0;
};

/// Rays through the index field of a scene, in the parameter sigma in which attenuation is
/// exponential (conventions, C30 and C31). Light that travels far from the domain is assumed not to
/// return.
class GradedMedium {
 public:
  virtual ~GradedMedium() = default;

  virtual double square(Vec x) const = 0;  ///< n^2
  /// Returns the growth of sigma along all parts in the domain of the ray from x along w.
  virtual double inside(Vec x, Vec w) const = 0;
  /// Returns the place at which the ray from x along w has covered `sigma` in the domain; nullopt
  /// if the ray leaves the domain before.
  virtual std::optional<RayPlace> after_flight(Vec x, Vec w, double sigma) const = 0;

  // Each wave is made when it is first requested, and kept as long as the medium.
  std::shared_ptr<const Wavefront> from_point(Vec source) const;
  /// Returns the wave that is plane outside the face through which it enters, z = 0 or z = depth,
  /// where the index is 1. The index is assumed to change so gradually at the face that nothing is
  /// reflected.
  std::shared_ptr<const Wavefront> from_afar(double angle) const;

 private:
  virtual std::shared_ptr<const Wavefront> wave_from_point(Vec source) const = 0;
  virtual std::shared_ptr<const Wavefront> wave_from_afar(double angle) const = 0;

  mutable std::mutex making_;
  mutable std::map<Vec, std::shared_ptr<const Wavefront>> from_points_;
  mutable std::map<double, std::shared_ptr<const Wavefront>> from_afar_;
};

/// Makes the medium of a scene whose index varies. Throws InputError for unsupported fields.
std::shared_ptr<const GradedMedium> graded_medium(const Scene& scene);

/// Makes the medium of a grin index field in the plane y = 0 (parabolic, blobs, ultrasound or
/// grid). Rays are integrated in steps. The waves of endpoints are tabulated over the box, except
/// for a point in the box or close to it: then each call of Wavefront::at() searches for the ray to
/// the place.
std::shared_ptr<const GradedMedium> stepped_medium(const Scene& scene);

/// Throws InputError if a place of the domain is not reached by exactly one ray, without a caustic,
/// from a light or view. wave: the wave of this light or view. whose: its name in the message,
/// which also contains the place.
void require_one_ray(const Scene& scene, const Wavefront& wave, const std::string& whose);

}  // namespace flatspeckle::mc
