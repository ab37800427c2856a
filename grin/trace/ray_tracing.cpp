#include "grin/trace/ray_tracing.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>

#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "grin/rays/marching/lane_pool.h"
#include "grin/rays/surfaces/interface.h"
#include "grin/render/curved/ray_field.h"
#include "grin/render/stage/regions.h"

namespace flatspeckle::grin {

namespace {

Box hull_of(const std::vector<Body>& bodies) {
  Box hull = bounds(bodies.front().surface);
  for (const Body& body : bodies) {
    const Box box = bounds(body.surface);
    hull = {hull.low.cwiseMin(box.low), hull.high.cwiseMax(box.high)};
  }
  return hull;
}

void fill(const Surface& body, SceneField& field) {
  check_rim(field, body);
  check_field(field, body, "body");
  field.rim.reset();
  field.grid.reset();
}

std::string name(std::size_t ray) {
  return "ray " + std::to_string(ray);
}

void check_start(const SceneField& scene, const Stage& stage, const RayStops& stops,
                 std::size_t number, const RayStart& start) {
  const auto refuse = [&](const std::string& where) {
    throw InputError(name(number) + " starts at " + listed(start.x) + ": " + where);
  };
  if (scene.grid && scene.grid->distance(start.x) > 0) refuse("must lie inside the grid");
  if (!(index_at(scene, stage, start.x) > 0)) refuse("the index there must be above 0");
  for (const auto& surface : stops.surfaces)
    if (const auto* plane = std::get_if<Plane>(&surface);
        plane && plane->distance(start.x) > stops.location)
      refuse("must not lie behind stop_plane = " + listed(plane->point) + ' ' +
             listed(plane->outwards));
}

double largest_coordinate(const std::vector<RayStart>& starts) {
  double largest = 0;
  for (const RayStart& start : starts) largest = std::max(largest, start.x.cwiseAbs().maxCoeff());
  return largest;
}

class BundleTracer {
 public:
  BundleTracer(const SceneField& scene, const Stage& stage, const RayStops& stops,
               const RaySteps& steps, const std::vector<RayStart>& starts, std::size_t path_points,
               const std::vector<RayAperture>& apertures)
      : scene_(scene),
        stage_(stage),
        regions_(stage, largest_coordinate(starts)),
        stops_(stops),
        steps_(steps),
        path_points_(path_points),
        apertures_(apertures),
        surfaces_(stops.surfaces),
        inside_(make_ray_field(scene.field)),
        outside_(
            std::visit([](const auto& field) { return make_ray_field(field); }, scene.outside)) {
    for (const Body& body : stage.bodies) surfaces_.push_back(body.surface);
    if (scene.grid) surfaces_.push_back(*scene.grid);
    if (scene.rim) surfaces_.push_back(*scene.rim);
    first_aperture_ = static_cast<int>(surfaces_.size());
    for (const RayAperture& aperture : apertures) surfaces_.push_back(aperture.plane);
    for (Part part = around; part < stage.parts(); ++part)
      plain_.push_back(part == stage.field_part()
                           ? nullptr
                           : make_ray_field(Homogeneous{stage.excess_in(part)}));
  }

  /// Whether rays can be traced in SIMD lanes. This requires fixed steps, no bodies and no stored
  /// paths.
  bool has_lanes() const {
    return inside_->has_lanes() && stage_.bodies.empty() && !steps_.tolerance && path_points_ == 0;
  }

  TracedRay trace(std::size_t number, const RayStart& start) const {
    Going going(*this, number, start);
    going.log.start(going.ray);
    return finish(going, follow(going));
  }
  /// Traces the rays with numbers from first to last - 1 in SIMD lanes.
  void trace_in_lanes(std::span<const RayStart> starts, std::size_t first, std::size_t last,
                      std::vector<TracedRay>& rays) const {
    InLanes bundle(*this, starts, first, last, rays);
    LanePool(bundle).run();
  }

 private:
  struct Going {
    Going(const BundleTracer& tracer, std::size_t number_of_ray, const RayStart& start)
        : number(number_of_ray),
          log(tracer.steps_, tracer.path_points_ > 0),
          part(tracer.regions_.at(start.x, start.direction)),
          ray{start.x, (1 + tracer.excess(part, start.x, start.direction)) * start.direction},
          ends(tracer.sides_of_ends(ray)),
          first(tracer.invariants(ray)) {}

    std::size_t number;
    RayLog log;
    Part part;
    RayState ray;
    KnownSides ends;
    double transmittance = 1;
    bool is_absorbed = false;
    RayInvariants first;
    std::uint64_t steps = 0;
  };

