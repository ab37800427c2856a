#include "wave_solver/maps/field_map.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

#include "core/numbers/complex.h"
#include "core/numbers/hankel_array.h"
#include "core/result/result_group.h"
#include "core/run/interrupt.h"
#include "core/run/parallel.h"
#include "core/run/progress.h"
#include "core/run/stopwatch.h"
#include "wave_solver/dense/blas.h"
#include "wave_solver/equations/rim_waves.h"
#include "wave_solver/solutions/wave_solution.h"
#include "wave_solver/sums/fast_product.h"
#include "wave_solver/sums/helmholtz_sum.h"

namespace flatspeckle::wave {

namespace {

// Pixels first .. last - 1 along one axis, whose centres may lie within `distance` of the
// coordinate `place`.
struct PixelRange {
  PixelRange(double low, double step, double place, double distance, std::size_t from,
             std::size_t count) {
    const auto limit = [&](double at) {
      return static_cast<std::size_t>(
          std::clamp(at, static_cast<double>(from), static_cast<double>(from + count)));
    };
    const double middle = (place - low) / step - 0.5, reach = distance / step;
    first = limit(std::floor(middle - reach));
    last = limit(std::ceil(middle + reach) + 1);
  }
  std::size_t first, last;
};

std::size_t whole_chunks(std::size_t wanted, std::size_t most) {
  return std::min(std::max<std::size_t>(wanted / map_chunk, 1) * map_chunk, most);
}

}  // namespace

std::vector<MapTile> tiles(const MapGrid& grid, std::size_t pixels) {
  const std::size_t nx = whole_chunks(pixels / map_chunk, grid.nx);
  const std::size_t nz = whole_chunks(pixels / nx, grid.nz);
  std::vector<MapTile> all;
  for (std::size_t iz = 0; iz < grid.nz; iz += nz)
    for (std::size_t ix = 0; ix < grid.nx; ix += nx)
      all.push_back({ix, iz, std::min(nx, grid.nx - ix), std::min(nz, grid.nz - iz)});
  return all;
}

std::vector<std::uint32_t> ring_of_pixels(const MapGrid& grid, const MapTile& tile, Vec centre,
                                          double low, double high) {
  const PixelRange across(grid.low.x, grid.step().x, centre.x, high, tile.ix, tile.nx);
  const PixelRange along(grid.low.z, grid.step().z, centre.z, high, tile.iz, tile.nz);
  std::vector<std::uint32_t> found;
  for (std::size_t iz = along.first; iz < along.last; ++iz)
    for (std::size_t ix = across.first; ix < across.last; ++ix) {
      const double r = length(grid.pixel(ix, iz) - centre);
      if (low <= r && r < high)
        found.push_back(static_cast<std::uint32_t>((iz - tile.iz) * tile.nx + ix - tile.ix));
    }
  return found;
}

const DatasetTable map_table{
    .name = "map",
    .rows = {{"map_z", Data::scale, "", "length", "depth of the pixels"},
             {"map_x", Data::scale, "", "length", "transverse position of the pixels"},
             {"total_field", Data::complex, "LIGHT map_z map_x", "1",
              "total field, also inside disks; 0 in soft and hard disks; at a point "
              "scatterer the field that excites it"}},
    .attributes = {{"total_field", "wavelength", "float64",
                    "wavelength in the medium around the scatterers"}}};

namespace {

std::vector<double> pixel_centres(const MapGrid& grid, std::size_t count, bool along_z) {
  std::vector<double> centres;
  for (std::size_t i = 0; i < count; ++i)
    centres.push_back(along_z ? grid.pixel(0, i).z : grid.pixel(i, 0).x);
  return centres;
}

}  // namespace

MappedSolution mapped(const WaveSolution& solution) {
  MappedSolution result{&solution.system(), {}, {}};
  for (const double angle : solution.light_angles())
    result.lights.push_back({{direction(angle), 1, {}}});
  if (!result.lights.empty())
    result.coefficients = {solution.coefficients(0).data(),
                           result.lights.size() * solution.system().unknowns()};
  return result;
}

std::string write_map(ResultFile& file, const MappedSolution& solution, const MapGrid& grid,
                      double tolerance) {
  FieldMap map(solution, grid, tolerance);
  write_tiles(file, grid, solution.system->k(), solution.lights.size(), map.tiles(),
              [&](const MapTile& tile) { return map.field(tile); });
  return map.method();
}

void write_tiles(ResultFile& file, const MapGrid& grid, double k, std::size_t lights,
                 const std::vector<MapTile>& tiles,
                 const std::function<std::vector<Complex>(const MapTile&)>& field) {
  const ResultGroup root(file, map_table);
  root.put("map_z", pixel_centres(grid, grid.nz, true));
  root.put("map_x", pixel_centres(grid, grid.nx, false));
  root.begin("total_field", {1, map_chunk, map_chunk});
  root.attribute("total_field", "wavelength", 2 * std::numbers::pi / k);
  const double all = static_cast<double>(grid.nx) * static_cast<double>(grid.nz);
  Progress progress("map", "pixels");
  const Stopwatch clock;
  Progress::Figures figures;
  for (const MapTile& tile : tiles) {
    file.write_block("total_field", field(tile), {0, tile.iz, tile.ix}, {lights, tile.nz, tile.nx});
    stop_if_interrupted();
    const double wall = clock.seconds();
    figures.samples += static_cast<double>(tile.pixels());
    figures.rate = figures.samples / wall;
    figures.seconds_left = (all - figures.samples) / figures.rate;
    progress.update(wall, figures);
  }
  progress.finish(clock.seconds(), figures);
}

namespace {

// Adds to field[light][point] `factor` times the sum over all columns of values[column][point]
// x[light][column].
void add_columns(std::span<const Complex> values, std::size_t points, const Complex* x,
                 std::size_t ldx, double factor, std::span<Complex> field) {
  if (points == 0 || values.empty()) return;
  multiply(CblasNoTrans, CblasNoTrans, points, field.size() / points, values.size() / points,
           factor, values.data(), points, x, ldx, 1, field.data(), points);
}

const Complex* coefficients(const MappedSolution& solution, std::size_t scatterer) {
  return solution.coefficients.data() + solution.system->first(scatterer);
}

// Returns the cost of one ring of a RingField in seconds, as measured: its point sources in the
// HelmholtzSum, plus corrections at the points near it.
double ring_cost(double ring_points, double modes, double near_points) {
  return 2e-6 * ring_points + near_points * (15e-9 * ring_points + 15e-9 * modes + 100e-9);
}

/// Adds the scattered field of one scatterer at points outside it to field, [light][point].
void add_scattered(const MappedSolution& solution, std::size_t scatterer,
                   std::span<const Vec> points, std::span<Complex> field) {
  const TMatrixSystem& system = *solution.system;
  const ModeSet modes = system.modes(scatterer);
  std::vector<Complex> values(points.size() * modes.modes.size());
  field_at(system.k(), points, modes, {values.data(), points.size()});
  add_columns(values, points.size(), coefficients(solution, scatterer), system.unknowns(), 1,
              field);
}

constexpr std::uint32_t no_place = ~std::uint32_t{0};
// Number of points whose waves from one scatterer fit into the cache.
constexpr std::size_t points_at_a_time = 256;

using Pixels = std::vector<std::uint32_t>;

std::vector<Vec> positions(const MapGrid& grid, const MapTile& tile, const Pixels& pixels) {
  std::vector<Vec> result;
  for (const std::uint32_t pixel : pixels)
    result.push_back(grid.pixel(tile.ix + pixel % tile.nx, tile.iz + pixel / tile.nx));
  return result;
}

}  // namespace

/// Computes the scattered field of a solution at many points. Each scatterer is replaced by a ring,
/// that is point sources on a circle (MultipoleRing), whose fields a HelmholtzSum adds up. The
/// field of a ring is accurate beyond a distance from the scatterer's centre, the clearance; at
/// nearer points the field is corrected point by point.
class RingField {
 public:
  /// tolerance: relative error of the field, at least 1e-12. area_per_point: area per point at
  /// which the field will be computed; the clearances are chosen from it.
  RingField(const MappedSolution& solution, double tolerance, double area_per_point)
      : solution_(solution), tolerance_(tolerance) {
    blas_single_thread();
    std::vector<std::size_t> examples;
    find_kinds(examples);
    std::vector<std::optional<ClearedRing>> made(examples.size());
    parallel_for(examples.size(), [&](std::size_t kind) {
      made[kind] = best_ring(examples[kind], area_per_point);
      made[kind]->ring.charge(solution.system->modes(examples[kind]), solution.system->k());
    });
    for (auto& ring : made) {
      largest_charge_ = std::max(largest_charge_, ring->ring.largest_charge);
      rings_.push_back(std::move(*ring));
    }
    place_rings();
  }

