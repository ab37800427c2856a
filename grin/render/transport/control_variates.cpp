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

/// Whether the modes of the medium are known (CaseMode).
bool has_modes(const ScatteringMedium& medium) {
  return medium.is_uniform() && (std::holds_alternative<IsotropicPhase>(medium.phase.which) ||
                                 std::holds_alternative<HgPhase>(medium.phase.which));
}

/// Returns the axis of a box along its shortest edge, if that is unique; else `towards`.
Vec3 axis_of(const Surface& surface, const Vec3& towards) {
  const auto* box = std::get_if<Box>(&surface);
  if (!box) return towards;
  int axis;
  const Vec3 size = box->high - box->low;
  const double shortest = size.minCoeff(&axis);
  constexpr double much = 1.5;
  if ((size.array() < much * shortest).count() > 1) return towards;
  return Vec3::Unit(axis) * (towards[axis] < 0 ? -1 : 1);
}

}  // namespace

std::optional<ControlVariates> ControlVariates::of(const Stage& stage, const Vec3& towards,
                                                   std::span<const PathPoint> starts) {
  const auto part = scattering_part(stage);
  if (!part || stage.parts() > 2 || !has_modes(stage.medium_in(*part))) return std::nullopt;
  const Vec3 axis = axis_of(stage.surface(*part), towards);
  if (!(axis.norm() > 0)) return std::nullopt;
  ControlVariates found(stage, *part, axis);
  // the modes are smooth up to most_kappa, and finite up to most_growth
  constexpr double most_kappa = 0.95, most_growth = 300;
  const double kappa = found.mode_.kappa();
  if (kappa > most_kappa || kappa * found.depth() > most_growth) return std::nullopt;
  found.find_growth(starts);
  return found;
}

ControlVariates::ControlVariates(const Stage& stage, Part part, const Vec3& axis)
    : mode_(stage.medium_in(part).albedo(), stage.medium_in(part).phase.mean_cosine()),
      part_(part),
      axis_(axis),
      mu_t_(stage.medium_in(part).mu_t()),
      albedo_(stage.medium_in(part).albedo()) {
  const Box box = bounds(stage.surface(part));
  centre_ = (box.low + box.high) / 2;
  thickness_ = axis.cwiseAbs().dot(box.high - box.low);
  tabulate();
  if (stage.parts() == 1) return;
  inside_excess_ = stage.excess_in(part);
  outside_excess_ = stage.excess_in(1 - part);
}

/// Tabulates the cubics through four values of the mode in each interval.
void ControlVariates::tabulate() {
  constexpr int intervals = 512;
  for (int i = 0; i < intervals; ++i) {
    double f[4];
    for (int k = 0; k < 4; ++k) f[k] = mode_.angle(2 * (i + k / 3.0) / intervals - 1).scattered[0];
    const double first = f[1] - f[0], second = f[2] - 2 * f[1] + f[0],
                 third = f[3] - 3 * f[2] + 3 * f[1] - f[0];
    cubics_.push_back(
        {f[0], 3 * (first - second / 2 + third / 3), 4.5 * (second - third), 4.5 * third});
  }
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
  const double rate = mode_.kappa() * mu_t_;
  grows_little_ = rate * (thickness_ / 2 - low) <= little;
  has_decaying_ = mode_.kappa() > 0 && rate * (high + thickness_ / 2) <= little;
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
          collides ? arriving(grown, now.angle) : departing(part_, grown, now.angle);
      if (collides) {
        end.growth = grown;
        end.arriving = there;
      }
      const Modes change = after * segment.weight * there - weight * now.modes;
      sums[0] += change[0];
      sums[1] += change[1];
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
  sums[0] += weight * (now.modes[0] - expected[0]);
  sums[1] += weight * (now.modes[1] - expected[1]);
  const double more_reflected = (is_reflected ? 1 : 0) - reflectance;
  if (!is_inside)
    sums[4] += weight * more_reflected;
  else
    sums[axis_.dot(normal) * normal.dot(v) > 0 ? 2 : 3] -= weight * more_reflected;
  return now;
}

}  // namespace flatspeckle::grin
