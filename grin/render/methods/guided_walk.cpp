#include "grin/render/methods/guided_walk.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>

#include "grin/media/scattering/free_flight.h"
#include "grin/rays/surfaces/interface.h"
#include "grin/render/transport/path_score.h"

namespace flatspeckle::grin {

namespace {

/// A light path, or a branch of it. Coordinates are those of LevelLayers, relative to the axis
/// through its start.
struct GuidedPath {
  Vec3 x, direction;
  double weight;
  int layer;
  double optical_path = 0;
  int scatterings = 0;
  bool can_turn =
      true;          ///< without sound, until it is farther from the axis than a side of the stage
  double moved = 0;  ///< momentum transfer, weighted by the diffusion of the parts
  MomentumTransfer transfer = {};
  std::complex<double> modulation = 0;  ///< by the sound (TaggingSound)
  PathScore score = {};
  DistanceImportance::Value importance{1, Vec3::Zero()};
};

/// Directional importance 1 + bias cos(angle from the gradient), to first order.
struct TurnBias {
  Vec3 towards;  ///< bias times the unit gradient
  double bias;

  TurnBias(const Vec3& log_gradient, const ScatteringMedium& medium) {
    // a higher bias favours directions that the surface then reflects, which splits paths at once
    constexpr double most = 0.65;
    const double steep = log_gradient.norm(),
                 loss = medium.mu_a + medium.mu_s * (1 - medium.phase.mean_cosine());
    bias = std::min(most, steep / loss);
    towards = steep > 0 ? Vec3(bias / steep * log_gradient) : Vec3::Zero();
  }
  double of(const Vec3& direction) const { return 1 + towards.dot(direction); }
};

/// Traces the paths of a batch.
class GuidedWalk {
 public:
  GuidedWalk(const PathGuide& guide, const Transport& transport, const Space& space, Film& film,
             TransportCounts& counts)
      : guide_(guide),
        layers_(guide.layers()),
        transport_(transport),
        space_(space),
        film_(film),
        counts_(counts) {}

  /// Traces a path and all its branches.
  void trace(RandomStream& random) {
    begin(random);
    while (!waiting_.empty()) {
      GuidedPath path = waiting_.back();
      waiting_.pop_back();
      while (advance(path, random) && is_kept(path, random)) {
      }
    }
    film_.energy += energy_;
    energy_ = {};
  }

 private:
  const LevelLayer& layer(int number) const { return layers_.layers()[number]; }

  void begin(RandomStream& random) {
    const EndPosition end = transport_.lights.sample_position(space_, random);
    const EndDirection first = transport_.lights.sample_direction(end, random);
    of_beam_ = end.is_beam;
    start_ = layers_.local(end.point.x);
    reach_ = layers_.distance_to_sides(start_);
    GuidedPath path{.x = {0, 0, start_[2]},
                    .direction = layers_.local(first.direction),
                    .weight = first.strength / (end.position_density * end.choice * first.density),
                    .can_turn = !film_.sound()};
    power_ = path.weight;
    const bool goes_up = path.direction[2] > 0;
    const auto& all = layers_.layers();
    path.layer = goes_up ? 0 : static_cast<int>(all.size()) - 1;
    while (goes_up ? path.layer + 1 < static_cast<int>(all.size()) &&
                         path.x[2] >= layer(path.layer).high
                   : path.layer > 0 && path.x[2] <= layer(path.layer).low)
      path.layer += goes_up ? 1 : -1;
    energy_.add(Termination::emitted, path.weight);
    if (!layers_.is_outermost(path.layer)) path.importance = importance_at(path);
    waiting_.push_back(path);
  }

  DistanceImportance::Value importance_at(const GuidedPath& path) const {
    return guide_.importance().at(path.x, guide_.importance().decays(path.moved));
  }

  /// Tallies what a change of weight takes from a path, in its layer.
  void reweigh(GuidedPath& path, double weight) {
    const LevelLayer& in = layer(path.layer);
    const Termination where = !(in.medium.mu_a > 0) ? Termination::scattered
                              : in.part == around   ? Termination::absorbed_stage
                                                    : Termination::absorbed_body;
    energy_.add(where, path.weight - weight);
    path.weight = weight;
  }
  static Termination termination_of(const GuidedPath& path) {
    return path.scatterings > 0 ? Termination::scattered : Termination::unscattered;
  }

