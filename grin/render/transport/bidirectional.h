#pragma once

#include <array>
#include <numbers>
#include <span>

#include "core/numbers/random.h"
#include "grin/render/transport/beam_connection.h"
#include "grin/render/transport/film.h"
#include "grin/render/transport/path_vertex.h"
#include "grin/render/transport/scrambled_sobol.h"
#include "grin/render/transport/subpath.h"
#include "grin/render/transport/transport_counts.h"

namespace flatspeckle::grin {

/// Reservoir of light-path vertices for connections: all vertices of a short path, a uniform random
/// subset of a long one (reservoir sampling), so that the cost of connections grows linearly with
/// path length.
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
  /// Number of path vertices that each kept vertex represents.
  double each_stands_for() const { return std::max(1.0, static_cast<double>(offered_) / capacity); }

 private:
  std::array<PathVertex, capacity> vertices_;
  int offered_ = 0;
};

/// Path tracing, light tracing and bidirectional path tracing as one estimator, which samples and
/// weights the strategies that are enabled. Each vertex of a light path is connected to the sensor.
/// Each vertex of a sensor path is connected to the lights and to one vertex of the light path,
/// drawn in proportion to its expected contribution, which is computed for the straight line.
/// Connections of low expected contribution undergo Russian roulette. All sensors share one light
/// path; each sensor has its own sensor path.
///
/// Template argument Tree: SplitTree if light paths are split, else UnsplitPath.
template <class Tree>
class Bidirectional {
 public:
  Bidirectional(const Transport& transport, const Space& space, RandomStream& random, Film& film,
                TransportCounts& counts)
      : transport_(transport),
        space_(space),
        random_(random),
        film_(film),
        counts_(counts),
        tree_(make_tree(transport, film)),
        expected_(transport.sensors.size()) {}

  /// Adds one light path and one path from each sensor. path: number of the pair among the `paths`
  /// pairs of the batch, over which the paths of a sensor are spread evenly to its pixels.
  void add(int path, int paths) {
    std::fill(expected_.begin(), expected_.end(), ExpectedConnection());
    random_.lead(light_points(random_).point(path));
    walk_from_light();
    const bool meets_nothing = transport_.lights.are_beams() &&
                               !transport_.strategies.connects_beams && vertices_.kept().empty();
    if (!meets_nothing) for_each_sensor([&] { walk_from_sensor(path, paths); });
  }

  /// Appends expected and actual contributions of the last paths, for each sensor.
  void append_expected_contributions(ExpectedConnections& expected_connections) const {
    expected_connections.insert(expected_connections.end(), expected_.begin(), expected_.end());
  }

 private:
  /// Square root of the cost of a specular connection search relative to that of another
  /// connection.
  double search_cost() const { return space_.has_curves() ? 1 : 10; }
  /// Lower bound of strengths from facing(), as a fraction of the strength in a sampled direction.
  static constexpr double elsewhere = 0.1;

  static Tree make_tree(const Transport& transport, [[maybe_unused]] Film& film) {
    if constexpr (Tree::is_split())
      return Tree(*transport.depth, film.control_variates);
    else
      return {};
  }

  template <class Use>
  void for_each_sensor(const Use& use) {
    for (at_ = 0; at_ < expected_.size(); ++at_) use();
  }
  const SensorEnd& sensor() const { return transport_.sensors[at_]; }

  void walk_from_light() {
    vertices_.clear();
    const EndPosition end = transport_.lights.sample_position(space_, random_);
    const PathVertex start = end_vertex(transport_.strategies, end);
    if (transport_.light_choice(end) > 0) connect_to_sensors(start);
    const EndDirection first = transport_.lights.sample_direction(end, random_);
    const auto choice = [&](const EndPosition& at, const PathPoint& from) {
      return sensor_choice(at, from);
    };
    const auto left = [&](const PathVertex& last, const PathVertex& before) {
      if (end.is_beam && last.vertices == 2) return;  // estimated separately (unscattered_beams.h)
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
      connect_to_sensors(vertex);
      if (vertex.vertices < last_kept) vertices_.offer(vertex, random_);
    };
    LightTally tally(film_.energy);
    walk(transport_, space_, light_choice(), start, first, transport_.strategies.short_light,
         random_, counts_, tree_, tally, collided, left);
    tally.end_path();
  }

