#pragma once

#include <span>
#include <vector>

#include "grin/render/lights/light_kind.h"
#include "grin/render/methods/moving_field.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

/// Derivatives of powers by parameters of the field, for paths that are tallied where they land.
/// Paths are reparametrised: as a parameter changes, the path moves with it, so that its
/// contribution changes by
///
///   d(weight) on the sensor + weight kernel(distance to an edge along the motion) d(landing),
///
/// where the first term is the change of the path density (score function). "Score" below is the
/// change of the logarithm of this density. Any motion of the paths is valid. The following one is
/// continuous except at pixel edges, and landing points move little:
///
/// - Light starts at the same position, with the direction and weight that the same random numbers
///   have at the changed index (EmissionChange).
/// - Flights end at the same fraction s/S of the arc length S to the boundary: a path that collides
///   just before the boundary does so for any value of the parameter. Score: d ln S (1 - mu_t s)
///   for a collision, -mu_t dS if light leaves the stage.
/// - When the direction before a collision turns, the direction after it is kept as far as the
///   phase function p is smooth enough. A share 1/(1 + (I w)^2) of the turn is compensated, where w
///   is the turn for a full change of the parameter, and I^2 the Fisher information of p with
///   respect to a turn. Score: the same share of d ln p. Nothing is compensated if the derivative
///   of p is not known.
///
/// Motions are central differences between rays in the two fields of each parameter (MovingField).
/// Paths are recorded as they are traced; finish() follows those that land on a sensor or near one,
/// in SIMD lanes.
class MovingPaths {
 public:
  /// over_edges: whether motion over edges is included; if not, BeamEdges adds it.
  MovingPaths(const MovingField& field, Film& film, TransportCounts& counts, bool over_edges = true)
      : field_(field), film_(film), counts_(counts), over_edges_(over_edges) {}

  /// Record a path's first flight, the flights after collisions, and its landing. begin() and
  /// go_on() return the number of the flight.
  int begin(const Vec3& x, const Vec3& direction, const EmissionChange& by_index = {});
  int go_on(int flight, const Vec3& x, const Vec3& arrived, double arc_length,
            const Vec3& direction);
  void land(int flight, const Vec3& x, const Vec3& arrived, double arc_length, double power);
  /// Adds the derivatives after all paths.
  void finish();

 private:
  using Lengths = MovingField::Lengths;
  struct Motion : MovingField::Motion {
    double score = 0;
  };
  /// Start of a flight. before: number of the flight that ended in the collision where this flight
  /// starts; -1 for the first flight of a path.
  struct Start {
    int before, depth;
    Vec3 x, arrived, direction;
    double arc_length = 0;  ///< arc length of the flight, if it ends in a collision
    bool is_followed = false;
    EmissionChange by_index =
        {};  ///< change of the emitted light by the index, on a path's first flight
  };
  struct Landing {
    int flight;
    Vec3 x, arrived;
    double arc_length, power;
  };
  /// Exit of a flight from the stage without collisions.
  struct Exit {
    double arc_length;
    Vec3 gradient;  ///< d(arc_length) = gradient . d(x)
  };

  Start& start(int flight) { return starts_[static_cast<std::size_t>(flight)]; }
  Motion* motions(int flight) {
    return motions_.data() + static_cast<std::size_t>(flight) * field_.parameters();
  }
  void emit();
  std::vector<std::vector<int>> followed();
  void follow(std::span<const int> flights);
  std::vector<Exit> exits(std::span<const int> flights) const;
  std::vector<std::vector<MovingField::Motion>> moved(std::size_t parameter,
                                                      std::span<const int> flights,
                                                      std::span<const Lengths> stops);
  void collide(const Start& next, double scale, Motion& motion) const;
  void add(const Landing& landing, std::size_t parameter, const Motion& motion);

  const MovingField& field_;
  Film& film_;
  TransportCounts& counts_;
  bool over_edges_;
  std::vector<Start> starts_;
  std::vector<Motion> motions_;  ///< [flight][parameter]
  std::vector<Landing> landings_;
};

}  // namespace flatspeckle::grin
