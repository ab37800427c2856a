#pragma once

#include "grin/render/flights/space.h"
#include "grin/render/transport/beam_connection.h"
#include "grin/render/transport/light_tally.h"
#include "grin/render/transport/split_tree.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// Whether a short path (Strategies) must continue from vertex `here` because possibly no
/// connection can find its next segment.
inline bool short_path_goes_on(const Space& space, const PathVertex& here) {
  if (!here.end) return space.connects_through();
  return here.end->is_beam || (here.end->is_point && space.connects_through());
}

/// EndPosition::choice of lights whose positions are only sampled by sample_position() and never
/// chosen for a given point: 1.
inline constexpr auto never_chosen = [](const EndPosition&, const PathPoint&) { return 1.0; };

/// Traces a path from one of its endpoints through collisions until it leaves the stage, is
/// absorbed, or is long enough for a short path. Calls collided(vertex) at each collision and
/// left(vertex, previous vertex) on the boundary. choice(end, point): EndPosition::choice of our
/// endpoint for a connection from `point`. tree: UnsplitPath or SplitTree. tally: LightTally for
/// light paths that are traced to their ends, or NoTally.
template <class Choice, class Tree, class Tally, class Collided, class Left>
void walk(const Transport& transport, const Space& space, const Choice& choice,
          const PathVertex& start, const EndDirection& first, bool is_short, RandomStream& random,
          TransportCounts& counts, Tree& tree, Tally& tally, const Collided& collided,
          const Left& left) {
  PathVertex here = start;
  here.weight *= first.strength / first.density;
  tally.emitted(here);
  tree.begin(here, first.direction);
  Vec3 direction = first.direction;
  const bool absorbs = tree.is_split() || transport.absorbs;
  // light tracing needs MIS densities only after the last flight
  const bool weighs_all = is_short || !transport.strategies.short_sensor;
  const auto phase = [&]() -> const auto& {
    return transport.medium(here.point).phase;
  };
  // Flies to the next collision; returns false if the path ends.
  const auto fly = [&] {
    const Flight flight =
        tally.fly(space, here, direction, random, tree.log_gradient(), tree.log());
    counts.add_flight(flight.end == Flight::End::lost);
    const double before = here.weight;
    if (flight.bias_weight != 1) {
      tally.reweighed(here.point.part, true, (1 - flight.bias_weight) * before);
      here.weight *= flight.bias_weight;
      tree.bias(flight.bias_weight);
    }
    tree.flew(before, here, flight);
    if (flight.end == Flight::End::lost) {
      tally.lost(here, flight);
      return false;
    }
    PathVertex next = moved(here, flight, space.index(flight.point));
    if (weighs_all || flight.end == Flight::End::boundary) {
      const double chosen = here.end ? choice(*here.end, flight.point) : 1;
      const double density =
          here.end ? first.density : phase().density(here.arrived.dot(direction));
      weigh(next, transport.strategies, here, flight, density, chosen);
      if (here.end && here.end->is_beam && transport.strategies.connects_beams &&
          flight.end == Flight::End::collision)
        weigh_in_beam(transport, space, here, flight, random, counts, next);
    }
    if (is_short && next.first_of_other > 0) return false;
    if (flight.end == Flight::End::boundary) {
      tally.left(here, flight);
      left(next, here);
      return false;
    }
    if (next.vertices - 2 >= transport.max_scatterings) {
      tally.cut(here, flight);
      return false;
    }
    const ScatteringMedium& medium = transport.medium(next.point);
    if (absorbs) next.weight *= medium.albedo();
    collided(next);
    if (absorbs && !tree.collide(here, flight, medium, next, random, counts, tally)) return false;
    here = next;
    return true;
  };
  for (;;) {
    const bool ends_here = !(here.weight > 0) || (is_short && !short_path_goes_on(space, here));
    if ((ends_here || !fly()) && !tree.next(here)) return;
    direction = phase().sample(here.arrived, random);
    tree.turned(here, direction);
  }
}

}  // namespace flatspeckle::grin
