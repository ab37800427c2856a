#pragma once

#include <array>
#include <numbers>
#include <span>

#include "core/numbers/random.h"
#include "grin/render/transport/beam_join.h"
#include "grin/render/transport/film.h"
#include "grin/render/transport/path_vertex.h"
#include "grin/render/transport/subpath.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

/// Vertices of a light path, kept to be joined: all of a short path, of a long one some, each with
/// the same chance (reservoir sampling), so that joins cost in proportion to a path's length.
class LightVertices {
 public:
  static constexpr int capacity = 8;

  void clear() { offered_ = 0; }

  void offer(const PathVertex& vertex, RandomStream& random) {
    const auto place =
        offered_ < capacity ? offered_ : static_cast<int>(random.uniform() * (offered_ + 1));
    if (place < capacity) vertices_[place] = vertex;
    ++offered_;
  }

  std::span<const PathVertex> kept() const {
    return {vertices_.data(), static_cast<std::size_t>(std::min(offered_, capacity))};
  }
  /// Vertices of the path that each of the kept stands for.
  double each_stands_for() const { return std::max(1.0, static_cast<double>(offered_) / capacity); }

 private:
  std::array<PathVertex, capacity> vertices_;
  int offered_ = 0;
};

/// Path tracing, light tracing and bidirectional path tracing: one estimator, which draws and
/// weighs the strategies that it is allowed. A light path is walked and joined to the sensor from
/// each of its vertices; a sensor's path is walked and joined, from each vertex, to the lights and
/// to one of the vertices of the light path, drawn by what it promises. What a join promises is
/// what the straight line would give; joins that promise little are left to chance. One light path
/// serves all sensors, each of which has a path of its own.
///
/// Family: what a light path is split into, LightFamily, or LonePath.
template <class Family>
class Bidirectional {
 public:
  Bidirectional(const Transport& transport, const Space& space, RandomStream& random, Film& film,
                TransportCounts& counts)
      : transport_(transport),
        space_(space),
        random_(random),
        film_(film),
        counts_(counts),
        family_(family(transport, film)),
        promised_(transport.sensors.size()) {}

  /// One light path and one path from each sensor; `stratum` in (0, 1) says through which pixel.
  void add(double stratum) {
    std::fill(promised_.begin(), promised_.end(), JoinPromise());
    walk_from_light();
    const bool meets_nothing = transport_.lights.are_beams() &&
                               !transport_.strategies.joins_beams && vertices_.kept().empty();
    if (!meets_nothing) for_each_sensor([&] { walk_from_sensor(stratum); });
  }

  /// Appends what the last paths promised to each sensor, and kept of it.
  void append_promises(JoinPromises& promises) const {
    promises.insert(promises.end(), promised_.begin(), promised_.end());
  }

 private:
  /// The root of what a search for ways through the body's surface costs more than another join.
  double search_cost() const { return space_.has_curves() ? 1 : 10; }
  static constexpr double elsewhere = 0.1;

  static Family family(const Transport& transport, [[maybe_unused]] Film& film) {
    if constexpr (Family::is_split())
      return Family(*transport.depth, film.drift);
    else
      return {};
  }

  template <class Use>
  void for_each_sensor(const Use& use) {
    for (at_ = 0; at_ < promised_.size(); ++at_) use();
  }
  const SensorEnd& sensor() const { return transport_.sensors[at_]; }

  void walk_from_light() {
    vertices_.clear();
    const EndPosition end = transport_.lights.sample_position(space_, random_);
    const PathVertex start = end_vertex(transport_.strategies, end);
    join_to_sensors(start);
    const EndDirection first = transport_.lights.sample_direction(end, random_);
    const auto choice = [&](const EndPosition& at, const PathPoint& from) {
      return sensor_choice(at, from);
    };
    const auto left = [&](const PathVertex& last, const PathVertex& before) {
      if (end.is_beam && last.vertices == 2) return;  // summed apart (unscattered_beams.h)
      for_each_sensor([&] {
        arrive(sensor(), choice, last, before, transport_.strategies.most_sensor(),
               [&](const EndHit& hit) {
                 film_.add_hit(hit.direction.pixel, last.weight * hit.value);
                 return hit.direction.pixel;
               });
      });
    };
    const double last_kept = sample_last_kept();
    const auto collided = [&](const PathVertex& vertex) {
      ++counts_.light_collisions;
      join_to_sensors(vertex);
      if (vertex.vertices < last_kept) vertices_.offer(vertex, random_);
    };
    LightTally tally(film_.energy);
    walk(transport_, space_, never_chosen, start, first, transport_.strategies.short_light, random_,
         counts_, family_, tally, collided, left);
    tally.end_path();
  }