  /// Provides a LanePool with the rays to trace (parameter Work of LanePool).
  class InLanes {
   public:
    InLanes(const BundleTracer& tracer, std::span<const RayStart> starts, std::size_t first,
            std::size_t last, std::vector<TracedRay>& rays)
        : tracer_(tracer), starts_(starts), next_(first), last_(last), rays_(rays) {}

    bool begin(int lane, RayState& ray) {
      while (next_ < last_) {
        const std::size_t number = next_++;
        auto& going = going_[lane].emplace(tracer_, number, starts_[number]);
        if (tracer_.comes_inside(going)) {
          watch_[lane].emplace(tracer_.surfaces_, tracer_.limits(going), going.ray);
          ray = going.ray;
          return true;
        }
        rays_[number] = tracer_.trace(number, starts_[number]);
      }
      return false;
    }
    void go(RayLanes& rays, const double*, int steps) const {
      std::fill_n(rays.step, lanes, tracer_.steps_.longest);
      tracer_.inside_->follow_lanes(tracer_.steps_.integrator, steps, rays);
    }
    double clearance(int lane, const RayState& ray) const { return watch_[lane]->clearance(ray); }
    bool passed(int lane, const RayLanes&, double) {
      going_[lane]->steps += steps_at_once;
      return true;
    }

    bool careful(int lane, RayState& ray, double& index_mismatch) {
      Going& going = *going_[lane];
      going.ray = ray;
      going.log.record_mismatch(index_mismatch);
      TraceLimits few = tracer_.limits(going);
      few.max_steps = steps_at_once;
      TraceEnd end = tracer_.inside_->follow(tracer_.surfaces_, few, going.log, going.ray);
      going.steps += static_cast<std::uint64_t>(end.steps);
      if (end.stop == Stop::steps && going.steps < most_steps) {
        ray = going.ray;
        index_mismatch = going.log.index_mismatch();
        return true;
      }
      end.steps = static_cast<long>(going.steps);
      if (!tracer_.has_ended(going, end)) end = tracer_.follow(going);
      rays_[going.number] = tracer_.finish(going, end);
      return false;
    }

   private:
    static constexpr int steps_at_once = LanePool<InLanes>::steps_at_once;
    static_assert(steps_at_once == RayLog::steps_between_checks);

    const BundleTracer& tracer_;
    std::span<const RayStart> starts_;
    std::size_t next_, last_;
    std::vector<TracedRay>& rays_;
    std::array<std::optional<Going>, lanes> going_;
    std::array<std::optional<Watch>, lanes> watch_;
  };

  static constexpr std::uint64_t most_steps = TraceLimits{}.max_steps;

  int number_of_stops() const { return static_cast<int>(stops_.surfaces.size()); }
  RayInvariants invariants(const RayState& ray) const {
    return ray_invariants(*inside_, ray, scene_.centre, scene_.axis);
  }
  TraceLimits limits(const Going& going) const {
    TraceLimits limits{stops_.max_length - going.ray.arc_length, stops_.location};
    limits.sides = going.ends;
    for (Part body = 1; body < regions_.parts(); ++body) {
      KnownSides& sides = limits.sides;
      (body < going.part    ? sides.ignored
       : body == going.part ? sides.inside
                            : sides.outside) |= bit(number_of_stops() + body - 1);
    }
    return limits;
  }
  static std::uint64_t bit(int surface) { return std::uint64_t{1} << surface; }
  /// Returns, for each stop surface and for the box of the grid, the side on which the ray stays
  /// until it ends.
  KnownSides sides_of_ends(const RayState& start) const {
    const Watch watch(surfaces_, {0, stops_.location}, start);
    KnownSides sides;
    for (int i = 0; i < number_of_stops(); ++i)
      (watch.is_inside(i) ? sides.inside : sides.outside) |= bit(i);
    if (scene_.grid) sides.inside |= bit(number_of_stops() + regions_.parts() - 1);
    for (int i = first_aperture_; i < static_cast<int>(surfaces_.size()); ++i)
      (watch.is_inside(i) ? sides.inside : sides.outside) |= bit(i);
    return sides;
  }

  TracedRay finish(const Going& going, const TraceEnd& end) const {
    TracedRay traced{.steps = going.steps,
                     .end = going.ray,
                     .index_mismatch = going.log.index_mismatch(),
                     .first = going.first,
                     .last = invariants(going.ray)};
    traced.status = going.is_absorbed                 ? RayStatus::absorbed
                    : end.stop == Stop::length        ? RayStatus::length
                    : end.surface < number_of_stops() ? RayStatus::surface
                                                      : RayStatus::edge_of_grid;
    const bool is_stop = traced.status == RayStatus::surface;
    traced.surface = static_cast<std::uint64_t>(is_stop ? end.surface : number_of_stops());
    traced.transmittance = going.transmittance;
    traced.end_derivative = field_of(going.part, going.ray).gradient(going.ray.x).gradient.norm();
    if (path_points_ > 0) traced.path = going.log.path().points(path_points_);
    return traced;
  }