  /// Returns where a path is in the coordinates of the stage.
  Vec3 place_of(const GuidedPath& path) const {
    return layers_.global(path.x + Vec3(start_[0], start_[1], 0));
  }
  void move(GuidedPath& path, double length) {
    const LevelLayer& in = layer(path.layer);
    if (const TaggingSound* const sound = film_.sound(); sound && in.part == sound->part)
      path.modulation += sound->flown(place_of(path), layers_.global(path.direction), length);
    path.x += length * path.direction;
    path.optical_path += (1 + in.excess) * length;
    path.score.flew(length);
    if (!(path.x.head<2>().squaredNorm() < reach_ * reach_)) path.can_turn = false;
  }

  /// Takes a path through a free flight to a collision or a plane; returns whether it goes on.
  bool advance(GuidedPath& path, RandomStream& random) {
    constexpr double most = 0.9;  // largest change of the rate of collisions
    counts_.add_flight(false);
    const LevelLayer& in = layer(path.layer);
    const double rise = path.direction[2], plane = rise > 0 ? in.high : in.low;
    double length =
        rise != 0 ? (plane - path.x[2]) / rise : std::numeric_limits<double>::infinity();
    double weight = 1;
    enum { collides, crosses, meets_side } what = crosses;
    double growth = 0;  // of the importance along the flight
    if (in.scatters()) {
      const double mu_t = in.medium.mu_t(), limit = most * mu_t;
      growth = std::clamp(path.importance.log_gradient.dot(path.direction), -limit, limit);
      const double flight = sample_free_flight(mu_t - growth, random.uniform());
      if (flight < length) {
        what = collides;
        length = flight;
        weight = in.medium.mu_s / (mu_t - growth);
      }
    }
    const Vec3 there = path.x + length * path.direction;
    int side = 0;
    if (!(there.head<2>().squaredNorm() < reach_ * reach_)) {
      path.can_turn = false;
      if (const auto [distance, axis] = side_ahead(path); distance < length) {
        what = meets_side;
        length = distance;
        weight = 1;
        side = axis;
      }
    }
    weight *= std::exp(in.scatters() ? -growth * length : -in.medium.mu_a * length);
    move(path, length);
    reweigh(path, weight * path.weight);
    if (what == meets_side) return meet_side(path, side, random);
    if (what == collides) return scatter(path, random);
    path.x[2] = plane;
    return cross(path, random);
  }

  struct Side {
    double distance;
    int axis;
  };
  /// Returns the distance along a path to the side of the stage, and the axis normal to that side.
  Side side_ahead(const GuidedPath& path) const {
    Side nearest{std::numeric_limits<double>::infinity(), 0};
    for (const int axis : {0, 1}) {
      const double along = path.direction[axis];
      if (along == 0) continue;
      const double wall = (along > 0 ? layers_.high() : layers_.low())[axis] - start_[axis];
      nearest = std::min(nearest, Side{std::max(0.0, (wall - path.x[axis]) / along), axis},
                         [](const Side& a, const Side& b) { return a.distance < b.distance; });
    }
    return nearest;
  }
  /// Reflects a path at a side of the stage, or ends it there.
  bool meet_side(GuidedPath& path, int axis, RandomStream& random) {
    const double outside = layer(0).excess;
    if (layer(path.layer).part == around ||
        !(random.uniform() < reflectance(path, axis, outside))) {
      energy_.add(termination_of(path), path.weight);
      return false;
    }
    path.direction[axis] = -path.direction[axis];
    return true;
  }
  double reflectance(const GuidedPath& path, int axis, double excess) const {
    const double own = layer(path.layer).excess;
    return own == excess
               ? 0
               : Interface((1 + own) * path.direction, Vec3::Unit(axis), own, excess).reflectance();
  }

  bool scatter(GuidedPath& path, RandomStream& random) {
    const LevelLayer& in = layer(path.layer);
    if (path.scatterings >= transport_.max_scatterings) {
      energy_.add(Termination::cut, path.weight);
      return false;
    }
    ++counts_.light_collisions;
    ++path.scatterings;
    path.importance = importance_at(path);
    const TurnBias bias(path.importance.log_gradient, in.medium);
    Vec3 direction;
    do direction = in.medium.phase.sample(path.direction, random);
    while (random.uniform() * (1 + bias.bias) >= bias.of(direction));
    const double mean = 1 + in.medium.phase.mean_cosine() * bias.towards.dot(path.direction);
    reweigh(path, path.weight * mean / bias.of(direction));
    if (film_.has_derivatives()) path.score.turned(in.medium, path.direction, direction);
    if (film_.has_decay()) {
      path.transfer.turned(in.part, path.direction, direction);
      path.moved += film_.decay().diffusion[static_cast<std::size_t>(in.part)] *
                    (direction - path.direction).squaredNorm() / 2;
    }
    if (const TaggingSound* const sound = film_.sound(); sound && in.part == sound->part)
      path.modulation +=
          sound->turned(place_of(path), layers_.global(path.direction), layers_.global(direction));
    path.direction = direction;
    return true;
  }