  /// Whether the charges on the rings are small enough for rounding errors to stay below the
  /// tolerance.
  bool resolved() const { return largest_charge_ * smallest_tolerance < tolerance_; }
  double clearance(std::size_t scatterer) const { return ring(scatterer).clearance; }
  std::size_t sources() const { return positions_.size(); }

  /// Returns the field of all rings, [light][point], or nullopt if there are so few points that a
  /// direct sum over all pairs is faster.
  std::optional<std::vector<Complex>> sum(std::span<const Vec> points) const {
    const double finer = std::max(tolerance_ / largest_charge_, smallest_tolerance);
    const HelmholtzSum sum(solution_.system->k(), positions_, points, finer);
    if (sum.range() == 0) return std::nullopt;
    return sum(charges_);
  }

  /// Returns the field of a scatterer's own waves minus that of its ring: [light][point].
  std::vector<Complex> correction(std::size_t scatterer, std::span<const Vec> points) const {
    std::vector<Complex> field(solution_.lights.size() * points.size());
    add_scattered(solution_, scatterer, points, field);
    std::vector<double> distances;
    const std::size_t first = first_[scatterer], count = ring(scatterer).ring.points;
    for (std::size_t s = first; s < first + count; ++s)
      for (const Vec point : points)
        distances.push_back(solution_.system->k() * length(point - positions_[s]));
    std::vector<Complex> waves(distances.size());
    std::vector<std::size_t> coincident;
    for (std::size_t i = 0; i < distances.size(); ++i)
      if (distances[i] == 0) coincident.push_back(i);
    for (const std::size_t i : coincident) distances[i] = 1;
    hankel0(distances, waves);
    // HelmholtzSum also omits pairs at distance 0.
    for (const std::size_t i : coincident) waves[i] = 0;
    add_columns(waves, points.size(), &charges_[first], positions_.size(), -1, field);
    return field;
  }

