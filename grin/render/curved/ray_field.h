#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "core/numbers/random.h"
#include "grin/media/fields/any_index_field.h"
#include "grin/rays/connections/connection.h"
#include "grin/rays/connections/sides.h"
#include "grin/rays/marching/any_steps.h"
#include "grin/rays/marching/ray_lanes.h"
#include "grin/rays/marching/watch.h"
#include "grin/rays/surfaces/surface_region.h"
#include "grin/render/stage/part_medium.h"

namespace flatspeckle::grin {

/// Region, medium and step length of one segment of a flight.
struct SegmentDomain {
  SurfaceRegion region;
  const PartMedium& medium;
  double step;
};

enum class SegmentStop {
  collision,
  surface,
  lost,
  steps  ///< the maximum number of steps was reached
};

/// State of a segment that is traced in several calls.
struct SegmentProgress {
  double collision;  ///< arc length of the next tentative collision
  /// Weight of the flight, reduced by absorption if the medium does not scatter.
  double weight = 1;
};

/// Samples the arc length of the first tentative collision beyond arc length `after`; infinite in a
/// uniform medium that does not scatter.
inline double next_collision(const PartMedium& medium, double after, RandomStream& random) {
  if (!medium.scatters() && !medium.varies()) return std::numeric_limits<double>::infinity();
  return after + sample_free_flight(medium.majorant(), random.uniform());
}

/// Two points to be connected, and the region in which the curves between them must lie.
struct CurveEndpoints {
  Vec3 from, to;
  Sides region;
};

/// Rays in an index field, with one virtual call per step that hides the type of the field. Flights
/// and connections consist of such steps unless a field has closed forms.
class RayField {
 public:
  virtual ~RayField() = default;

  // Interface of IndexField.
  virtual double excess(const Vec3& x) const = 0;
  virtual IndexGradient gradient(const Vec3& x) const = 0;
  virtual IndexHessian hessian(const Vec3& x) const = 0;

  /// Advances a ray by a step h in sigma, with the integrator that suits the field (ray_step.h).
  virtual void step(RayState& ray, double h) const = 0;
  virtual void step(RayState& ray, RayTangent& tangent, double h) const = 0;
  /// Advances a ray by a step h in sigma with Leapfrog.
  virtual void leap(RayState& ray, double h) const = 0;
  virtual void leap(RayState& ray, RayTangent& tangent, double h) const = 0;
  /// Whether Leapfrog is the integrator that suits the field.
  virtual bool leapfrogs() const = 0;

  /// Traces a ray by trace(), with one virtual call for all steps.
  virtual TraceEnd follow(std::span<const Surface> surfaces, const TraceLimits& limits, RayLog& log,
                          RayState& ray) const = 0;

  /// Whether rays can be traced in SIMD lanes at lower cost.
  virtual bool has_lanes() const = 0;
  /// Make steps of the rays in all lanes. follow_lanes() uses the given integrator and, like
  /// follow(), records how much |v| deviates from the index; advance_lanes() makes the same steps
  /// as advance().
  virtual void follow_lanes(const Integrators& integrator, int steps, RayLanes& rays) const = 0;
  virtual void advance_lanes(int steps, RayLanes& rays) const = 0;

  /// Traces a segment of a flight (CurvedSegment::go() in ray_field.cpp); the tangent may be null.
  virtual SegmentStop fly(const SegmentDomain& domain, double longest, double& weight,
                          RandomStream& random, RayState& ray, RayTangent* tangent) const;
  /// Continues a segment by CurvedSegment::go_on().
  SegmentStop go_on(const SegmentDomain& domain, double longest, int most_steps,
                    SegmentProgress& progress, RandomStream& random, RayState& ray) const;
  /// Advances a ray by equal steps that sum to sigma; the tangent may be null.
  virtual void advance(double sigma, int steps, RayState& ray, RayTangent* tangent) const = 0;
  /// Estimates a transmittance by CurvedSegment::ratio_tracked().
  double ratio_tracked(const SegmentDomain& domain, const RayState& ray, double sigma, int steps,
                       RandomStream& random) const;
  /// Estimates the transmittance along the arc of this length that starts at `ray`, with the step
  /// of the domain.
  double ratio_tracked(const SegmentDomain& domain, const RayState& ray, double arc_length,
                       RandomStream& random) const;

  /// Lower estimate of the cost of connect(), in flights.
  virtual double cost_of_curve() const { return leapfrogs() ? 2 : 4; }
  /// Measured cost of connect(), in flights, if it uses a closed form; 0 if it iterates, since the
  /// cost of iterations is counted separately.
  virtual double cost_of_closed_curve() const { return 0; }
  /// Connects two points by a curve; uses connect_chord_first() unless the field has a closed form.
  virtual ConnectionEstimate connect(const CurveEndpoints& ends, const ConnectionOptions& options,
                                     RandomStream& random, ConnectionStatistics& statistics) const;
  /// Lists the curves between two points that a number of trials find (all_connections()).
  virtual std::vector<FoundConnection> connections(const CurveEndpoints& ends,
                                                   const ConnectionOptions& options,
                                                   std::uint64_t trials, RandomStream& random,
                                                   ConnectionStatistics& statistics) const;

  /// Returns the field at a fixed phase of the sound, from 0 to 2 pi (conventions, C28). Throws
  /// InputError for a field without sound.
  virtual std::unique_ptr<const RayField> frozen(double phase) const = 0;
};

/// Whether rays may be traced by Leapfrog. It is accurate enough, and then cheaper, for sound,
/// whose index variations are weak and finely structured.
template <class F>
inline constexpr bool goes_by_leapfrog = requires(const F& field) {
  at_phase(field, 0.0);
};

/// Makes the rays of a field. surfaces: surfaces that bound the region of the rays (SurfaceRegion),
/// if any. leapfrogs: whether to use Leapfrog if the field allows it.
std::unique_ptr<const RayField> make_ray_field(const AnyIndexField& field,
                                               std::span<const Surface> surfaces = {},
                                               bool leapfrogs = false);

}  // namespace flatspeckle::grin