  /// Follows the ray across the rim of the field and the surfaces of bodies until it ends.
  TraceEnd follow(Going& going) const {
    constexpr int most_seams = 100'000;
    if (leaves_grid(going.ray)) return {.stop = Stop::surface, .surface = number_of_stops()};
    for (int i = 0; i < most_seams; ++i) {
      TraceEnd end = follow_part(going);
      if (is_body(end.surface)) end.surface = stop_in_contact(going.ray.x).value_or(end.surface);
      if (has_ended(going, end)) return end;
      if (is_body(end.surface)) cross(going, end.surface - number_of_stops() + 1);
      if (end.surface >= first_aperture_) pass(going, end.surface);
      if (going.is_absorbed) return end;
    }
    throw InputError(
        "max_length", stops_.max_length,
        name(going.number) +
            " crosses the rim or body surfaces more than 100000 times; reduce max_length");
  }
  /// Returns the stop surface that touches a body's surface at x, if there is one. A ray ends there
  /// before it crosses the body's surface.
  std::optional<int> stop_in_contact(const Vec3& x) const {
    for (int i = 0; i < number_of_stops(); ++i)
      if (std::abs(distance(surfaces_[i], x)) <= regions_.contact(x)) return i;
    return std::nullopt;
  }
  TraceEnd follow_part(Going& going) const {
    const double before = going.ray.arc_length;
    const TraceEnd end =
        field_of(going.part, going.ray).follow(surfaces_, limits(going), going.log, going.ray);
    going.steps += static_cast<std::uint64_t>(end.steps);
    const double mu_t = stage_.medium_in(going.part).mu_t();
    going.transmittance *= std::exp(-mu_t * (going.ray.arc_length - before));
    return end;
  }
  /// Whether the ray has ended; false if it has only reached the rim of the field or a body. Throws
  /// InputError if the ray is lost.
  bool has_ended(const Going& going, const TraceEnd& end) const {
    if (end.stop == Stop::lost || end.stop == Stop::steps) throw lost(going, end);
    const bool at_rim = scene_.rim && end.surface + 1 == first_aperture_;
    return end.stop == Stop::length ||
           !(at_rim || is_body(end.surface) || end.surface >= first_aperture_);
  }
  bool is_body(int surface) const {
    const int body = surface - number_of_stops();
    return body >= 0 && body < static_cast<int>(stage_.bodies.size());
  }

  /// Lets the ray through the hole of an aperture, or absorbs it.
  void pass(Going& going, int surface) const {
    const RayAperture& aperture = apertures_[surface - first_aperture_];
    going.is_absorbed = (going.ray.x - aperture.plane.point).norm() > aperture.radius;
    if (going.is_absorbed) going.transmittance = 0;
    going.ends.inside ^= bit(surface);
    going.ends.outside ^= bit(surface);
  }

  /// Refracts, reflects or absorbs the ray at the surface of a body. Has no effect where another
  /// body covers this surface.
  void cross(Going& going, Part body) const {
    RayState& ray = going.ray;
    const Part to = regions_.beyond(going.part, body, ray.x, ray.v.normalized());
    if (to == going.part) return;
    const BodyFace kind = stage_.bodies[body - 1].face;
    if (kind == BodyFace::absorbs) {
      going.is_absorbed = true;
      going.transmittance = 0;
      return;
    }
    const Interface face(ray.v, normal(regions_.surface(body), ray.x),
                         excess(going.part, ray.x, ray.v), excess(to, ray.x, ray.v));
    if (const auto refracted = face.refracted(); refracted && kind == BodyFace::refracts) {
      going.transmittance *= 1 - face.reflectance();
      going.part = to;
      ray.v = *refracted;
    } else {
      ray.v = face.reflected();
    }
    going.log.start(ray);
  }
  double excess(Part part, const Vec3& x, const Vec3& towards) const {
    return field_of(part, {x, towards}).excess(x);
  }
  const RayField& field_of(Part part, const RayState& ray) const {
    if (plain_[part]) return *plain_[part];
    return is_outside(ray) ? *outside_ : *inside_;
  }
  /// Traces a ray that starts outside the rim of the field up to the rim. Returns whether the ray
  /// is then inside the rim.
  bool comes_inside(Going& going) const {
    if (leaves_grid(going.ray)) return false;
    if (!is_outside(going.ray)) return true;
    const TraceEnd end = outside_->follow(surfaces_, limits(going), going.log, going.ray);
    going.steps += static_cast<std::uint64_t>(end.steps);
    return !has_ended(going, end) && !is_outside(going.ray);
  }