  /// Returns the stratum, in (0, 1), by which a sensor path selects its pixel. If each pixel has
  /// the same number of paths in a batch, the first random numbers of the path are stratified too,
  /// over all batches.
  double stratum_of(int path, int paths) {
    const int pixels = sensor().pixels().count();
    const auto points_of = [&](int number) {
      return ScrambledSobol(random_.seed(), (static_cast<std::uint64_t>(at_) << 32) + number);
    };
    if (paths % pixels != 0) {
      const bool is_kept = transport_.keeps_pixels && paths < pixels;
      return (path + (is_kept ? points_of(path).point(0)[0] : random_.uniform())) / paths;
    }
    const int each = paths / pixels, pixel = path / each;
    random_.lead(points_of(pixel).point(random_.batch() * each + path % each));
    return (pixel + 0.5) / pixels;
  }

  void walk_from_sensor(int path, int paths) {
    if (transport_.strategies.short_sensor && sensor().can_be_hit())
      return;  // a short sensor path would end at its endpoint, the sensor
    const double stratum = stratum_of(path, paths);
    const EndPosition end = sensor().sample_position(space_, random_, stratum);
    const PathVertex start = end_vertex(transport_.strategies, end);
    const EndDirection first = sensor().sample_direction(end, random_, stratum);
    pixel_ = first.pixel;
    const auto choice = [&](const EndPosition& at, const PathPoint& from) {
      return sensor_choice(at, from);
    };
    const auto left = [&](const PathVertex& last, const PathVertex& before) {
      arrive(transport_.lights, light_choice(), last, before, transport_.strategies.most_light(),
             [&](const EndHit&) { return pixel_; });
    };
    const double last_kept = sample_last_kept();
    const auto collided = [&](const PathVertex& vertex) {
      connect_to_light(vertex);
      if (vertex.vertices < last_kept) connect_to_light_path(vertex);
    };
    UnsplitPath alone;
    const NoTally tally;
    walk(transport_, space_, choice, start, first, transport_.strategies.short_sensor, random_,
         counts_, alone, tally, collided, left);
  }

  /// Probability that a connection from this point to the current sensor is considered. It is a
  /// factor of the density of the strategy, like EndPosition::choice.
  double considered_probability(const PathPoint& from) const {
    if constexpr (Tree::is_split())
      return transport_.depth->connection_probability(from) *
             transport_.depth->fraction_of_connections(at_);
    return 1;
  }
  double sensor_choice(const EndPosition& end, const PathPoint& from) const {
    return sensor().choice(end, from.x) * considered_probability(from);
  }

  auto light_choice() const {
    return [this](const EndPosition& at, const PathPoint&) { return transport_.light_choice(at); };
  }

  /// Samples how many of a path's first vertices are kept for connections to the other path: those
  /// whose PathVertex::vertices is below the returned number.
  double sample_last_kept() {
    const double kept = transport_.strategies.kept;
    return kept < 1 ? 2 + std::log(random_.uniform()) / std::log(kept) : Strategies::unlimited;
  }

  /// Adds the contributions of a path from one end (light or sensor) that reaches the boundary at
  /// points where endpoints of the other end lie.
  template <class End, class Choice, class Pixel>
  void arrive(const End& ends, const Choice& choice, const PathVertex& last,
              const PathVertex& before, int more, const Pixel& pixel) {
    ends.hit(space_, last.point.x, last.arrived, [&](const EndHit& hit) {
      PathVertex here = last;
      here.density *= std::abs(hit.position.inward.dot(last.arrived));
      here.first_of_other *= heuristic(choice(hit.position, before.point));
      const double others = competing_with_hit(
          transport_.strategies, here, hit.position.position_density, hit.direction.density, more);
      const double value = here.weight * hit.value / (1 + others);
      expected_[at_].hits += value;
      add(pixel(hit), value, here.optical_path);
    });
  }

