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

/// The field in a box of wavenumber K, in surroundings of wavenumber k, of a unit plane wave: the
/// Lippmann-Schwinger equation on square-like cells, convolved by FFT and iterated (BiCGSTAB).
class HomogenisedBox {
 public:
  /// Throws InputError for a box of more cells than memory and time allow.
  HomogenisedBox(const Domain& box, double k, Complex inside);

  std::size_t columns() const { return columns_; }
  std::size_t rows() const { return rows_; }
  Vec2 cell() const { return {dx_, dz_}; }
  Vec2 centre(std::size_t column, std::size_t row) const;

  /// [row][column], at the centres of the cells.
  std::vector<Complex> field(double angle) const;

 private:
  void find_spectrum();
  std::vector<Complex> applied(const std::vector<Complex>& field) const;

  Domain box_;
  double k_;
  Complex contrast_;  ///< K^2 - k^2
  std::size_t columns_, rows_, wide_, high_;
  double dx_, dz_;
  std::vector<Complex> spectrum_;  ///< of the Green function, times the cell
};

/// A place on a ray and its unit direction there.
struct RayPlace {
  Vec2 x, w;
};

/// The one curve that joins two points before any caustic (conventions, C32).
struct RayCurve {
  Vec2 leave, arrive;  ///< its unit directions at both ends
  double path;         ///< S, int n ds
  double spread;       ///< J
  double inside;       ///< sigma of the part in the domain
};

/// How a wave arrives at a place.
struct Arrival {
  Vec2 w;            ///< unit direction
  double path;       ///< its phase is k times this
  double amplitude;  ///< of a unit plane wave; of a point source J^(-1/2)
  double inside;     ///< sigma in the domain on the way
  double launch;     ///< the ray: x where it crosses the face, or its angle at the source
};

/// A wave and its one ray to every place.
class Wavefront {
 public:
  virtual ~Wavefront() = default;
  virtual std::optional<Arrival> at(Vec2 x) const = 0;
};

/// Rays through the index field of a scene, in the parameter sigma in which attenuation is
/// exponential (conventions, C30 and C31). Light that goes far from the domain does not come back.
class GradedMedium {
 public:
  virtual ~GradedMedium() = default;

  virtual double square(Vec2 x) const = 0;  ///< n^2
  /// sigma in the domain along a ray.
  virtual double inside(Vec2 x, Vec2 w) const = 0;
  /// Where a ray has spent so much sigma in the domain; none where it leaves before.
  virtual std::optional<RayPlace> flown(Vec2 x, Vec2 w, double sigma) const = 0;

  // Made once; they live as long as this.
  std::shared_ptr<const Wavefront> from_point(Vec2 source) const;
  /// A plane wave in index 1 outside of the face that it enters by, z = 0 or z = depth; what is
  /// between changes so gradually that nothing is reflected.
  std::shared_ptr<const Wavefront> from_afar(double angle) const;

 private:
  virtual std::shared_ptr<const Wavefront> wave_from_point(Vec2 source) const = 0;
  virtual std::shared_ptr<const Wavefront> wave_from_afar(double angle) const = 0;

  mutable std::mutex making_;
  mutable std::map<Vec2, std::shared_ptr<const Wavefront>> from_points_;
  mutable std::map<double, std::shared_ptr<const Wavefront>> from_afar_;
};

/// Of a scene whose index varies. Throws InputError.
std::shared_ptr<const GradedMedium> graded_medium(const Scene& scene);

/// Index fields of grin in the plane y = 0, parabolic, blobs, ultrasound and grid, by steps along
/// rays. Waves of ends are tables over the box; a point in it, or close by, finds the ray to each
/// place anew.
std::shared_ptr<const GradedMedium> stepped_medium(const Scene& scene);

/// Throws InputError that says where, unless the wave of a light, or that from a view, has one ray
/// to every place of the domain and no caustic there.
void require_one_ray(const Scene& scene, const Wavefront& wave, const std::string& whose);

}  // namespace flatspeckle::mc
