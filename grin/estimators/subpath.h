#pragma once

#include "grin/estimators/light_tally.h"
#include "grin/estimators/transport.h"
#include "grin/space/render_plan.h"

namespace flatspeckle::grin {

/// Of the throughput: absorption takes a share of a path's weight until that would fall below this,
/// and from then on all of it or nothing, by chance. Each path keeps its power to the last.
inline constexpr double capture_level = 0.25;

/// Whether a short path (Strategies) goes on from here: the next way may be one that cannot be
/// joined.
template <Space S>
bool short_path_goes_on(const S& space, const PathVertex& here) {
  if (!here.end) return !space.joins_all();
  return here.end->is_beam || (here.end->is_point && !space.joins_all());
}

/// Walks a path away from one of its ends, through collisions, until it leaves the stage, is long
/// enough where it is to be short, or is absorbed. Calls collided(vertex) at each collision and
/// left(vertex, the one before) on the boundary. ends: those that the path comes from. tally: what
/// becomes of its power (LightTally), of a path that is not short.
template <RenderPlan plan, Space S, class Ends, class Tally, class Collided, class Left>
void walk(const Transport& transport, const S& space, const Ends& ends, const PathVertex& start,
          const EndDirection& first, bool is_short, RandomStream& random, TransportCounts& counts,
          Tally& tally, const Collided& collided, const Left& left) {
  PathVertex here = start;
  here.weight *= first.strength / first.density;
  tally.emitted(here);
  Vec3 direction = first.direction;
  double density = first.density;
  double throughput = 1;
  while (here.weight > 0 && (!is_short || short_path_goes_on(space, here))) {
    const Flight flight = tally.fly(space, here, direction, random);
    counts.add_flight(flight.end == Flight::End::lost);
    if (flight.end == Flight::End::lost) return tally.lost(here, flight);
    const double choice = here.end ? ends.choice(*here.end, flight.point.x) : 1;
    PathVertex next =
        arrived(transport.strategies, here, flight, density, choice, space.index(flight.point));
    if (is_short && next.first_of_other > 0) return;
    if (!plan.scatters || flight.end == Flight::End::boundary) {
      tally.left(here, flight);
      return left(next, here);
    }
    if (next.vertices - 2 >= transport.max_scatterings) return tally.cut(here, flight);
    const ScatteringMedium& medium = transport.medium(next.point.part);
    if constexpr (plan.absorbs) next.weight *= medium.albedo();
    collided(next);
    if constexpr (plan.absorbs) {
      const double albedo = medium.albedo(), survives = flight.weight * albedo;
      if (throughput * survives >= capture_level) {
        tally.absorbed(here, flight, albedo);
        throughput *= survives;
      } else if (random.uniform() >= survives) {
        return tally.ended(here, flight, albedo);
      } else {
        next.weight = here.weight;
      }
    }
    direction = medium.phase.sample(next.arrived, random);
    density = medium.phase.density(next.arrived.dot(direction));
    here = next;
  }
}

}  // namespace flatspeckle::grin
