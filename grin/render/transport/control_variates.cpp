#include "grin/render/transport/control_variates.h"

#include <algorithm>
#include <cmath>

#include "grin/rays/surfaces/interface.h"

namespace flatspeckle::grin {

namespace {

/// Returns the only part that scatters; nullopt if there is none, or more than one.
std::optional<Part> scattering_part(const Stage& stage) {
  std::optional<Part> found;
  for (Part part = around; part < stage.parts(); ++part) {
    if (!(stage.medium_in(part).mu_s > 0)) continue;
    if (found) return std::nullopt;
    found = part;
  }
  return found;
}

/// Whether the modes of the medium are known (CaseModes).
bool has_modes(const ScatteringMedium& medium) {
  return medium.is_uniform() && (std::holds_alternative<IsotropicPhase>(medium.phase.which) ||
                                 std::holds_alternative<HgPhase>(medium.phase.which));
}

/// Returns the axis of a slab, a box with one shortest edge; nullopt for other surfaces.
std::optional<Vec3> axis_of_slab(const Surface& surface, const Vec3& towards) {
  const auto* box = std::get_if<Box>(&surface);
  if (!box) return std::nullopt;
  int axis;
  const Vec3 size = box->high - box->low;
  const double shortest = size.minCoeff(&axis);
  constexpr double much = 1.5;
  if ((size.array() < much * shortest).count() > 1) return std::nullopt;
  return Vec3::Unit(axis) * (towards[axis] < 0 ? -1 : 1);
}

Vec3 middle_of(const Surface& surface) {
  const Box box = bounds(surface);
  return (box.low + box.high) / 2;
}
Vec3 size_of(const Surface& surface) {
  const Box box = bounds(surface);
  return box.high - box.low;
}

}  // namespace

std::optional<ControlVariates> ControlVariates::of(const Stage& stage, const Vec3& towards,
                                                   std::span<const PathPoint> starts) {
  const auto part = scattering_part(stage);
  if (!part || stage.parts() > 2 || stage.has_opaque_bodies() || !has_modes(stage.medium_in(*part)))
    return std::nullopt;
  const auto of_slab = axis_of_slab(stage.surface(*part), towards);
  const Vec3 axis = of_slab.value_or(towards);
  if (!(axis.norm() > 0)) return std::nullopt;
  // fast modes describe layers near faces normal to the axis
  ControlVariates found(stage, *part, axis, of_slab ? CaseModes::most_pairs : 1);
  if (found.modes_.rates()[0] > found.largest_rate()) return std::nullopt;
  found.find_growth(starts);
  return found;
}

ControlVariates::ControlVariates(const Stage& stage, Part part, const Vec3& axis, int pairs)
    : part_(part),
      axis_(axis),
      centre_(middle_of(stage.surface(part))),
      mu_t_(stage.medium_in(part).mu_t()),
      albedo_(stage.medium_in(part).albedo()),
      thickness_(axis.cwiseAbs().dot(size_of(stage.surface(part)))),
      modes_(albedo_, stage.medium_in(part).phase.mean_cosine(), pairs, largest_rate()) {
  if (stage.parts() == 1) return;
  inside_excess_ = stage.excess_in(part);
  outside_excess_ = stage.excess_in(1 - part);
}

/// Largest rate of modes that are smooth, and whose values in the part are finite.
double ControlVariates::largest_rate() const {
  constexpr double smooth = 0.95, most_growth = 300;
  return std::min(smooth, most_growth / depth());
}

/// Compares the largest value of each mode in the part with its smallest value where light starts.
void ControlVariates::find_growth(std::span<const PathPoint> starts) {
  constexpr double little = 3;  // of the logarithm
  double low = thickness_ / 2, high = -low;
  for (const PathPoint& start : starts) {
    const double z = std::clamp(axis_.dot(start.x - centre_), -thickness_ / 2, thickness_ / 2);
    low = std::min(low, z);
    high = std::max(high, z);
  }
  const double rate = modes_.rates()[0] * mu_t_;
  grows_little_ = rate * (thickness_ / 2 - low) <= little;
  // paths sample the fast modes at a face if they sample the slow one there
  if (!(rate * (high + thickness_ / 2) <= little)) is_used_.tail<CaseModes::most_pairs>() = 0;
}

ControlVariates::Arrival ControlVariates::add_flight(const Flight& flight, const FlightLog& log,
                                                     const Departure& from, double before,
                                                     double after, Sums& sums) const {
  Arrival end{from};
  Departure& now = end.from;
  double weight = before;
  for (std::size_t i = 0; i < log.size(); ++i) {
    const FlightSegment& segment = log[i];
    const bool is_last = i + 1 == log.size();
    if (segment.start.part == part_) {
      const Modes grown = growth(is_last ? flight.point.x : log[i + 1].start.x);
      const bool collides = is_last && flight.end == Flight::End::collision;
      const Modes there =
          collides ? modes_.arriving(grown, now.angle) : modes_.departing(grown, now.angle);
      if (collides) {
        end.growth = grown;
        end.arriving = there;
      }
      add(after * segment.weight * there - weight * now.modes, sums);
    }
    if (is_last) break;
    weight = after * log[i + 1].weight;
    now = cross(segment, log[i + 1], weight, sums);
  }
  return end;
}

ControlVariates::Departure ControlVariates::cross(const FlightSegment& from,
                                                  const FlightSegment& to, double weight,
                                                  Sums& sums) const {
  const Modes grown = growth(to.start.x);
  const Departure now = departure(to.start.part, grown, to.direction);
  if (inside_excess_ == outside_excess_) return now;
  const bool is_reflected = to.start.part == from.start.part, is_inside = from.start.part == part_;
  const double here = is_inside ? inside_excess_ : outside_excess_,
               beyond = is_inside ? outside_excess_ : inside_excess_;
  const Vec3 v = (1 + here) * from.direction;
  const Vec3 change = v - (1 + (is_reflected ? here : beyond)) * to.direction;
  const Vec3 normal = change.normalized();
  const Interface face(v, normal, here, beyond);
  if (face.is_total()) return now;
  const double reflectance = face.reflectance();
  const Part other = is_inside ? 1 - part_ : part_;
  const auto leaving = [&](Part part, const Vec3& direction) {
    return departure(part, grown, direction.normalized()).modes;
  };
  const Modes expected = reflectance * leaving(from.start.part, face.reflected()) +
                         (1 - reflectance) * leaving(other, *face.refracted());
  add(weight * (now.modes - expected), sums);
  const double more_reflected = (is_reflected ? 1 : 0) - reflectance;
  double* const leaving_light = &sums[Modes::SizeAtCompileTime];  // ahead, behind, outside
  if (!is_inside)
    leaving_light[2] += weight * more_reflected;
  else
    leaving_light[axis_.dot(normal) * normal.dot(v) > 0 ? 0 : 1] -= weight * more_reflected;
  return now;
}

}  // namespace flatspeckle::grin