  void walk_from_sensor(double stratum) {
    if (transport_.strategies.short_sensor && sensor().can_be_hit()) return;  // it ends at once
    const EndPosition end = sensor().sample_position(space_, random_, stratum);
    const PathVertex start = end_vertex(transport_.strategies, end);
    const EndDirection first = sensor().sample_direction(end, random_, stratum);
    pixel_ = first.pixel;
    const auto choice = [&](const EndPosition& at, const PathPoint& from) {
      return sensor_choice(at, from);
    };
    const auto left = [&](const PathVertex& last, const PathVertex& before) {
      arrive(transport_.lights, never_chosen, last, before, transport_.strategies.most_light(),
             [&](const EndHit&) { return pixel_; });
    };
    const double last_kept = sample_last_kept();
    const auto collided = [&](const PathVertex& vertex) {
      join_to_light(vertex);
      if (vertex.vertices < last_kept) join_to_light_path(vertex);
    };
    LonePath alone;
    const NoTally tally;
    walk(transport_, space_, choice, start, first, transport_.strategies.short_sensor, random_,
         counts_, alone, tally, collided, left);
  }

  /// Joins to sensors are considered where light has a chance to come there: that counts in their
  /// density as the choice of a place does.
  double chance_considered(const PathPoint& from) const {
    if constexpr (Family::is_split())
      return transport_.depth->chance_to_join(from) * transport_.depth->share_of_joins(at_);
    return 1;
  }
  double sensor_choice(const EndPosition& end, const PathPoint& from) const {
    return sensor().choice(end, from.x) * chance_considered(from);
  }

  /// A number of vertices; those that have fewer are kept for joins to the other path.
  double sample_last_kept() {
    const double kept = transport_.strategies.kept;
    return kept < 1 ? 2 + std::log(random_.uniform()) / std::log(kept) : Strategies::unlimited;
  }

  /// A path that reached the boundary meets the other ends there.
  template <class End, class Choice, class Pixel>
  void arrive(const End& ends, const Choice& choice, const PathVertex& last,
              const PathVertex& before, int more, const Pixel& pixel) {
    ends.hit(space_, last.point.x, last.arrived, [&](const EndHit& hit) {
      PathVertex here = last;
      here.density *= std::abs(hit.position.inward.dot(last.arrived));
      here.first_of_other *= heuristic(choice(hit.position, before.point));
      const double others = rivals_of_hit(
          transport_.strategies, here, hit.position.position_density, hit.direction.density, more);
      const double value = here.weight * hit.value / (1 + others);
      promised_[at_].hits += value;
      add(pixel(hit), value, here.optical_path);
    });
  }

  void join_to_sensors(const PathVertex& y) {
    if constexpr (Family::is_split()) {
      const double draw = random_.uniform();
      if (draw >= transport_.depth->most_joins()) return;
      const double chance = transport_.depth->chance_to_join(y.point);
      for_each_sensor([&] {
        const double considered = chance * transport_.depth->share_of_joins(at_);
        if (draw < considered) join_to_sensor(y, considered);
      });
    } else {
      for_each_sensor([&] { join_to_sensor(y, 1); });
    }
  }
  void join_to_sensor(const PathVertex& y, double considered) {
    EndPosition end = sensor().choose_position(space_, y.point.x, random_);
    end.choice *= considered;
    const PathVertex z = end_vertex(transport_.strategies, end);
    join_to_end(y, z);
  }
  void join_to_light(const PathVertex& z) {
    const EndPosition end = transport_.lights.sample_position(space_, random_);
    if (end.is_beam) return join_to_beam(end, z);
    const PathVertex y = end_vertex(transport_.strategies, end);
    join_to_end(y, z);
  }

  /// Along the plainest way (beam_join.h).
  void join_to_beam(const EndPosition& end, const PathVertex& z) {
    if (!transport_.strategies.joins_beams || z.vertices - 1 > transport_.max_scatterings) return;
    const StageLights::Beam beam = transport_.lights.beam_of(end);
    const double chance = chance_to_join(promise(beam, end, z), transport_.beam_levels[at_]);
    if (!(chance > 0)) return;
    const auto way =
        space_.plainest_way_to_beam(z.point, beam.light(), random_, counts_.connections);
    if (!way || !beam.disk.contains(way->place)) return;
    const JoinedPath path = joined_to_beam(transport_, end, *way, z,
                                           leaving(transport_, sensor(), z, way->start_direction));
    const double value = path.value * path.weight * way->transmittance / chance;
    promised_[at_].beams += value;
    add(pixel_, value, way->optical_path + z.optical_path);
  }
  /// As facing(): the way may be another than the straight line.
  double promise(const StageLights::Beam& beam, const EndPosition& end, const PathVertex& z) {
    ++counts_.joins_weighed;
    const ParallelLight light = beam.light();
    const auto place = straight_place(light, z.point.x);
    if (!place) return 0;
    double density = beam.disk.contains(*place) ? beam.disk.density(*place) : 0;
    if (space_.has_curves() || space_.joins_through())
      density = std::max(density, elsewhere * beam.disk.density(light.x));
    if (!(density > 0)) return 0;
    const double depth = space_.least_depth(z.point, {*place, z.point.part});
    const JoinedPath path =
        joined_to_beam(transport_, end, density, z, facing(sensor(), z, -light.direction),
                       {.start_direction = light.direction,
                        .end_direction = light.direction,
                        .spreading = 1,
                        .optical_depth = depth});
    return path.value * path.weight * std::exp(-depth);
  }
  void join_to_end(const PathVertex& y, const PathVertex& z) {
    if (can_join(y, z)) join(y, z, promise(y, z));
  }

