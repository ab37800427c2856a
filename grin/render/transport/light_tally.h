#pragma once

#include <algorithm>

#include "grin/render/flights/space.h"
#include "grin/render/transport/film.h"
#include "grin/render/transport/path_vertex.h"

namespace flatspeckle::grin {

/// Of a path whose power is nobody's concern. `from`: the vertex that a flight began at, whose
/// weight is the power before the flight.
struct NoTally {
  Flight fly(const Space& space, const PathVertex& from, const Vec3& direction,
             RandomStream& random, const Vec3* rise) const {
    return space.fly(from.point, direction, random, nullptr, rise);
  }
  void emitted(const PathVertex&) const {}
  void left(const PathVertex&, const Flight&) const {}
  void lost(const PathVertex&, const Flight&) const {}
  void cut(const PathVertex&, const Flight&) const {}
  void absorbed(const PathVertex&, const Flight&, double) const {}
  void ended(const PathVertex&, const Flight&, double) const {}
  void reweighed(Part, bool, double) const {}
};

/// Books the power of a light path that is walked to its end.
class LightTally : public NoTally {
 public:
  explicit LightTally(EnergyBalance& all) : all_(all) {}

  void emitted(const PathVertex& start) { path_.add(Fate::emitted, start.weight); }

  void left(const PathVertex& from, const Flight& flight) {
    spend(from.weight, flight);
    path_.add(fate(from, flight), from.weight * flight.weight);
  }
  void lost(const PathVertex& from, const Flight& flight) {
    spend(from.weight, flight);
    path_.add(Fate::lost, from.weight * flight.weight);
  }
  void cut(const PathVertex& from, const Flight& flight) {
    spend(from.weight, flight);
    path_.add(Fate::cut, from.weight * flight.weight);
  }
  /// A share of the power, in the flight and in the collision at its end.
  void absorbed(const PathVertex& from, const Flight& flight, double albedo) {
    absorb(from.weight, flight, albedo);
  }
  /// All of it: where, by these shares.
  void ended(const PathVertex& from, const Flight& flight, double albedo) {
    const double share = 1 - flight.weight + flight.weight * (1 - albedo);
    absorb(from.weight / share, flight, albedo);
  }

  /// Chance took so much of the weight, or gave it: 0 on average. Where it would end most often
  /// takes it up, so that all adds up.
  void reweighed(Part part, bool absorbs, double power) {
    path_.add(absorbs ? absorbed_in(part) : Fate::scattered, power);
  }

  void end_path() {
    all_ += path_;
    path_ = {};
  }

 private:
  static Fate absorbed_in(Part part) {
    return part == around ? Fate::absorbed_stage : Fate::absorbed_body;
  }
  static Fate fate(const PathVertex& from, const Flight& flight) {
    if (!from.end) return Fate::scattered;
    const bool stayed_out = flight.passages.count == 1 && from.point.part == flight.point.part;
    return stayed_out ? Fate::specular : Fate::unscattered;
  }
  void absorb(double power, const Flight& flight, double albedo) {
    spend(power, flight);
    path_.add(absorbed_in(flight.point.part), power * flight.weight * (1 - albedo));
  }
  void spend(double power, const Flight& flight) {
    path_.add(Fate::absorbed_body, power * flight.absorbed_in_body);
    const double elsewhere = 1 - flight.weight - flight.absorbed_in_body;
    path_.add(Fate::absorbed_stage, power * std::max(0.0, elsewhere));
  }

  EnergyBalance& all_;
  EnergyBalance path_;
};

}  // namespace flatspeckle::grin