  /// Takes a path through the plane that it has reached. Where light leaves for certain on one
  /// side, that share of its weight leaves and the rest goes on; else one of them is chosen at
  /// random.
  bool cross(GuidedPath& path, RandomStream& random) {
    const int next = path.layer + (path.direction[2] > 0 ? 1 : -1);
    if (next < 0 || next >= static_cast<int>(layers_.layers().size())) {
      leave(path, path.weight, termination_of(path));
      return false;
    }
    const double excess = layer(next).excess, own = layer(path.layer).excess;
    const double reflected = reflectance(path, 2, excess);
    GuidedPath through = path;
    through.layer = next;
    if (own != excess && reflected < 1)
      through.direction = Interface((1 + own) * path.direction, Vec3::UnitZ(), own, excess)
                              .refracted()
                              ->normalized();
    path.direction[2] = -path.direction[2];
    if (layers_.is_outermost(next)) {
      if (reflected < 1) leave(through, (1 - reflected) * path.weight, termination_of(path));
      path.weight *= reflected;
    } else if (layers_.is_outermost(path.layer)) {
      if (reflected > 0) leave(path, reflected * path.weight, Termination::specular);
      through.weight *= 1 - reflected;
      path = through;
    } else if (!(random.uniform() < reflected)) {
      path = through;
    }
    if (!(path.weight > 0)) return false;
    path.importance = importance_at(path);
    return true;
  }

  /// Takes a path with this weight out of the stage, through the layer in which it is.
  void leave(GuidedPath path, double weight, Termination termination) {
    const LevelLayer& in = layer(path.layer);
    const bool is_last = path.direction[2] > 0;
    const double length = ((is_last ? in.high : in.low) - path.x[2]) / path.direction[2];
    path.weight = weight;
    move(path, std::max(0.0, length));
    reweigh(path, weight * std::exp(-in.medium.mu_a * length));
    energy_.add(termination, path.weight);
    if (of_beam_ && path.scatterings == 0 && !film_.sound()) return;
    if (path.can_turn)
      for (const PathGuide::Disk& disk : guide_.disks()) {
        if (disk.is_last == is_last) hit(disk, path);
      }
    else
      hit_unturned(path);
  }

  /// Adds the mean over all turns of a path about the axis to the rings of a sensor.
  void hit(const PathGuide::Disk& disk, const GuidedPath& path) {
    const double cosine = path.direction[2];
    if (1 - cosine * cosine > disk.sine_squared) return;
    const double r = std::hypot(path.x[0], path.x[1]),
                 distance = std::hypot(disk.x - start_[0], disk.y - start_[1]);
    const int rings = disk.rings.grid().count(),
              nearest = disk.rings.ring_at(std::abs(r - distance));
    if (nearest < 0) return;
    for (int ring = nearest; ring < rings && disk.rings.edge(ring) < r + distance; ++ring) {
      const RingTarget target{distance, disk.rings.edge(ring), disk.rings.edge(ring + 1),
                              disk.is_last};
      add(disk.first_pixel + ring, path, target.share(r) / disk.rings.area(ring));
    }
  }
  void hit_unturned(const GuidedPath& path) {
    const Vec3 x = place_of(path);
    for (const SensorEnd& sensor : transport_.sensors)
      sensor.hit(space_, x, layers_.global(path.direction),
                 [&](const EndHit& hit) { add(hit.direction.pixel, path, hit.value); });
  }
  void add(int pixel, const GuidedPath& path, double sensitivity) {
    const double value = path.weight * sensitivity;
    if (!(value > 0)) return;
    deposit(film_, counts_, pixel, value, path.optical_path, path.transfer);
    film_.add_hit(pixel, value);
    if (film_.sound()) film_.add_sidebands(pixel, value, path.modulation);
    if (film_.has_derivatives()) path.score.add_to(film_, pixel, value, transport_.stage.medium);
  }

  /// Applies the weight window; returns whether the path goes on.
  bool is_kept(GuidedPath& path, RandomStream& random) {
    constexpr double window = 2;
    const LevelLayer& in = layer(path.layer);
    if (!in.scatters()) return true;
    const auto& [value, log_gradient] = path.importance;
    const double expected =
        path.weight / power_ * value * TurnBias(log_gradient, in.medium).of(path.direction);
    if (expected < 1 / window) {
      reweigh(path, random.uniform() < expected ? path.weight / expected : 0);
      return path.weight > 0;
    }
    if (expected > window) {
      const double copies = std::min(std::round(expected), 64.0);
      path.weight /= copies;
      for (double i = 1; i < copies; ++i) waiting_.push_back(path);
    }
    return true;
  }

