#pragma once

#include "grin/estimators/transport.h"
#include "grin/space/render_plan.h"

namespace flatspeckle::grin {

/// Of the throughput, below which a path ends by roulette or goes on with twice as much.
inline constexpr double roulette_level = 0.25;

/// Whether a short path (Strategies) goes on from here: the next way may be one that cannot be
/// joined.
template <Space S>
bool short_path_goes_on(const S& space, const PathVertex& here) {
  if (!here.end) return !space.joins_all();
  return here.end->is_beam || (here.end->is_point && !space.joins_all());
}

/// Walks a path away from one of its ends, through collisions, until it leaves the stage, is long
/// enough where it is to be short, or loses at roulette: what absorption leaves of it decides.
/// Calls collided(vertex) at each collision and left(vertex, the one before) on the boundary. ends:
/// those that the path comes from.
template <RenderPlan plan, Space S, class Ends, class Collided, class Left>
void walk(const Transport& transport, const S& space, const Ends& ends, const PathVertex& start,
          const EndDirection& first, bool is_short, RandomStream& random, TransportCounts& counts,
          const Collided& collided, const Left& left) {
  PathVertex here = start;
  here.weight *= first.strength / first.density;
  Vec3 direction = first.direction;
  double density = first.density;
  double throughput = 1;
  while (here.weight > 0 && (!is_short || short_path_goes_on(space, here))) {
    const Flight flight = space.fly(here.point, direction, random);
    counts.add_flight(flight.end == Flight::End::lost);
    if (flight.end == Flight::End::lost) return;
    const double choice = here.end ? ends.choice(*here.end, flight.point.x) : 1;
    PathVertex next =
        arrived(transport.strategies, here, flight, density, choice, space.index(flight.point));
    if (is_short && next.first_of_other > 0) return;
    if (!plan.scatters || flight.end == Flight::End::boundary) return left(next, here);
    if (next.vertices - 2 >= transport.max_scatterings) return;
    const ScatteringMedium& medium = transport.medium(next.point.part);
    if constexpr (plan.absorbs) {
      next.weight *= medium.albedo();
      throughput *= flight.weight * medium.albedo();
    }
    collided(next);
    if constexpr (plan.absorbs) {
      if (throughput < roulette_level) {
        const double survives = throughput / (2 * roulette_level);
        if (random.uniform() >= survives) return;
        next.weight /= survives;
        throughput /= survives;
      }
    }
    direction = medium.phase.sample(next.arrived, random);
    density = medium.phase.density(next.arrived.dot(direction));
    here = next;
  }
}

}  // namespace flatspeckle::grin
