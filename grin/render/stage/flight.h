#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/numbers/random.h"
#include "grin/rays/connections/connection.h"
#include "grin/render/stage/regions.h"

namespace flatspeckle::grin {

/// Sequence of refractions and reflections of a path at surfaces of bodies. Surfaces without an
/// index jump do not count.
struct InterfaceCrossings {
  int count = 0;
  std::uint32_t reflected = 0;  ///< bit i is set if crossing i is a reflection

  /// Largest number of crossings on a path that a connection can find.
  static constexpr int most = 16;

  bool reflects(int i) const { return (reflected >> i) & 1; }
  InterfaceCrossings reversed() const {
    InterfaceCrossings back;
    for (int i = count; i-- > 0;) back.add(reflects(i));
    return back;
  }
  void add(bool reflects) {
    reflected |= static_cast<std::uint32_t>(reflects) << count;
    ++count;
  }
  bool operator==(const InterfaceCrossings&) const = default;
};

/// A free flight from a point to the next event, along a curve and through the surfaces of bodies.
struct Flight {
  enum class End {
    collision,  ///< in a medium
    boundary,   ///< left the stage; `point` is on the boundary
    lost  ///< the ray cannot be continued (index not positive, or too many steps); counted, without
          ///< contribution
  };
  End end = End::lost;
  PathPoint point;                      ///< position where the flight ended
  Vec3 start_direction = Vec3::Zero();  ///< unit tangent at the start
  Vec3 direction = Vec3::Zero();        ///< unit tangent at the end
  double arc_length = 0, optical_path = 0;
  double spreading = 0;  ///< |J| from start to end (C25); 0 if not computed or not is_connectable
  double optical_depth = 0;     ///< reference depth (see end of file)
  double weight = 1;            ///< exp(-mu_a s) in media that do not scatter, else 1
  double bias_weight = 1;       ///< density of unbiased flights divided by the sampling density
  double absorbed_in_body = 0;  ///< part of 1 - weight that is absorbed in bodies
  /// Whether the flight crosses the surface of a body or is reflected there.
  bool crosses_body = false;
  InterfaceCrossings crossings = {};  ///< recorded while is_connectable
  double fresnel = 1;                 ///< Fresnel probability of the crossings
  int concave_crossings = 0;          ///< number of crossings at surfaces with concave parts
  /// Whether a connection between the start and the end of the flight can find the same path.
  bool is_connectable = true;
};

/// A curve that connects two points.
struct TestConnection {
  Vec3 start_direction, end_direction;  ///< unit tangents along the path from the first point
  double spreading;                     ///< |J_PQ| of C25, from the first point to the second
  double optical_path = 1;
  double optical_depth = 0;  ///< reference depth (see end of file)
  /// Transmittance of the curve times the Fresnel probability of its crossings; in a density grid
  /// an unbiased estimate.
  double transmittance = 1;
  /// K of C26: f(curve) times multiplicity is an unbiased estimate of the sum of f over all
  /// curves
  double multiplicity = 1;
  InterfaceCrossings crossings = {};  ///< crossings of a specular connection
  double fresnel = 1;                 ///< Fresnel probability of the crossings
  int concave_crossings = 0;          ///< number of crossings at surfaces with concave parts
};

/// Parallel light, for example of a beam, given on a plane that contains x and is normal to the
/// direction (a unit vector).
struct ParallelLight {
  Vec3 x, direction;  ///< unit
};

/// A connection from a point to the plane of parallel light.
struct BeamConnection {
  Vec3 start_direction;           ///< unit tangent at the point, opposite to the arriving light
  Vec3 place;                     ///< end of the connection on the plane
  Vec3 first_met = Vec3::Zero();  ///< position of the first crossing, if any
  /// Cross section of a narrow bundle of the light at the point, divided by its cross section on
  /// the plane.
  double thinning;
  int orientation;  ///< sign of the determinant whose magnitude is thinning
  double arc_length, optical_path;
  InterfaceCrossings crossings = {};
  /// Transmittance, or an unbiased estimate of it; from Space::beam_connection() only the Fresnel
  /// probability of the crossings.
  double transmittance;
  double multiplicity = 1;   ///< K of C26, as in TestConnection
  double optical_depth = 0;  ///< reference depth (see end of file); 0 from Space::beam_connection()
};

/// Start of a search for a connection to parallel light. A search from outside of all bodies aims
/// at first_met, the position of the first crossing; other searches begin along start_direction.
struct BeamSeed {
  Vec3 start_direction;
  InterfaceCrossings crossings = {};
  Vec3 first_met = Vec3::Zero();
};

// The reference depth of a path is the integral of the reference extinction along it plus -ln of
// the Fresnel probability of its crossings. The reference extinction of a scattering part is mu_t,
// times the mean relative density of the part if that has a density grid. In a part without
// scattering it is 0, since no flight ends there. MIS weights use it instead of the true depth: the
// weights of a path still sum to 1, and no second estimate of the depth is needed.

}  // namespace flatspeckle::grin
