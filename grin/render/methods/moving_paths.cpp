#include "grin/render/methods/moving_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace flatspeckle::grin {

namespace {

/// Returns, approximately, the square root of the Fisher information of the phase function with
/// respect to the angle by which the arriving direction turns, per radian; nullopt if the
/// derivative of the phase function is not known.
std::optional<double> information(const SpacePhaseFunction& phase) {
  if (std::holds_alternative<IsotropicPhase>(phase.which)) return 0;
  const auto* hg = std::get_if<HgPhase>(&phase.which);
  if (!hg) return std::nullopt;
  const double g = std::abs(hg->g);
  return std::sqrt(0.6 * g) / (1 - g);
}
/// Derivative of ln p, where p is the phase function, with respect to the cosine between two unit
/// vectors. Using their difference, or sum for g < 0, avoids cancellation in 1 + g^2 - 2 g cosine
/// in a narrow peak, where the cosine is 1 to rounding.
double derivative_of_log(const SpacePhaseFunction& phase, const Vec3& from, const Vec3& to) {
  const auto* hg = std::get_if<HgPhase>(&phase.which);
  if (!hg) return 0;
  const double size = std::abs(hg->g), beside = 1 - size;
  const Vec3 apart = hg->g > 0 ? Vec3(to - from) : Vec3(to + from);
  return 3 * hg->g / (beside * beside + size * apart.squaredNorm());
}

}  // namespace

int MovingPaths::begin(const Vec3& x, const Vec3& direction, const EmissionChange& by_index) {
  starts_.push_back({.before = -1,
                     .depth = 0,
                     .x = x,
                     .arrived = direction,
                     .direction = direction,
                     .by_index = by_index});
  return static_cast<int>(starts_.size()) - 1;
}

int MovingPaths::go_on(int flight, const Vec3& x, const Vec3& arrived, double arc_length,
                       const Vec3& direction) {
  start(flight).arc_length = arc_length;
  starts_.push_back({.before = flight,
                     .depth = start(flight).depth + 1,
                     .x = x,
                     .arrived = arrived,
                     .direction = direction});
  return static_cast<int>(starts_.size()) - 1;
}

void MovingPaths::land(int flight, const Vec3& x, const Vec3& arrived, double arc_length,
                       double power) {
  const auto is_near = [&](const SensorEdges& edges) { return edges.is_near(x); };
  if (power > 0 && std::ranges::any_of(field_.edges(), is_near))
    landings_.push_back({flight, x, arrived, arc_length, power});
}

void MovingPaths::finish() {
  motions_.assign(starts_.size() * field_.parameters(), {});
  emit();
  for (const auto& flights : followed()) follow(flights);
  std::vector<int> flights;
  Lengths lengths;
  for (const Landing& landing : landings_) {
    flights.push_back(landing.flight);
    lengths.push_back(landing.arc_length);
  }
  for (std::size_t i = 0; i < field_.parameters(); ++i) {
    const auto ends = moved(i, flights, std::span(&lengths, 1)).front();
    for (std::size_t k = 0; k < flights.size(); ++k) {
      const Landing& landing = landings_[k];
      const double further = field_.exit_distance(landing.x, landing.arrived).dot(ends[k].x);
      Motion motion;
      motion.x = ends[k].x + further * landing.arrived;
      motion.score = motions(landing.flight)[i].score - field_.medium().mu_t() * further;
      add(landing, i, motion);
    }
  }
  starts_.clear();
  landings_.clear();
}

/// Sets the motions and scores at the starts of paths that land on a sensor or near one.
void MovingPaths::emit() {
  for (const Landing& landing : landings_) {
    int first = landing.flight;
    while (start(first).depth > 0) first = start(first).before;
    const EmissionChange& by_index = start(first).by_index;
    if (std::exchange(start(first).is_followed, true)) continue;
    if (by_index.weight == 0 && by_index.direction.isZero(0)) continue;
    for (std::size_t i = 0; i < field_.parameters(); ++i) {
      const double change = field_.index_change(i, start(first).x);
      motions(first)[i].direction = change * by_index.direction;
      motions(first)[i].score = change * by_index.weight;
    }
  }
}

