#pragma once

#include <span>
#include <vector>

#include "grin/render/lights/light_kind.h"
#include "grin/render/methods/moving_field.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

/// Derivatives of powers by parameters of the field, of paths that are counted where they land. A
/// path is taken along as a parameter changes, each of its random numbers becoming another or none,
/// so that what it brings changes by
///
///   d(weight) on the sensor + weight kernel(way to an edge along the motion) d(landing),
///
/// the first as the density of its random numbers changes (score function). How paths are taken
/// along is free, and chosen such that nothing jumps but at edges, and landings move little:
///
/// - Light begins at the same place, in the direction and with the weight that the same random
///   numbers have in the other index (EmissionChange).
/// - Flights end at the same part of the way to the boundary, at arc length s of S: a path that
///   collides just before the boundary does so with any parameter. Score: d ln S (1 - mu_t s) of a
///   collision, -mu_t dS where light leaves.
/// - Directions after a collision stay as they are, though those before it turn, as far as there is
///   room for that in the phase function: of a turn w before it, 1/(1 + (I w)^2) is taken back,
///   where I^2 is the information of the phase function on a turn by a whole of the parameter.
///   Score: that share of d ln p. Of phase functions whose slope is not known, nothing is taken
///   back.
///
/// Motions are central differences of rays in the two fields of each parameter. Paths are recorded
/// on their way; finish() follows those that land on a sensor or near one, side by side.
class MovingPaths {
 public:
  /// over_edges: else what moves over them is left to others.
  MovingPaths(const MovingField& field, Film& film, TransportCounts& counts, bool over_edges = true)
      : field_(field), film_(film), counts_(counts), over_edges_(over_edges) {}

  /// A path's first flight, those after collisions, and its landing. A flight has the number that
  /// is returned.
  int begin(const Vec3& x, const Vec3& direction, const EmissionChange& by_index = {});
  int go_on(int flight, const Vec3& x, const Vec3& arrived, double arc_length,
            const Vec3& direction);
  void land(int flight, const Vec3& x, const Vec3& arrived, double arc_length, double power);
  /// After all paths.
  void finish();

 private:
  using Lengths = MovingField::Lengths;
  struct Motion : MovingField::Motion {
    double score = 0;
  };
  /// A flight, after that at whose end its collision was.
  struct Start {
    int before, depth;
    Vec3 x, arrived, direction;
    double arc_length = 0;  ///< of the flight, where it ends in a collision
    bool is_followed = false;
    EmissionChange by_index = {};  ///< of a first flight
  };
  struct Landing {
    int flight;
    Vec3 x, arrived;
    double arc_length, power;
  };
  /// Where a flight leaves the stage if nothing stops it.
  struct Exit {
    double arc_length;
    Vec3 way;  ///< d(arc_length) = way . d(x)
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
