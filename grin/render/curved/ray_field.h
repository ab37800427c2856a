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
#include "grin/rays/surfaces/room.h"
#include "grin/render/stage/part_medium.h"

namespace flatspeckle::grin {

/// What a leg of a flight is in: a medium, by equal steps.
struct LegRoom {
  Room room;
  const PartMedium& medium;
  double step;
};

enum class LegStop {
  collision,
  surface,
  lost,
  steps  ///< so many were made
};

/// How far a leg has come.
struct LegProgress {
  double collision;   ///< arc length of the next, tentative
  double weight = 1;  ///< of light that is absorbed and not scattered: what is left
};

/// Arc length from one tentative collision to the next.
inline double next_collision(const PartMedium& medium, double after, RandomStream& random) {
  if (!medium.scatters() && !medium.grid()) return std::numeric_limits<double>::infinity();
  return after + sample_free_flight(medium.majorant(), random.uniform());
}

/// Two points to be joined, and where their curves may run.
struct CurveEnds {
  Vec3 from, to;
  Sides region;
};

/// An index field as rays meet it: one virtual call for each step, behind which the type of the
/// field is known. Flights and connections are made of such steps unless a field has closed forms.
class RayField {
 public:
  virtual ~RayField() = default;

  // As of any IndexField.
  virtual double excess(const Vec3& x) const = 0;
  virtual IndexGradient gradient(const Vec3& x) const = 0;
  virtual IndexHessian hessian(const Vec3& x) const = 0;

  /// A step of the integrator that suits the field (ray_step.h).
  virtual void step(RayState& ray, double h) const = 0;
  virtual void step(RayState& ray, RayTangent& tangent, double h) const = 0;
  /// A step of Leapfrog.
  virtual void leap(RayState& ray, double h) const = 0;
  virtual void leap(RayState& ray, RayTangent& tangent, double h) const = 0;
  /// Whether Leapfrog is the one that suits.
  virtual bool leapfrogs() const = 0;

  /// trace(): one call for all steps of a ray.
  virtual TraceEnd follow(std::span<const Surface> surfaces, const TraceLimits& limits, RayLog& log,
                          RayState& ray) const = 0;

  /// Whether rays may go side by side, at less cost than one by one.
  virtual bool has_lanes() const = 0;
  /// Steps of all of them: of an integrator and looking for the index mismatch, as follow() makes
  /// them, or as advance() does.
  virtual void follow_lanes(const Integrators& integrator, int steps, RayLanes& rays) const = 0;
  virtual void advance_lanes(int steps, RayLanes& rays) const = 0;

  /// CurvedLeg::go(), with a tangent where there is one.
  virtual LegStop fly(const LegRoom& room, double longest, double& weight, RandomStream& random,
                      RayState& ray, RayTangent* tangent) const;
  /// CurvedLeg::go_on().
  LegStop go_on(const LegRoom& room, double longest, int most_steps, LegProgress& progress,
                RandomStream& random, RayState& ray) const;
  /// Equal steps, with a tangent where there is one.
  virtual void advance(double sigma, int steps, RayState& ray, RayTangent* tangent) const = 0;
  /// CurvedLeg::ratio_tracked().
  double ratio_tracked(const LegRoom& room, const RayState& ray, double sigma, int steps,
                       RandomStream& random) const;
  /// The same of an arc, by the room's steps.
  double ratio_tracked(const LegRoom& room, const RayState& ray, double arc_length,
                       RandomStream& random) const;

  /// In flights, no more than what connect() costs.
  virtual double cost_of_curve() const { return leapfrogs() ? 2 : 4; }
  /// What it costs by clocks where it is a closed form; 0 where it is iterations, which are
  /// counted.
  virtual double cost_of_closed_curve() const { return 0; }
  /// connect_chord_first().
  virtual ConnectionEstimate connect(const CurveEnds& ends, const ConnectionOptions& options,
                                     RandomStream& random, ConnectionStatistics& statistics) const;
  /// all_connections().
  virtual std::vector<FoundConnection> connections(const CurveEnds& ends,
                                                   const ConnectionOptions& options,
                                                   std::uint64_t trials, RandomStream& random,
                                                   ConnectionStatistics& statistics) const;

  /// The field as light meets it at this phase of the sound, from 0 to 2 pi (conventions, C28).
  /// Throws InputError for a field without sound.
  virtual std::unique_ptr<const RayField> frozen(double phase) const = 0;
};

/// Whose rays may go by Leapfrog, which is cheaper where it is exact enough: sound, weak and finely
/// structured.
template <class F>
inline constexpr bool goes_by_leapfrog = requires(const F& field) {
  at_phase(field, 0.0);
};

/// room: that the rays end at the surfaces of (Room), where they do. leapfrogs: by that, of a field
/// that has it.
std::unique_ptr<const RayField> make_ray_field(const AnyIndexField& field,
                                               std::span<const Surface> room = {},
                                               bool leapfrogs = false);

}  // namespace flatspeckle::grin