  /// One of the kept vertices stands for all, drawn by what they promise.
  void join_to_light_path(const PathVertex& z) {
    const std::span<const PathVertex> all = vertices_.kept();
    double sum = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      of_each_[i] = can_join(all[i], z) ? promise(all[i], z) / all[i].kept : 0;
      sum += of_each_[i];
    }
    if (!(sum > 0)) return;
    double rest = sum * random_.uniform();
    std::size_t i = 0;
    while (i + 1 < all.size() && rest >= of_each_[i]) rest -= of_each_[i++];
    if (!(of_each_[i] > 0)) return;
    PathVertex y = all[i];
    const double stands_for = vertices_.each_stands_for() / z.kept;
    y.weight *= stands_for * sum / (of_each_[i] * y.kept);
    join(y, z, stands_for * sum);
  }

  bool can_join(const PathVertex& y, const PathVertex& z) const {
    return space_.can_join(y.point, z.point) && !(y.end && y.end->is_beam) &&
           y.vertices + z.vertices - 2 <= transport_.max_scatterings;
  }

  /// Of the path that the straight line would make.
  double promise(const PathVertex& y, const PathVertex& z) {
    ++counts_.joins_weighed;
    const Vec3 way = z.point.x - y.point.x;
    const double length = way.norm();
    const double depth = space_.least_depth(y.point, z.point);
    const Vec3 direction = way / length;
    const Join line{.start_direction = direction,
                    .end_direction = direction,
                    .spreading = length * length,
                    .optical_depth = depth};
    const JoinedPath path =
        joined_path(transport_.strategies, y, facing(transport_.lights, y, direction), z,
                    facing(sensor(), z, -direction), line);
    return path.value * path.weight * std::exp(-depth);
  }

  /// As leaving(); but where rays are curved or refracted an end may look along the curve and not
  /// along the straight line, so that some of its other directions counts too.
  template <class End>
  EndDirection facing(const End& ends, const PathVertex& vertex, const Vec3& direction) {
    EndDirection way = leaving(transport_, ends, vertex, direction);
    if (space_.has_curves() || space_.joins_through()) {
      if (vertex.end)
        way.strength = std::max(way.strength,
                                elsewhere * ends.sample_direction(*vertex.end, random_).strength);
      else if (space_.joins_through())
        way.strength = std::max(way.strength, elsewhere / (4 * std::numbers::pi));
    }
    return way;
  }

  void join(const PathVertex& y, const PathVertex& z, double promised) {
    promised_[at_].joins += promised;
    const double level = transport_.join_levels[at_];
    if (const double chance = chance_to_join(promised, level); chance > 0) {
      promised_[at_].made += promised / chance;
      add_joined(y, z, space_.join(y.point, z.point, random_, counts_.connections), chance);
    }
    if (!space_.joins_through()) return;
    if (const double chance = chance_to_join(promised, search_cost() * level); chance > 0)
      add_joined(y, z, space_.join_through(y.point, z.point, random_, counts_.connections), chance);
  }

  /// 0 where the join is left out.
  double chance_to_join(double promised, double level) {
    const double chance = std::min(1.0, promised / level);
    if (!(chance > 0) || random_.uniform() >= chance) return 0;
    ++counts_.joins;
    return chance;
  }

  void add_joined(const PathVertex& y, const PathVertex& z, const std::optional<Join>& curve,
                  double chance) {
    if (!curve) return;
    const EndDirection from_y = leaving(transport_, transport_.lights, y, curve->start_direction);
    const EndDirection from_z = leaving(transport_, sensor(), z, -curve->end_direction);
    const JoinedPath path = joined_path(transport_.strategies, y, from_y, z, from_z, *curve);
    const double value =
        path.value * path.weight * curve->transmittance * curve->multiplicity / chance;
    promised_[at_].brought += value;
    add(z.end ? path.pixel : pixel_, value, y.optical_path + curve->optical_path + z.optical_path);
  }

  void add(int pixel, double value, double optical_path) {
    deposit(film_, counts_, pixel, value, optical_path);
  }

  const Transport& transport_;
  const Space& space_;
  RandomStream& random_;
  Film& film_;
  TransportCounts& counts_;
  Family family_;
  LightVertices vertices_;  ///< that are kept for joins
  std::array<double, LightVertices::capacity> of_each_{};
  JoinPromises promised_;  ///< by the paths at hand, to each sensor
  std::size_t at_ = 0;     ///< the sensor at hand
  int pixel_ = -1;         ///< of its path
};

}  // namespace flatspeckle::grin
