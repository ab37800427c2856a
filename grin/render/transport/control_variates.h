#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "grin/media/scattering/case_modes.h"
#include "grin/render/flights/space.h"
#include "grin/render/transport/film.h"
#include "grin/render/transport/path_vertex.h"

namespace flatspeckle::grin {

/// Martingale control variates of light paths in the one part of a stage that scatters, along an
/// axis: the eigenmodes that grow and that decay along it (CaseModes); light that leaves the part
/// ahead, and behind; and light that its surface reflects outside. Outside of the part the modes
/// are 0. A change along a path (flight, reflection or refraction, scattering, roulette) is
/// compared with its mean, so that the sums have mean 0 wherever paths end. The importance of a
/// slab is nearly a linear combination of these; its coefficients follow from a regression
/// (controlled_jackknife()).
class ControlVariates {
 public:
  using Sums = std::array<double, control_variate_count>;
  using Modes = CaseModes::Values;

  /// Returns nullopt unless exactly one part scatters, is uniform and a box or a sphere, and has a
  /// phase function and a decay for which the modes are known. towards: direction from the lights
  /// to the sensors, which is the axis except in a box with one shortest edge. starts: positions
  /// where light starts.
  static std::optional<ControlVariates> of(const Stage& stage, const Vec3& towards,
                                           std::span<const PathPoint> starts);

  /// Thickness of the part along the axis, in mean free paths.
  double depth() const { return mu_t_ * thickness_; }
  double albedo() const { return albedo_; }
  /// Whether paths that are not split sample the growing mode well: it grows little from where
  /// light starts. If not, the few paths of high growth may be missing, and the sum seems to have
  /// another mean than 0.
  bool grows_little() const { return grows_little_; }

  /// Returns the growth of the modes at a position (CaseModes::growth).
  Modes growth(const Vec3& x) const {
    return is_used_ * modes_.growth(mu_t_ * axis_.dot(x - centre_));
  }
  CaseModes::Angle angle(const Vec3& direction) const {
    return modes_.angle(std::clamp(axis_.dot(direction), -1.0, 1.0));
  }
  /// Returns the modes before a free flight, in a part.
  Modes departing(Part part, const Modes& growth, const CaseModes::Angle& along) const {
    return part == part_ ? modes_.departing(growth, along) : Modes(Modes::Zero());
  }

  /// State of a path at the start of a flight or, with another weight, at its end.
  struct Departure {
    CaseModes::Angle angle{};
    Modes modes = Modes::Zero();
  };
  Departure departure(Part part, const Modes& growth, const Vec3& direction) const {
    const CaseModes::Angle along = angle(direction);
    return {along, departing(part, growth, along)};
  }
  /// End of a flight: the departure of its last segment and, at a collision, growth() and the modes
  /// before the collision there.
  struct Arrival {
    Departure from{};
    Modes growth = Modes::Zero(), arriving = Modes::Zero();
  };
  /// Adds a change of the modes.
  static void add(const Modes& change, Sums& sums) {
    for (Eigen::Index i = 0; i < change.size(); ++i) sums[static_cast<std::size_t>(i)] += change[i];
  }
  /// Adds the changes during a flight. before: weight before the flight; after: weight that a
  /// flight has if it loses nothing in parts that absorb without scattering.
  Arrival add_flight(const Flight& flight, const FlightLog& log, const Departure& from,
                     double before, double after, Sums& sums) const;

 private:
  ControlVariates(const Stage& stage, Part part, const Vec3& axis, int pairs);
  double largest_rate() const;
  void find_growth(std::span<const PathPoint> starts);

  /// Adds the changes at the surface between two segments of a flight; returns the departure from
  /// it.
  Departure cross(const FlightSegment& from, const FlightSegment& to, double weight,
                  Sums& sums) const;

  Part part_;
  double outside_excess_ = 0, inside_excess_ = 0;  ///< index - 1 around the part, and in it
  Vec3 axis_, centre_;
  double mu_t_, albedo_, thickness_;
  CaseModes modes_;
  Modes is_used_ = Modes::Ones();  ///< 1 or 0 for each mode
  bool grows_little_ = false;
};

/// Control variates along a path that is split.
class PathControls {
 public:
  /// Values at a collision; `arriving` is divided by the albedo.
  struct Place {
    ControlVariates::Modes growth = ControlVariates::Modes::Zero(),
                           arriving = ControlVariates::Modes::Zero();
  };

  /// Holds references to the control variates and to their sums.
  PathControls(const ControlVariates& of, ControlVariates::Sums& sums) : of_(of), sums_(sums) {}

  void begin(const PathPoint& start, const Vec3& direction) {
    from_ = of_.departure(start.part, of_.growth(start.x), direction);
  }
  /// Returns the log that receives the segments of the next flight.
  FlightLog* log() {
    log_.clear();
    return &log_;
  }
  /// Adds a flight. before, after: as in ControlVariates::add_flight().
  void flew(double before, double after, const Flight& flight) {
    const auto end = of_.add_flight(flight, log_, from_, before, after, sums_);
    at_ = {end.growth, end.arriving / of_.albedo()};
  }
  void turned(const PathVertex& here, const Vec3& direction) {
    from_ = of_.departure(here.point.part, at_.growth, direction);
    add(here.weight * (from_.modes - at_.arriving));
  }
  /// Adds a change of weight by roulette at a collision.
  void reweighed(double change) { add(change * at_.arriving); }

  const Place& place() const { return at_; }
  void go_to(const Place& place) { at_ = place; }

 private:
  void add(const ControlVariates::Modes& change) { ControlVariates::add(change, sums_); }

  const ControlVariates& of_;
  ControlVariates::Sums& sums_;
  ControlVariates::Departure from_;
  Place at_ = {};
  FlightLog log_;
};

}  // namespace flatspeckle::grin