 private:
  static constexpr double smallest_tolerance = 1e-14;
  struct ClearedRing {
    MultipoleRing ring;
    double clearance;
  };
  const ClearedRing& ring(std::size_t scatterer) const { return rings_[kind_[scatterer]]; }
  // Equal scatterers with equal basis order share a ring.
  void find_kinds(std::vector<std::size_t>& examples) {
    const TMatrixSystem& system = *solution_.system;
    const Placement& placement = system.placement();
    for (std::size_t j = 0; j < placement.size(); ++j) {
      const auto known = std::find_if(examples.begin(), examples.end(), [&](std::size_t example) {
        return placement[example].scatterer == placement[j].scatterer &&
               system.order(example) == system.order(j);
      });
      kind_.push_back(static_cast<std::uint32_t>(known - examples.begin()));
      if (known == examples.end()) examples.push_back(j);
    }
  }

  ClearedRing best_ring(std::size_t scatterer, double area_per_point) const {
    const TMatrixSystem& system = *solution_.system;
    const ModeSet modes = system.modes(scatterer);
    const double radius = system.placement()[scatterer].scatterer.disk_radius();
    if (modes.order == 0) return {MultipoleRing(modes, system.k(), radius, radius, tolerance_), 0};
    std::optional<ClearedRing> best;
    double least = std::numeric_limits<double>::infinity();
    for (const double factor : {1.25, 1.5, 2.0, 3.0, 5.0, 8.0}) {
      const double clearance = factor * radius;
      MultipoleRing ring(modes, system.k(), radius, clearance, 0.1 * tolerance_);
      const double near = std::numbers::pi * (clearance - radius) * (clearance + radius);
      const double seconds =
          ring_cost(static_cast<double>(ring.points), static_cast<double>(modes.modes.size()),
                    near / area_per_point);
      if (seconds >= least) continue;
      least = seconds;
      best = {std::move(ring), clearance};
    }
    return *best;
  }

  void place_rings() {
    const TMatrixSystem& system = *solution_.system;
    const Placement& placement = system.placement();
    for (std::size_t j = 0; j < placement.size(); ++j) {
      first_.push_back(positions_.size());
      for (std::size_t s = 0; s < ring(j).ring.points; ++s)
        positions_.push_back(placement[j].position + ring(j).ring.position(s));
    }
    const std::size_t lights = solution_.lights.size();
    charges_.resize(lights * positions_.size());
    for (std::size_t j = 0; j < placement.size(); ++j) {
      const MultipoleRing& own = ring(j).ring;
      multiply(CblasNoTrans, CblasNoTrans, own.points, lights, system.modes(j).modes.size(), 1,
               own.charges.data(), own.points, coefficients(solution_, j), system.unknowns(), 0,
               &charges_[first_[j]], positions_.size());
    }
  }

