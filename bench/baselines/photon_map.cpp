#include "bench/baselines/photon_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grin/render/methods/tracer.h"

namespace flatspeckle::bench {

using namespace grin;

GatherGrid::GatherGrid(std::vector<GatherPoint> points, double radius) : radius_(radius) {
  std::uint32_t buckets = 16;
  while (buckets < points.size()) buckets *= 2;
  first_.assign(buckets + 1, 0);
  const auto bucket_of = [&](const GatherPoint& point) {
    const Vec3 cell = (point.x / (2 * radius_)).array().floor();
    return bucket(cell.x(), cell.y(), cell.z());
  };
  for (const GatherPoint& point : points) ++first_[bucket_of(point) + 1];
  for (std::uint32_t b = 0; b < buckets; ++b) first_[b + 1] += first_[b];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  points_.resize(points.size());
  for (const GatherPoint& point : points) points_[next[bucket_of(point)]++] = point;
}

std::uint32_t GatherGrid::bucket(double i, double j, double k) const {
  const auto whole = [](double x) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(x));
  };
  std::uint64_t hash = whole(i) * 73856093u ^ whole(j) * 19349663u ^ whole(k) * 83492791u;
  hash ^= hash >> 17;
  return static_cast<std::uint32_t>(hash & (first_.size() - 2));
}

std::span<const std::uint32_t> GatherGrid::buckets_around(
    const Vec3& x, std::array<std::uint32_t, 8>& buckets) const {
  const Vec3 low = (x / (2 * radius_)).array() - 0.5;  // cells are as wide as the gather sphere
  const Vec3 cell = low.array().floor();
  int count = 0;
  for (int corner = 0; corner < 8; ++corner)
    buckets[count++] =
        bucket(cell.x() + (corner & 1), cell.y() + (corner >> 1 & 1), cell.z() + (corner >> 2));
  std::sort(buckets.begin(), buckets.end());
  return {buckets.begin(),
          std::unique(buckets.begin(), buckets.end())};  // cells may share a bucket
}

namespace {

/// Estimates the picture from one photon map, with equal numbers of sensor rays and light paths.
class PhotonMap {
 public:
  PhotonMap(const Transport& transport, const Space& space, double radius, RandomStream& random,
            Film& film)
      : transport_(transport), space_(space), radius_(radius), random_(random), film_(film) {}

  /// Adds the sums over `paths` sensor rays and light paths. Divided by `paths`, they give the
  /// picture.
  void add(int paths) {
    std::vector<GatherPoint> points;
    const double per_pair = 1 / (paths * 4.0 / 3.0 * std::numbers::pi * std::pow(radius_, 3));
    for (const SensorEnd& sensor : transport_.sensors)
      for (int path = 0; path < paths; ++path)
        trace_sensor_ray(sensor, (path + random_.uniform()) / paths, per_pair, points);
    const GatherGrid grid(std::move(points), radius_);
    for (int path = 0; path < paths; ++path) trace_light_path(grid);
  }

 private:
  Flight fly(const PathPoint& from, const Vec3& direction) {
    const Flight flight = space_.fly(from, direction, random_);
    counts_.add_flight(flight.end == Flight::End::lost);
    return flight;
  }

  double extinction(const PathPoint& p) const {
    const ScatteringMedium& medium = transport_.medium(p.part);
    return medium.mu_t() * (medium.density ? (*medium.density)(p.x) : 1);
  }

  void trace_sensor_ray(const SensorEnd& sensor, double stratum, double per_pair,
                        std::vector<GatherPoint>& points) {
    const EndPosition end = sensor.sample_position(space_, random_, stratum);
    const EndDirection first = sensor.sample_direction(end, random_, stratum);
    if (!(first.strength > 0)) return;
    const Flight flight = fly(end.point, first.direction);
    const double weight = first.strength / (end.position_density * first.density) * flight.weight;
    if (flight.end == Flight::End::boundary)
      transport_.lights.hit(space_, flight.point.x, flight.direction, [&](const EndHit& hit) {
        add(first.pixel, weight * hit.value, flight.optical_path);
      });
    if (flight.end != Flight::End::collision) return;
    const double n = space_.index(flight.point);
    const double albedo = transport_.medium(flight.point.part).albedo();
    points.push_back({flight.point.x, -flight.direction,
                      weight * albedo * per_pair / (extinction(flight.point) * n * n),
                      flight.optical_path, first.pixel, flight.point.part});
  }