  void connect_to_sensors(const PathVertex& y) {
    if constexpr (Tree::is_split()) {
      const double draw = random_.uniform();
      if (draw >= transport_.depth->most_connections()) return;
      const double probability = transport_.depth->connection_probability(y.point);
      for_each_sensor([&] {
        const double considered = probability * transport_.depth->fraction_of_connections(at_);
        if (draw < considered) connect_to_sensor(y, considered);
      });
    } else {
      for_each_sensor([&] { connect_to_sensor(y, 1); });
    }
  }
  void connect_to_sensor(const PathVertex& y, double considered) {
    EndPosition end = sensor().choose_position(space_, y.point.x, random_);
    end.choice *= considered;
    const PathVertex z = end_vertex(transport_.strategies, end);
    connect_to_endpoint(y, z);
  }
  void connect_to_light(const PathVertex& z) {
    const EndPosition end = transport_.lights.sample_position(space_, random_);
    if (end.is_beam) return connect_to_beam(end, z);
    if (transport_.light_choice(end) == 0) return;
    const PathVertex y = end_vertex(transport_.strategies, end);
    connect_to_endpoint(y, z);
  }

  /// Connects a vertex of the sensor path to a beam along the simplest connection
  /// (beam_connection.h).
  void connect_to_beam(const EndPosition& end, const PathVertex& z) {
    if (!transport_.strategies.connects_beams || z.vertices - 1 > transport_.max_scatterings)
      return;
    const StageLights::Beam beam = transport_.lights.beam_of(end);
    const double probability =
        connection_probability(expected_contribution(beam, end, z), transport_.beam_levels[at_]);
    if (!(probability > 0)) return;
    const auto connection =
        space_.simplest_connection_to_beam(z.point, beam.light(), random_, counts_.connections);
    if (!connection || !beam.disk.contains(connection->place)) return;
    const ConnectedPath path =
        connected_to_beam(transport_, end, *connection, z,
                          leaving(transport_, sensor(), z, connection->start_direction));
    const double value = path.value * path.weight * connection->transmittance / probability;
    expected_[at_].beams += value;
    add(pixel_, value, connection->optical_path + z.optical_path);
  }
  /// Returns the expected contribution of a connection to a beam, computed for the straight line.
  /// If rays are bent, a lower bound is applied as in facing().
  double expected_contribution(const StageLights::Beam& beam, const EndPosition& end,
                               const PathVertex& z) {
    ++counts_.connections_weighed;
    const ParallelLight light = beam.light();
    const auto place = straight_place(light, z.point.x);
    if (!place) return 0;
    double density = beam.disk.contains(*place) ? beam.disk.density(*place) : 0;
    if (space_.has_curves() || space_.connects_through())
      density = std::max(density, elsewhere * beam.disk.density(light.x));
    if (!(density > 0)) return 0;
    const double depth = space_.least_depth(z.point, {*place, z.point.part});
    const ConnectedPath path =
        connected_to_beam(transport_, end, density, z, facing(sensor(), z, -light.direction),
                          {.start_direction = light.direction,
                           .end_direction = light.direction,
                           .spreading = 1,
                           .optical_depth = depth});
    return path.value * path.weight * std::exp(-depth);
  }
  void connect_to_endpoint(const PathVertex& y, const PathVertex& z) {
    if (can_connect(y, z)) connect(y, z, expected_contribution(y, z));
  }

  /// Connects a vertex of the sensor path to one of the kept vertices of the light path, drawn in
  /// proportion to its expected contribution. This connection represents the connections to all
  /// kept vertices.
  void connect_to_light_path(const PathVertex& z) {
    const std::span<const PathVertex> all = vertices_.kept();
    double sum = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      of_each_[i] = can_connect(all[i], z) ? expected_contribution(all[i], z) / all[i].kept : 0;
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
    connect(y, z, stands_for * sum);
  }