  const PathGuide& guide_;
  const LevelLayers& layers_;
  const Transport& transport_;
  const Space& space_;
  Film& film_;
  TransportCounts& counts_;
  std::vector<GuidedPath> waiting_;
  EnergyBalance energy_;
  Vec3 start_ = Vec3::Zero();  ///< start of the current path
  double reach_ = 0;           ///< distance from its axis to the sides of the stage
  double power_ = 0;
  bool of_beam_ = false;
};

/// Thickness of the layers in transport mean free paths; diffusion requires at least some.
double transport_depth(const LevelLayers& layers) {
  double depth = 0;
  for (const LevelLayer& layer : layers.layers())
    depth += (layer.high - layer.low) * layer.medium.mu_s * (1 - layer.medium.phase.mean_cosine());
  return depth;
}

/// Returns the axis of a light and a point on it; nullopt for other lights.
std::optional<ParallelLight> emission_axis(const Light& light) {
  if (const auto* beam = std::get_if<BeamLight>(&light))
    return ParallelLight{beam->centre, beam->direction};
  if (const auto* fibre = std::get_if<FibreLight>(&light))
    return ParallelLight{fibre->centre, fibre->direction};
  return std::nullopt;
}

}  // namespace

std::optional<PathGuide> PathGuide::of(const RenderScene& scene, double most_share) {
  const auto* const field = std::get_if<Homogeneous>(&scene.field);
  if (!field || scene.random_phase || !scene.parameters.empty() || scene.lights.size() != 1 ||
      scene.sensors.empty())
    return std::nullopt;
  const auto light = emission_axis(scene.lights[0]);
  if (!light) return std::nullopt;
  constexpr int coarse_cells = 48, importance_cells = 160;
  int axis;
  const double along = light->direction.normalized().cwiseAbs().maxCoeff(&axis);
  constexpr double rounding = 1e-12;
  if (along < 1 - rounding) return std::nullopt;
  auto layers = LevelLayers::of(scene.stage, axis, field->n_excess);
  if (!layers || transport_depth(*layers) < 1) return std::nullopt;

  const Vec3 start = layers->local(light->x);
  const double extent = layers->high()[2] - layers->low()[2],
               reach = layers->distance_to_sides(start);
  std::vector<Disk> disks;
  std::vector<RingTarget> targets;
  int first_pixel = 0;
  for (const Sensor& sensor : scene.sensors) {
    const auto* detector = std::get_if<RadialDetector>(&sensor);
    if (!detector) return std::nullopt;
    const Vec3 centre = layers->local(detector->centre);
    const bool is_last = centre[2] > (layers->low()[2] + layers->high()[2]) / 2;
    const double height = is_last ? layers->high()[2] : layers->low()[2],
                 distance = (centre - start).head<2>().norm(),
                 sine = std::sin(detector->acceptance);
    if (std::abs(centre[2] - height) > 1e-6 * extent || distance + detector->radius > reach)
      return std::nullopt;
    disks.push_back(
        {picture_of(*detector), centre[0], centre[1], sine * sine, first_pixel, is_last});
    const PixelRings& rings = disks.back().rings;
    first_pixel += rings.grid().count();
    if (detector->radii.empty())
      targets.push_back({distance, 0, detector->radius, is_last});
    else
      for (int ring = 0; ring < rings.grid().count(); ++ring)
        targets.push_back({distance, rings.edge(ring), rings.edge(ring + 1), is_last});
  }
  const bool goes_up = layers->local(light->direction)[2] > 0;
  const DistanceImportance coarse(*layers, targets, start, goes_up, nullptr, coarse_cells);
  if (coarse.least_share() * static_cast<double>(targets.size()) > most_share) return std::nullopt;
  DistanceImportance importance(*layers, targets, start, goes_up, scene.bins.decay.get(),
                                importance_cells);
  return PathGuide(std::move(*layers), std::move(disks), std::move(importance));
}

PathKernel guided_kernel(std::shared_ptr<const PathGuide> guide,
                         std::shared_ptr<const Transport> transport,
                         std::shared_ptr<const Space> space) {
  return [=](int paths, RandomStream& random, Film& film, TransportCounts& counts,
             ExpectedConnections*) {
    GuidedWalk walk(*guide, *transport, *space, film, counts);
    const std::uint64_t key[] = {random.bits(), random.bits()};
    for (int path = 0; path < paths; ++path) {
      RandomStream own(key[0], key[1], static_cast<std::uint64_t>(path));
      walk.trace(own);
    }
  };
}

}  // namespace flatspeckle::grin