  /// Whether the ray is at the edge of the grid and goes outwards.
  bool leaves_grid(const RayState& ray) const {
    return scene_.grid && scene_.grid->distance(ray.x) >= -stops_.location &&
           ray.v.dot(scene_.grid->normal(ray.x)) >= 0;
  }

  bool is_outside(const RayState& ray) const {
    if (!scene_.rim) return false;
    const double distance = scene_.rim->distance(ray.x);
    if (std::abs(distance) > stops_.location) return distance > 0;
    return ray.v.dot(scene_.rim->normal(ray.x)) >= 0;
  }

  InputError lost(const Going& going, const TraceEnd& end) const {
    const std::string ray = name(going.number);
    if (end.stop == Stop::steps)
      return InputError("max_length", stops_.max_length,
                        ray + " takes more than " + std::to_string(most_steps) +
                            " steps; increase step or tolerance, or reduce max_length");
    const Vec3& x = going.ray.x;
    const std::string where = x.allFinite() ? ", near " + listed(x) : "";
    return InputError(
        ray +
        " reaches a place where the index is not above 0 or varies too fast for the tolerance" +
        where);
  }

  const SceneField& scene_;
  const Stage& stage_;
  Regions regions_;
  const RayStops& stops_;
  const RaySteps& steps_;
  std::size_t path_points_;
  const std::vector<RayAperture>& apertures_;
  int first_aperture_ = 0;
  std::vector<Surface> surfaces_;
  std::unique_ptr<const RayField> inside_, outside_;  ///< fields inside and outside the rim
  /// Uniform index of each region of the stage; null for the region that contains the index field.
  std::vector<std::unique_ptr<const RayField>> plain_;
};

}  // namespace

void add_keys(Keys& keys, RayBodyValues& values) {
  keys.group("Body that rays pass");
  add_body_keys(keys, values);
  keys.group("Body that rays pass", std::string("a body (") + body_key_names + ")");
  add_index_around(keys, values);
  add_keys(keys, values.plain_bodies);
  keys.add("aperture_stop", values.aperture,
           "x y z nx ny nz radius: an opaque plane screen with a round hole; rays that miss the "
           "hole "
           "end there")
      .each_of(7, "x y z nx ny nz radius")
      .units("length length length 1 1 1 length");
}

std::vector<RayAperture> make_apertures(const Keys& keys, const RayBodyValues& values) {
  std::vector<RayAperture> apertures;
  for (const auto row : parts_of(keys.read(values.aperture), 7))
    apertures.push_back(
        {{vector_of(row), unit_direction("aperture_stop, normal", vector_of(row, 3))},
         positive("aperture_stop, radius", row[6])});
  return apertures;
}

Stage make_ray_stage(const Keys& keys, const RayBodyValues& values, SceneField& field,
                     const std::optional<double>& length_unit) {
  Stage stage;
  if (const auto body = given_body(keys, values)) {
    fill(body->surface, field);
    stage.bodies.push_back({.surface = body->surface, .note = body->note});
    stage.excess_around = keys.read(values.index_around) - 1;
  }
  for (Body& body : make_plain_bodies(keys, values.plain_bodies, length_unit)) {
    if (field.grid) check_within(body, *field.grid, "grid");
    stage.bodies.push_back(std::move(body));
  }
  if (stage.bodies.empty()) return stage;
  field.symmetry = Symmetry::none;
  sort_by_size(stage.bodies);
  stage.boundary = hull_of(stage.bodies);
  return stage;
}

double index_at(const SceneField& field, const Stage& stage, const Vec3& x) {
  const Part part = Regions(stage).at(x);
  return part == stage.field_part() ? index_at(field, x) : 1 + stage.excess_in(part);
}

std::vector<TracedRay> trace_rays(const SceneField& scene, const Stage& stage,
                                  const RayStops& stops, const RaySteps& steps,
                                  const std::vector<RayStart>& starts, std::size_t path_points,
                                  const std::vector<RayAperture>& apertures) {
  for (std::size_t i = 0; i < starts.size(); ++i) check_start(scene, stage, stops, i, starts[i]);
  std::vector<TracedRay> rays(starts.size());
  const BundleTracer tracer(scene, stage, stops, steps, starts, path_points, apertures);
  if (!tracer.has_lanes()) {
    parallel_for(starts.size(), [&](std::size_t i) {
      stop_if_interrupted();
      rays[i] = tracer.trace(i, starts[i]);
    });
    return rays;
  }
  constexpr std::size_t at_once = 16 * lanes;
  parallel_for((starts.size() + at_once - 1) / at_once, [&](std::size_t i) {
    stop_if_interrupted();
    const std::size_t last = std::min(starts.size(), (i + 1) * at_once);
    tracer.trace_in_lanes(starts, i * at_once, last, rays);
  });
  return rays;
}

}  // namespace flatspeckle::grin