  bool can_connect(const PathVertex& y, const PathVertex& z) const {
    return space_.can_connect(y.point, z.point) && !(y.end && y.end->is_beam) &&
           y.vertices + z.vertices - 2 <= transport_.max_scatterings;
  }

  /// Returns the expected contribution of a connection, computed for the straight line.
  double expected_contribution(const PathVertex& y, const PathVertex& z) {
    ++counts_.connections_weighed;
    const Vec3 chord = z.point.x - y.point.x;
    const double length = chord.norm();
    const double depth = space_.least_depth(y.point, z.point);
    const Vec3 direction = chord / length;
    const TestConnection line{.start_direction = direction,
                              .end_direction = direction,
                              .spreading = length * length,
                              .optical_depth = depth};
    const ConnectedPath path =
        connected_path(transport_.strategies, y, facing(transport_.lights, y, direction), z,
                       facing(sensor(), z, -direction), line);
    return path.value * path.weight * std::exp(-depth);
  }

  /// Returns leaving() along the straight line. If rays are curved or refracted, the true
  /// connection may leave in another direction. The strength is therefore raised to at least the
  /// fraction `elsewhere` of the strength in a sampled direction.
  template <class End>
  EndDirection facing(const End& ends, const PathVertex& vertex, const Vec3& direction) {
    EndDirection to = leaving(transport_, ends, vertex, direction);
    if (space_.has_curves() || space_.connects_through()) {
      if (vertex.end)
        to.strength =
            std::max(to.strength, elsewhere * ends.sample_direction(*vertex.end, random_).strength);
      else
        to.strength = std::max(to.strength, elsewhere / (4 * std::numbers::pi));
    }
    return to;
  }

  void connect(const PathVertex& y, const PathVertex& z, double expected) {
    expected_[at_].considered += expected;
    const double level = transport_.connection_levels[at_];
    if (const double probability = connection_probability(expected, level); probability > 0) {
      if (probability < 1) expected_[at_].made += expected / probability;
      add_connected(y, z, space_.connect(y.point, z.point, random_, counts_.connections),
                    probability);
    }
    if (!space_.connects_through()) return;
    if (const double probability = connection_probability(expected, search_cost() * level);
        probability > 0)
      add_connected(y, z, space_.connect_through(y.point, z.point, random_, counts_.connections),
                    probability);
  }

  /// Applies Russian roulette with threshold `level` to a connection of this expected contribution.
  /// Returns the probability with which the connection is made, or 0 if it is skipped.
  double connection_probability(double expected, double level) {
    const double probability = std::min(1.0, expected / level);
    if (!(probability > 0) || random_.uniform() >= probability) return 0;
    ++counts_.connections_made;
    return probability;
  }

  void add_connected(const PathVertex& y, const PathVertex& z,
                     const std::optional<TestConnection>& curve, double probability) {
    if (!curve) return;
    const EndDirection from_y = leaving(transport_, transport_.lights, y, curve->start_direction);
    const EndDirection from_z = leaving(transport_, sensor(), z, -curve->end_direction);
    const ConnectedPath path = connected_path(transport_.strategies, y, from_y, z, from_z, *curve);
    const double value =
        path.value * path.weight * curve->transmittance * curve->multiplicity / probability;
    if (probability < 1) {
      expected_[at_].contributed += value;
      expected_[at_].square += value * value;
    }
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
  Tree tree_;
  LightVertices vertices_;  ///< vertices of the light path that are kept for connections
  std::array<double, LightVertices::capacity> of_each_{};
  /// Expected and actual contributions of the current paths, by sensor.
  ExpectedConnections expected_;
  std::size_t at_ = 0;  ///< number of the current sensor
  int pixel_ = -1;      ///< pixel of the current sensor path
};

}  // namespace flatspeckle::grin
