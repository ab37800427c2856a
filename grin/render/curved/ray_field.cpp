#include "grin/render/curved/ray_field.h"

#include "grin/rays/connections/connection_solver.h"
#include "grin/render/curved/curved_leg.h"

namespace flatspeckle::grin {

std::unique_ptr<const RayField> make_ray_field(const AnyIndexField& field,
                                               std::span<const Surface> room, bool leapfrogs) {
  constexpr decltype(&make_ray_field) in_file[ray_field_files] = {ray_field_in<0>, ray_field_in<1>,
                                                                  ray_field_in<2>};
  return in_file[field.index() % ray_field_files](field, room, leapfrogs);
}

namespace {

/// Integrators of a RayField for ConnectionTrial.
struct Leap {
  static void step(const RayField& field, RayState& ray, double h) { field.leap(ray, h); }
  static void step(const RayField& field, RayState& ray, RayTangent& tangent, double h) {
    field.leap(ray, tangent, h);
  }
};
struct OwnStep {
  using Rough = Leap;
  static bool is_rough(const RayField& field) { return field.leapfrogs(); }
  static void step(const RayField& field, RayState& ray, double h) { field.step(ray, h); }
  static void step(const RayField& field, RayState& ray, RayTangent& tangent, double h) {
    field.step(ray, tangent, h);
  }
};

using Trial = ConnectionTrial<RayField, Sides, OwnStep>;

}  // namespace

LegStop RayField::fly(const LegRoom& room, double longest, double& weight, RandomStream& random,
                      RayState& ray, RayTangent* tangent) const {
  const CurvedLeg leg(*this, room);
  return tangent ? leg.go(longest, weight, random, ray, *tangent)
                 : leg.go(longest, weight, random, ray);
}
LegStop RayField::go_on(const LegRoom& room, double longest, int most_steps, LegProgress& progress,
                        RandomStream& random, RayState& ray) const {
  return CurvedLeg(*this, room).go_on(longest, most_steps, progress, random, ray);
}
double RayField::ratio_tracked(const LegRoom& room, const RayState& ray, double sigma, int steps,
                               RandomStream& random) const {
  return CurvedLeg(*this, room).ratio_tracked(ray, sigma, steps, random);
}
double RayField::ratio_tracked(const LegRoom& room, const RayState& ray, double arc_length,
                               RandomStream& random) const {
  return CurvedLeg(*this, room).ratio_tracked(ray, arc_length, random);
}

ConnectionEstimate RayField::connect(const CurveEnds& ends, const ConnectionOptions& options,
                                     RandomStream& random, ConnectionStatistics& statistics) const {
  const Trial trial(*this, ends.region, ends.from, ends.to, options);
  return connect_chord_first(trial, random, statistics);
}
std::vector<FoundConnection> RayField::connections(const CurveEnds& ends,
                                                   const ConnectionOptions& options,
                                                   std::uint64_t trials, RandomStream& random,
                                                   ConnectionStatistics& statistics) const {
  const Trial trial(*this, ends.region, ends.from, ends.to, options);
  return all_connections(trial, trials, random, statistics);
}

}  // namespace flatspeckle::grin
