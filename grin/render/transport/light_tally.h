#pragma once

#include <algorithm>

#include "grin/render/flights/space.h"
#include "grin/render/transport/film.h"
#include "grin/render/transport/path_vertex.h"

namespace flatspeckle::grin {

/// Tally that ignores the power of a path. `from`: the vertex at which a flight began; its weight
/// is the power before the flight.
struct NoTally {
  Flight fly(const Space& space, const PathVertex& from, const Vec3& direction,
             RandomStream& random, const Vec3* log_gradient, FlightLog* log) const {
    return space.fly(from.point, direction, random, log, log_gradient);
  }
  void emitted(const PathVertex&) const {}
  void left(const PathVertex&, const Flight&) const {}
  void lost(const PathVertex&, const Flight&) const {}
  void cut(const PathVertex&, const Flight&) const {}
  void absorbed(const PathVertex&, const Flight&, double) const {}
  void ended(const PathVertex&, const Flight&, double) const {}
  void reweighed(Part, bool, double) const {}
};

/// Tallies the power of a light path that is traced to its end, by Termination.
class LightTally : public NoTally {
 public:
  explicit LightTally(EnergyBalance& all) : all_(all) {}

  void emitted(const PathVertex& start) { path_.add(Termination::emitted, start.weight); }

  void left(const PathVertex& from, const Flight& flight) {
    spend(from.weight, flight);
    path_.add(termination_of(from, flight), from.weight * flight.weight);
  }
  void lost(const PathVertex& from, const Flight& flight) {
    spend(from.weight, flight);
    path_.add(Termination::lost, from.weight * flight.weight);
  }
  void cut(const PathVertex& from, const Flight& flight) {
    spend(from.weight, flight);
    path_.add(Termination::cut, from.weight * flight.weight);
  }
  /// Tallies partial absorption, in the flight and in the collision at its end.
  void absorbed(const PathVertex& from, const Flight& flight, double albedo) {
    absorb(from.weight, flight, albedo);
  }
  /// Tallies a path that ends by absorption. Its remaining power is divided between the flight and
  /// the collision in proportion to their partial absorptions.
  void ended(const PathVertex& from, const Flight& flight, double albedo) {
    const double share = 1 - flight.weight + flight.weight * (1 - albedo);
    absorb(from.weight / share, flight, albedo);
  }

  /// Tallies a change of weight by roulette or biased sampling. It is 0 on average, and is assigned
  /// to the most likely termination so that the powers still sum to the emitted power.
  void reweighed(Part part, bool absorbs, double power) {
    path_.add(absorbs ? absorbed_in(part) : Termination::scattered, power);
  }

  void end_path() {
    all_ += path_;
    path_ = {};
  }

 private:
  static Termination absorbed_in(Part part) {
    return part == around ? Termination::absorbed_stage : Termination::absorbed_body;
  }
  static Termination termination_of(const PathVertex& from, const Flight& flight) {
    if (!from.end) return Termination::scattered;
    const bool stayed_out = flight.crossings.count == 1 && from.point.part == flight.point.part;
    return stayed_out ? Termination::specular : Termination::unscattered;
  }
  void absorb(double power, const Flight& flight, double albedo) {
    spend(power, flight);
    path_.add(absorbed_in(flight.point.part), power * flight.weight * (1 - albedo));
  }
  void spend(double power, const Flight& flight) {
    path_.add(Termination::absorbed_body, power * flight.absorbed_in_body);
    const double elsewhere = 1 - flight.weight - flight.absorbed_in_body;
    path_.add(Termination::absorbed_stage, power * std::max(0.0, elsewhere));
  }

  EnergyBalance& all_;
  EnergyBalance path_;
};

}  // namespace flatspeckle::grin
