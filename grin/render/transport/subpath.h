#pragma once

#include "grin/render/flights/space.h"
#include "grin/render/transport/beam_join.h"
#include "grin/render/transport/light_family.h"
#include "grin/render/transport/light_tally.h"
#include "grin/render/transport/transport.h"

namespace flatspeckle::grin {

/// Whether a short path (Strategies) goes on from here: the next way may be one that cannot be
/// joined.
inline bool short_path_goes_on(const Space& space, const PathVertex& here) {
  if (!here.end) return space.joins_through();
  return here.end->is_beam || (here.end->is_point && space.joins_through());
}

/// Lights have no other choice than that of sample_position.
inline constexpr auto never_chosen = [](const EndPosition&, const PathPoint&) { return 1.0; };

/// Walks a path away from one of its ends, through collisions, until it leaves the stage, is long
/// enough where it is to be short, or is absorbed. Calls collided(vertex) at each collision and
/// left(vertex, the one before) on the boundary. choice(end, point): of our end, if it were chosen
/// for a join from there (EndPosition). family: the path, or all that it is split into. tally: what
/// becomes of its power (LightTally), of a path that is not short.
template <class Choice, class Family, class Tally, class Collided, class Left>
void walk(const Transport& transport, const Space& space, const Choice& choice,
          const PathVertex& start, const EndDirection& first, bool is_short, RandomStream& random,
          TransportCounts& counts, Family& family, Tally& tally, const Collided& collided,
          const Left& left) {
  PathVertex here = start;
  here.weight *= first.strength / first.density;
  tally.emitted(here);
  family.begin(here, first.direction);
  Vec3 direction = first.direction;
  const bool absorbs = family.is_split() || transport.absorbs;
  // of light tracing that of the last flight alone
  const bool weighs_all = is_short || !transport.strategies.short_sensor;
  const auto phase = [&]() -> const auto& {
    return transport.medium(here.point.part).phase;
  };
  // To the next collision; false where the path ends.
  const auto fly = [&] {
    const Flight flight = tally.fly(space, here, direction, random, family.rise());
    counts.add_flight(flight.end == Flight::End::lost);
    const double before = here.weight;
    if (flight.stretched != 1) {
      tally.reweighed(here.point.part, true, (1 - flight.stretched) * before);
      here.weight *= flight.stretched;
      family.stretched(flight.stretched);
    }
    family.flew(before, here, flight);
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
      if (here.end && here.end->is_beam && transport.strategies.joins_beams &&
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
    const ScatteringMedium& medium = transport.medium(next.point.part);
    if (absorbs) next.weight *= medium.albedo();
    collided(next);
    if (absorbs && !family.collide(here, flight, medium, next, random, counts, tally)) return false;
    here = next;
    return true;
  };
  for (;;) {
    const bool ends_here = !(here.weight > 0) || (is_short && !short_path_goes_on(space, here));
    if ((ends_here || !fly()) && !family.next(here)) return;
    direction = phase().sample(here.arrived, random);
    family.turned(here, direction);
  }
}

}  // namespace flatspeckle::grin