  const MappedSolution& solution_;
  double tolerance_, largest_charge_ = 1;
  std::vector<std::uint32_t> kind_;
  std::vector<ClearedRing> rings_;
  std::vector<std::size_t> first_;  // index of the first source of each scatterer's ring
  std::vector<Vec> positions_;
  std::vector<Complex> charges_;  // [light][position]
};

// The pixels of a tile: a list of the pixels inside each disk, and one list of the pixels outside
// all disks.
struct FieldMap::Points {
  std::vector<Pixels> inside;        // pixels inside each scatterer
  Pixels outside;                    // pixels outside all disks
  std::vector<std::uint32_t> place;  // index of each pixel in `outside`, or no_place
  std::vector<Vec> positions;        // positions of the pixels in `outside`
};

FieldMap::FieldMap(MappedSolution solution, const MapGrid& grid, double tolerance, Route route)
    : solution_(std::move(solution)), grid_(grid) {
  blas_single_thread();
  if (route == Route::direct || system().unknowns() == 0) return;
  auto rings = std::make_unique<RingField>(solution_, std::max(tolerance, 1e-12),
                                           grid.step().x * grid.step().z);
  if (rings->resolved()) rings_ = std::move(rings);
}

FieldMap::~FieldMap() = default;

// Tiles are large, because a RingField has, for each tile, a setup cost for all of its sources.
std::vector<MapTile> FieldMap::tiles() const {
  constexpr std::size_t most = std::size_t{1} << 19, values = std::size_t{1} << 22;
  return wave::tiles(grid_, std::min(most, values / solution_.lights.size()));
}

std::string FieldMap::method() const {
  std::ostringstream text;
  text << "map of " << grid_.nx << " x " << grid_.nz << " pixels in " << fast_tiles_ + direct_tiles_
       << " tiles, " << direct_tiles_ << " summed directly";
  if (fast_tiles_ > 0)
    text << ", " << fast_tiles_ << " by FFT over " << rings_->sources() << " sources";
  return text.str();
}

// Whether a scatterer is a disk in which the field is not the sum of incident and scattered waves.
bool FieldMap::is_solid(std::size_t scatterer) const {
  return system().placement()[scatterer].scatterer.is_disk() &&
         !is_transparent(system(), scatterer);
}

FieldMap::Points FieldMap::place(const MapTile& tile) const {
  const Placement& placement = system().placement();
  Points points;
  points.inside.resize(placement.size());
  parallel_for(placement.size(), [&](std::size_t j) {
    if (is_solid(j))
      points.inside[j] =
          ring_of_pixels(grid_, tile, placement[j].position, 0, placement[j].scatterer.radius);
  });
  std::vector<bool> covered(tile.pixels());
  for (const Pixels& inside : points.inside)
    for (const std::uint32_t pixel : inside) covered[pixel] = true;
  points.place.assign(tile.pixels(), no_place);
  for (std::uint32_t pixel = 0; pixel < tile.pixels(); ++pixel) {
    if (covered[pixel]) continue;
    points.place[pixel] = static_cast<std::uint32_t>(points.outside.size());
    points.outside.push_back(pixel);
  }
  points.positions = positions(grid_, tile, points.outside);
  const double close = on_a_point * 2 * std::numbers::pi / system().k();
  for (const auto& [position, scatterer] : placement)
    if (!scatterer.is_disk())
      for (const std::uint32_t pixel : ring_of_pixels(grid_, tile, position, 0, close))
        if (!covered[pixel]) points.positions[points.place[pixel]] = position;
  return points;
}

std::vector<Complex> FieldMap::field(const MapTile& tile) {
  const Points points = place(tile);
  auto beyond = outside(tile, points);
  add_incident(points, beyond);
  const std::size_t lights = solution_.lights.size(), count = points.outside.size();
  std::vector<Complex> field(lights * tile.pixels());
  for (std::size_t light = 0; light < lights; ++light)
    for (std::size_t i = 0; i < count; ++i)
      field[light * tile.pixels() + points.outside[i]] = beyond[light * count + i];
  fill_inside(tile, points, field);
  return field;
}

// Returns the scattered field outside disks, [light][point].
std::vector<Complex> FieldMap::outside(const MapTile& tile, const Points& points) {
  if (rings_) {
    if (auto field = rings_->sum(points.positions)) {
      ++fast_tiles_;
      correct_near(tile, points, *field);
      return std::move(*field);
    }
  }
  ++direct_tiles_;
  return direct(points.positions);
}

std::vector<Complex> FieldMap::direct(const std::vector<Vec>& points) const {
  const std::size_t lights = solution_.lights.size();
  std::vector<Complex> field(lights * points.size());
  parallel_for((points.size() + points_at_a_time - 1) / points_at_a_time, [&](std::size_t part) {
    const std::size_t first = part * points_at_a_time,
                      count = std::min(points_at_a_time, points.size() - first);
    std::vector<Complex> sum(lights * count);
    for (std::size_t j = 0; j < system().placement().size(); ++j)
      add_scattered(solution_, j, std::span(points).subspan(first, count), sum);
    for (std::size_t light = 0; light < lights; ++light)
      std::copy_n(&sum[light * count], count, &field[light * points.size() + first]);
  });
  return field;
}

void FieldMap::correct_near(const MapTile& tile, const Points& points,
                            std::vector<Complex>& field) const {
  const Placement& placement = system().placement();
  std::vector<Pixels> near(placement.size());
  std::vector<std::vector<Complex>> corrections(placement.size());
  parallel_for(placement.size(), [&](std::size_t j) {
    const auto& [centre, scatterer] = placement[j];
    const auto ring =
        ring_of_pixels(grid_, tile, centre, scatterer.disk_radius(), rings_->clearance(j));
    std::copy_if(ring.begin(), ring.end(), std::back_inserter(near[j]),
                 [&](std::uint32_t pixel) { return points.place[pixel] != no_place; });
    if (!near[j].empty()) corrections[j] = rings_->correction(j, positions(grid_, tile, near[j]));
  });
  const std::size_t lights = solution_.lights.size(), count = points.outside.size();
  for (std::size_t j = 0; j < placement.size(); ++j)
    for (std::size_t light = 0; light < lights; ++light)
      for (std::size_t i = 0; i < near[j].size(); ++i)
        field[light * count + points.place[near[j][i]]] +=
            corrections[j][light * near[j].size() + i];
}

void FieldMap::add_incident(const Points& points, std::vector<Complex>& field) const {
  const std::size_t count = points.outside.size();
  parallel_for(solution_.lights.size(), [&](std::size_t light) {
    for (const auto& [w, amplitude, origin] : solution_.lights[light]) {
      const Complex x = Complex(0, system().k()) * w.x, z = Complex(0, system().k()) * w.z;
      for (std::size_t i = 0; i < count; ++i) {
        const Vec r = points.positions[i] - origin;
        field[light * count + i] += amplitude * std::exp(x * r.x + z * r.z);
      }
    }
  });
}

void FieldMap::fill_inside(const MapTile& tile, const Points& points,
                           std::vector<Complex>& field) const {
  parallel_for(points.inside.size(), [&](std::size_t j) {
    const Pixels& pixels = points.inside[j];
    if (pixels.empty() || !system().placement()[j].scatterer.is_penetrable()) return;
    const std::size_t modes = system().modes(j).modes.size();
    std::vector<Complex> waves(pixels.size() * modes);
    field_inside(system(), j, positions(grid_, tile, pixels), {waves.data(), pixels.size()});
    for (std::size_t light = 0; light < solution_.lights.size(); ++light) {
      const Complex* const beta = coefficients(solution_, j) + light * system().unknowns();
      for (std::size_t n = 0; n < modes; ++n)
        for (std::size_t i = 0; i < pixels.size(); ++i)
          field[light * tile.pixels() + pixels[i]] +=
              product(beta[n], waves[n * pixels.size() + i]);
    }
  });
}

std::vector<Vec> map_sensors(const MapGrid& grid, const Placement& placement) {
  std::vector<Vec> sensors;
  for (const auto& [centre, scatterer] : placement) {
    if (!scatterer.is_disk()) continue;
    const Vec nearest{std::clamp(centre.x, grid.low.x, grid.high.x),
                      std::clamp(centre.z, grid.low.z, grid.high.z)};
    const bool touched = length(nearest - centre) <= scatterer.radius;
    sensors.push_back(touched ? centre + Vec{scatterer.radius, 0} : nearest);
  }
  return sensors;
}

}  // namespace flatspeckle::wave
