#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "flatland/scene/scene.h"

namespace flatspeckle::mc {

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