  void trace_light_path(const GatherGrid& grid) {
    const EndPosition end = transport_.lights.sample_position(space_, random_);
    const EndDirection first = transport_.lights.sample_direction(end, random_);
    if (!(first.strength > 0)) return;
    double power = first.strength / (end.position_density * first.density), optical_path = 0;
    PathPoint at = end.point;
    Vec3 direction = first.direction;
    for (int collisions = 0;; ++collisions) {
      const Flight flight = fly(at, direction);
      power *= flight.weight;
      optical_path += flight.optical_path;
      if (flight.end != Flight::End::collision) {
        // Light from emitting faces is scored by the sensor rays.
        if (flight.end == Flight::End::boundary && collisions == 0 && (end.is_point || end.is_beam))
          score_unscattered(flight, power);
        return;
      }
      if (collisions == transport_.max_scatterings) return;
      const ScatteringMedium& medium = transport_.medium(flight.point.part);
      deposit_photon(grid, flight, medium.phase, power, optical_path);
      if (medium.mu_a > 0 && random_.uniform() >= medium.albedo()) return;
      at = flight.point;
      direction = medium.phase.sample(flight.direction, random_);
    }
  }

  void deposit_photon(const GatherGrid& grid, const Flight& photon, const SpacePhaseFunction& phase,
                      double power, double optical_path) {
    const double n = space_.index(photon.point);
    grid.near(photon.point.x, [&](const GatherPoint& z) {
      if (z.part == photon.point.part)
        add(z.pixel, z.value * power * phase.density(photon.direction.dot(z.to_sensor)),
            z.optical_path + optical_path + n * photon.direction.dot(z.x - photon.point.x));
    });
  }

  void score_unscattered(const Flight& flight, double power) {
    for (const SensorEnd& sensor : transport_.sensors)
      sensor.hit(space_, flight.point.x, flight.direction, [&](const EndHit& hit) {
        add(hit.direction.pixel, power * hit.value, flight.optical_path);
      });
  }

  void add(int pixel, double value, double optical_path) {
    deposit(film_, counts_, pixel, value, optical_path);
  }

  const Transport& transport_;
  const Space& space_;
  double radius_;
  RandomStream& random_;
  Film& film_;
  TransportCounts counts_;
};

/// Number of paths in one photon map; they share one phase of the sound.
constexpr int paths_per_phase = 256;

}  // namespace

BatchJob photon_map_job(const RenderScene& scene, double radius, std::uint64_t seed, int paths) {
  const std::shared_ptr<const Transport> transport =
      transport_of(scene, {}, RenderMethod::bidirectional);
  const int pixels = transport->pixels();
  const std::shared_ptr<const Space> space = make_space(
      scene.field, scene.stage, {scene.step, scene.max_length, Spreading::none, scene.leapfrogs});
  BatchJob job;
  job.size = static_cast<std::size_t>(pixels) * static_cast<std::size_t>(scene.bins.sums());
  job.samples_per_batch = paths;
  job.run = [=, bins = scene.bins, random_phase = scene.random_phase](std::uint64_t number,
                                                                      std::span<Complex> sums) {
    Film film(pixels, bins, sums);
    RandomStream random(seed, static_cast<std::uint64_t>(Stream::render), number);
    const auto add = [&](const Space& met, int count) {
      PhotonMap(*transport, met, radius, random, film).add(count);
    };
    if (!random_phase) return add(*space, paths);
    for (int done = 0; done < paths; done += paths_per_phase)
      add(*space->frozen(2 * std::numbers::pi * random.uniform()),
          std::min(paths_per_phase, paths - done));
  };
  return job;
}

}  // namespace flatspeckle::bench
