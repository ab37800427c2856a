#include <algorithm>
#include <iterator>
#include <memory>
#include <vector>

#include "core/result/hdf5_handle.h"
#include "grin/media/scattering/scattering_medium.h"
#include "grin/render/flights/space.h"
#include "grin/render/pictures/render_job.h"
#include "grin/trace/ray_tracing.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/targets.h"

// Grids of index and density with arbitrary numbers, and a few rays or free flights through those
// that load.

namespace flatspeckle::fuzz_grid {

namespace {

using namespace flatspeckle::grin;
using fuzz::Bytes;
using grin::Vec3;

const char* const path = "grid.h5";

void write_attribute(hid_t set, const char* name, Bytes& bytes) {
  const hsize_t three = 3;
  const Hdf5Handle space{H5Screate_simple(1, &three, nullptr), H5Sclose};
  const Hdf5Handle attribute{
      H5Acreate2(set, name, H5T_NATIVE_DOUBLE, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose};
  double values[3];
  for (double& value : values) value = bytes.take<double>();
  H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE, values);
}

/// Writes a grid whose samples repeat numbers from the input.
void write_grid(const char* name, Bytes& bytes) {
  const Hdf5Handle file{H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose};
  hsize_t nodes[3];
  std::size_t count = 1;
  for (hsize_t& n : nodes) count *= n = 1 + bytes.below(8);
  const Hdf5Handle space{H5Screate_simple(3, nodes, nullptr), H5Sclose};
  const Hdf5Handle set{H5Dcreate2(file.get(), name, H5T_NATIVE_DOUBLE, space.get(), H5P_DEFAULT,
                                  H5P_DEFAULT, H5P_DEFAULT),
                       H5Dclose};
  write_attribute(set.get(), "origin", bytes);
  write_attribute(set.get(), "spacing", bytes);
  std::vector<double> pattern(1 + bytes.below(64)), values(count);
  for (double& value : pattern) value = bytes.take<double>();
  for (std::size_t i = 0; i < count; ++i) values[i] = pattern[i % pattern.size()];
  H5Dwrite(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

/// Returns rays from the middle and from a corner of the grid.
std::vector<RayStart> starts_in(const grin::Box& box) {
  const Vec3 middle = box.low / 2 + box.high / 2;
  return {{middle, Vec3::UnitZ()}, {middle, Vec3(1, 2, -3).normalized()}, {box.low, Vec3::UnitX()}};
}

SceneField scene_of_grid() {
  IndexFieldValues values;
  values.field = {"grid"};
  values.of<GridValues>().grid = path;
  const Keyed<IndexFieldValues> keyed(values);
  return make_scene_field(keyed.keys, keyed.values, {1});
}

void trace_grid(const std::string& integrator) {
  const SceneField scene = scene_of_grid();
  const double length = 2 * scene.scale;  // only some cells, to limit the steps of a ray
  RayStopValues stop_spec;
  stop_spec.max_length = length;
  stop_spec.integrator = integrator;
  if (integrator == "leapfrog")
    stop_spec.step = length / 16;
  else
    stop_spec.tolerance = 1e-4;
  const Keyed<RayStopValues> keyed(stop_spec);
  const auto starts = starts_in(*scene.grid);
  const RayStops stops = make_ray_stops(keyed.keys, keyed.values, scene.scale, 0);
  for (const RayStart& start : starts) {
    const double n = index_at(scene, start.x);
    fuzz::require_finite(n);
    if (stop_spec.step && n < 1e-3) return;  // thousands of short steps
  }
  for (const TracedRay& ray : trace_rays(
           scene, {}, stops, make_ray_steps(keyed.keys, keyed.values, scene.scale), starts, 2)) {
    fuzz::require_finite(ray.end.x.sum() + ray.end.v.sum());
    fuzz::require_finite(ray.end.arc_length + ray.end.optical_path);
    for (const Vec3& x : ray.path) fuzz::require_finite(x.sum());
  }
}

/// Samples free flights and one connection in a scattering medium that fills the grid's box.
void fly_through_index(const std::string&) {
  const SceneField scene = scene_of_grid();
  const grin::Box box = *scene.grid;
  const double size = (box.high - box.low).norm(), step = scene.scale / 10;
  constexpr double most_steps = 400;
  if (size > most_steps * step) return;
  const grin::Stage stage{.boundary = box, .medium = {1 / size, 1 / size}};
  const auto space = grin::make_space(scene.field, stage, {step, 3 * size});
  RandomStream random(1, 0, 0);
  for (const RayStart& start : starts_in(box)) {
    if (!(space->index({start.x}) > 1e-3))
      continue;  // make_stage rejects an index that is not positive
    const grin::Flight flight = space->fly({start.x}, start.direction, random);
    if (flight.end == grin::Flight::End::lost) continue;
    fuzz::require_finite(flight.point.x.sum() + flight.direction.sum());
    fuzz::require_finite(flight.arc_length + flight.optical_path + flight.optical_depth);
    grin::ConnectionStatistics statistics;
    space->connect({start.x}, flight.point, random, statistics);
  }
}

/// Renders a few paths through the density, in a slightly larger stage.
void fly_through_density(const std::string&) {
  const auto density = std::make_shared<grin::DensityGrid>(grin::read_density_grid(path));
  const grin::FieldGrid& grid = density->grid();
  const grin::Box box{grid.origin - grid.spacing, grid.end() + grid.spacing};
  const double size = (box.high - box.low).norm();
  constexpr double depth = 10;
  const double mu = depth / size / std::max(density->largest(), 1.0);
  const grin::Stage stage{.boundary = box, .medium = {.mu_s = mu, .mu_a = mu, .density = density}};
  const grin::DirectionalDetector sensor{Vec3::UnitZ(), Vec3::UnitY(), 1.5, {2, 2}};
  const grin::RenderScene scene{.field = grin::Homogeneous{},
                                .step = size,
                                .max_length = 10 * size,
                                .stage = stage,
                                .lights = {grin::PointLight{(box.low + box.high) / 2}},
                                .sensors = {sensor}};
  const grin::RenderJob job = grin::render_job(scene, {.max_scatterings = 3}, 1);
  std::vector<Complex> sums(job.batches.size);
  job.batches.run(0, sums);
  for (const Complex& sum : sums) fuzz::require_finite(sum.real());
}

struct Use {
  const char *dataset, *what;
  void (*read)(const std::string&);
};
constexpr Use uses[] = {{"excess", "sharma", trace_grid},
                        {"excess", "leapfrog", trace_grid},
                        {"excess", "yoshida4", trace_grid},
                        {"density", "density", fly_through_density},
                        {"excess", "index", fly_through_index}};

}  // namespace

void use_input(const std::uint8_t* input, std::size_t size) {
  Bytes bytes(input, size);
  const auto& [dataset, what, read] = uses[bytes.below(std::size(uses))];
  write_grid(dataset, bytes);
  fuzz::taken(what, read);
}

}  // namespace flatspeckle::fuzz_grid
