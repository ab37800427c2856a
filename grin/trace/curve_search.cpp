#include "grin/trace/curve_search.h"

#include <algorithm>

#include "core/keys/number_text.h"
#include "grin/render/curved/ray_field.h"

namespace flatspeckle::grin {

namespace {

/// The side of each surface that both ends are on; points on a surface are on both.
class SameSides {
 public:
  SameSides(const SceneField& scene, const RayStops& stops, const CurveSearch& search)
      : surfaces_(stops.surfaces), location_(stops.location) {
    for (const auto& surface : surfaces_)
      signs_.push_back(common_side(surface, search.from, search.to));
    if (search.ball) keep_inside(*search.ball, search, "the ball");
    if (scene.grid) keep_inside(*scene.grid, search, "the grid");
  }

  Sides region() const { return {surfaces_, signs_, location_}; }

  /// Whether the curve meets no surface on its way, also between the steps that are asked about.
  bool holds(const RayField& field, const Vec3& from, const Connection& curve) const {
    const RaySteps steps{Sharma(), curve.sigma / curve.steps};
    RayLog log(steps, false);
    RayState ray = start_ray(field, from, curve.start_direction);
    field.follow(surfaces_, {curve.arc_length, location_}, log, ray);
    return ray.arc_length > (1 - 1e-6) * curve.arc_length;  // its end may be on one
  }

 private:
  /// 1: inside, -1: outside.
  double common_side(const Surface& surface, const Vec3& from, const Vec3& to) const {
    const double a = distance(surface, from), b = distance(surface, to);
    if (a <= location_ && b <= location_) return 1;
    if (std::holds_alternative<Plane>(surface))
      throw InputError("connect", listed(a > location_ ? from : to), "is behind a stop_plane");
    if (a >= -location_ && b >= -location_) return -1;
    throw InputError("connect", listed(from) + ' ' + listed(to),
                     "are on different sides of a stop surface");
  }

  void keep_inside(const Surface& surface, const CurveSearch& search, const std::string& what) {
    for (const Vec3& x : {search.from, search.to})
      if (distance(surface, x) > location_)
        throw InputError("connect", listed(x), "is outside of " + what);
    surfaces_.push_back(surface);
    signs_.push_back(1);
  }

  std::vector<Surface> surfaces_;
  std::vector<double> signs_;
  double location_;
};

/// Trials that ended on curves that do not hold have left the region.
template <class Holds>
void sort_out(FoundConnections& found, const Holds& holds) {
  auto& outcomes = found.statistics.outcomes;
  auto& converged = outcomes[static_cast<int>(TrialOutcome::converged)];
  std::erase_if(found.curves, [&](const FoundConnection& one) {
    if (holds(one.curve)) return false;
    const auto trials = std::min(converged, one.found);  // in a homogeneous field none ran
    converged -= trials;
    outcomes[static_cast<int>(TrialOutcome::left_region)] += trials;
    return true;
  });
}

}  // namespace

void add_keys(Keys& keys, CurveValues& values) {
  keys.group("Curves");
  keys.add("connect", values.connect,
           "x y z x y z: instead of rays, the curves from the first point to the second")
      .exactly(6, "six numbers x y z x y z");
  keys.add("trials", values.trials, "Random starts in search of curves")
      .positive()
      .only_of("connect");
}

std::optional<CurveSearch> make_curve_search(const Keys& keys, const CurveValues& values) {
  const auto& ends = keys.read(values.connect);
  if (ends.empty()) return std::nullopt;
  const CurveSearch search{vector_of(ends), vector_of(ends, 3),
                           static_cast<std::uint64_t>(keys.read(values.trials))};
  if ((search.to - search.from).norm() <= 1e-10 * std::max(search.from.norm(), search.to.norm()))
    throw InputError("connect", number_text(ends), "must be two different points");
  return search;
}

double largest_index(const SceneField& scene, const CurveSearch& search) {
  constexpr int points = 101;
  double largest = 0;
  for (int i = 0; i < points; ++i) {
    const Vec3 x = search.from + i / (points - 1.0) * (search.to - search.from);
    largest = std::max(largest, index_at(scene, x));
  }
  return largest > 0 ? largest : 1;
}

FoundConnections find_connections(const SceneField& scene, const RayStops& stops, double step,
                                  const CurveSearch& search, std::uint64_t seed) {
  const SameSides sides(scene, stops, search);
  const auto field = make_ray_field(scene.field);
  for (const Vec3& x : {search.from, search.to})
    if (!(index(*field, x) > 0))
      throw InputError("connect", listed(x), "is where the field has no index above 0");
  RandomStream random(seed, static_cast<std::uint64_t>(Stream::light_paths), 0);
  FoundConnections found;
  found.curves = field->connections({search.from, search.to, sides.region()},
                                    {.step = step, .max_length = stops.max_length}, search.trials,
                                    random, found.statistics);
  sort_out(found, [&](const auto& curve) { return sides.holds(*field, search.from, curve); });
  return found;
}

}  // namespace flatspeckle::grin