/// Returns the flights after collisions that lead to landings, grouped by the number of collisions
/// before them.
std::vector<std::vector<int>> MovingPaths::followed() {
  std::vector<std::vector<int>> by_depth;
  for (const Landing& landing : landings_)
    for (int at = landing.flight; start(at).depth > 0 && !start(at).is_followed;
         at = start(at).before) {
      start(at).is_followed = true;
      const auto level = static_cast<std::size_t>(start(at).depth) - 1;
      if (by_depth.size() <= level) by_depth.resize(level + 1);
      by_depth[level].push_back(at);
    }
  return by_depth;
}

/// Computes the motions at the starts of flights from those of the flights before them. Several
/// flights may follow the same one.
void MovingPaths::follow(std::span<const int> flights) {
  std::vector<int> before;
  for (const int flight : flights) before.push_back(start(flight).before);
  std::ranges::sort(before);
  before.erase(std::unique(before.begin(), before.end()), before.end());
  const std::vector<Exit> exit = exits(before);
  std::array<Lengths, 2> stops;
  for (std::size_t k = 0; k < before.size(); ++k) {
    stops[0].push_back(start(before[k]).arc_length);
    stops[1].push_back(std::max(exit[k].arc_length, stops[0].back()));
  }
  for (std::size_t i = 0; i < field_.parameters(); ++i) {
    const auto ends = moved(i, before, stops);
    for (const int flight : flights) {
      const Start& next = start(flight);
      const auto k =
          static_cast<std::size_t>(std::ranges::lower_bound(before, next.before) - before.begin());
      const double s = stops[0][k],
                   relative_change = exit[k].gradient.dot(ends[1][k].x) / stops[1][k];
      const IndexGradient index = field_.index(next.x);
      const Vec3 across = index.gradient - next.arrived * next.arrived.dot(index.gradient);
      Motion& motion = motions(flight)[i];
      motion.x = ends[0][k].x + relative_change * s * next.arrived;
      motion.direction = ends[0][k].direction + relative_change * s / (1 + index.excess) * across;
      motion.score =
          motions(next.before)[i].score + relative_change * (1 - field_.medium().mu_t() * s);
      collide(next, field_.scale(i), motion);
    }
  }
}

std::vector<MovingPaths::Exit> MovingPaths::exits(std::span<const int> flights) const {
  std::vector<MovingField::Ray> rays;
  for (const int flight : flights) {
    const Start& from = starts_[static_cast<std::size_t>(flight)];
    rays.push_back({from.x, from.direction});
  }
  std::vector<Exit> found;
  for (const Flight& flight : field_.flown(rays)) {
    const bool is_out = flight.end == Flight::End::boundary;
    found.push_back({flight.arc_length, is_out
                                            ? field_.exit_distance(flight.point.x, flight.direction)
                                            : Vec3::Zero()});
  }
  return found;
}

std::vector<std::vector<MovingField::Motion>> MovingPaths::moved(std::size_t parameter,
                                                                 std::span<const int> flights,
                                                                 std::span<const Lengths> stops) {
  std::vector<MovingField::Ray> rays;
  std::vector<MovingField::Motion> from;
  for (const int flight : flights) {
    rays.push_back({start(flight).x, start(flight).direction});
    from.push_back(motions(flight)[parameter]);
  }
  return field_.moved(parameter, rays, from, stops);
}

void MovingPaths::collide(const Start& next, double scale, Motion& motion) const {
  const SpacePhaseFunction& phase = field_.medium().phase;
  const Vec3 turn = motion.direction;
  const auto known = information(phase);
  const double turned = known ? *known * scale * turn.norm() : 0;
  const double taken_back = known ? 1 / (1 + turned * turned) : 0;
  const double cosine = next.arrived.dot(next.direction), towards = turn.dot(next.direction);
  motion.score += taken_back * derivative_of_log(phase, next.arrived, next.direction) * towards;
  motion.direction = (1 - taken_back) * (cosine * turn - towards * next.arrived);
}

void MovingPaths::add(const Landing& landing, std::size_t parameter, const Motion& motion) {
  const auto add = [&](int pixel, int width, double change) {
    deposit_by_field(film_, counts_, pixel, static_cast<int>(parameter) * edge_widths + width,
                     landing.power * change);
  };
  for (const SensorEdges& edges : field_.edges()) {
    if (!edges.is_near(landing.x)) continue;
    edges.at(landing.x, [&](int pixel, double share) {
      for (int width = 0; width < edge_widths; ++width) add(pixel, width, share * motion.score);
    });
    if (over_edges_) edges.moved(landing.x, motion.x, field_.scale(parameter), add);
  }
}

}  // namespace flatspeckle::grin
