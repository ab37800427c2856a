#include <algorithm>
#include <vector>

#include "apps/index_field_options.h"
#include "apps/ray_tracing.h"
#include "core/hdf5_handle.h"
#include "tests/fuzz/input.h"

// Index grids of any numbers, and a few rays through those that load.

namespace {

using namespace flatspeckle;
using namespace flatspeckle::apps;
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

/// Samples: so many of the input's numbers, over and over.
void write_grid(Bytes& bytes) {
  const Hdf5Handle file{H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose};
  hsize_t nodes[3];
  std::size_t count = 1;
  for (hsize_t& n : nodes) count *= n = 1 + bytes.below(8);
  const Hdf5Handle space{H5Screate_simple(3, nodes, nullptr), H5Sclose};
  const Hdf5Handle set{H5Dcreate2(file.get(), "excess", H5T_NATIVE_DOUBLE, space.get(), H5P_DEFAULT,
                                  H5P_DEFAULT, H5P_DEFAULT),
                       H5Dclose};
  write_attribute(set.get(), "origin", bytes);
  write_attribute(set.get(), "spacing", bytes);
  std::vector<double> pattern(1 + bytes.below(64)), values(count);
  for (double& value : pattern) value = bytes.take<double>();
  for (std::size_t i = 0; i < count; ++i) values[i] = pattern[i % pattern.size()];
  H5Dwrite(set.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

/// From the middle of the grid and from a corner of it.
std::vector<RayStart> starts_in(const grin::Box& box) {
  const Vec3 middle = box.low / 2 + box.high / 2;
  return {{middle, Vec3::UnitZ()}, {middle, Vec3(1, 2, -3).normalized()}, {box.low, Vec3::UnitX()}};
}

void trace_grid(const std::string& integrator) {
  Subcommand command("trace", "");
  IndexFieldSpec spec;
  add_index_field_options(command.options(), spec);
  command.parse_config("field = [\"grid\"]\ngrid = \"grid.h5\"\n");
  const SceneField scene = make_index_field(command, spec, 1);
  const double length = 2 * scene.scale;  // some cells: how many steps a ray takes has a limit
  RayStopSpec stop_spec;
  stop_spec.max_length = length;
  stop_spec.integrator = integrator;
  if (integrator == "leapfrog")
    stop_spec.step = length / 16;
  else
    stop_spec.tolerance = 1e-4;
  const auto starts = starts_in(*scene.grid);
  const RayStops stops = make_ray_stops(stop_spec, scene.scale, 0);
  for (const RayStart& start : starts) {
    const double n = index_at(scene, start.x);
    fuzz::require_finite(n);
    if (stop_spec.step && n < 1e-3) return;  // thousands of short steps
  }
  for (const TracedRay& ray :
       trace_rays(scene, stops, make_ray_steps(stop_spec, scene.scale), starts, 2)) {
    fuzz::require_finite(ray.end.x.sum() + ray.end.v.sum());
    fuzz::require_finite(ray.end.arc_length + ray.end.optical_path);
    for (const Vec3& x : ray.path) fuzz::require_finite(x.sum());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* input, std::size_t size) {
  static const fuzz::Folder folder;
  Bytes bytes(input, size);
  constexpr const char* integrators[] = {"sharma", "leapfrog", "yoshida4"};
  const std::string integrator = integrators[bytes.below(3)];
  write_grid(bytes);
  fuzz::taken(integrator, trace_grid);
  return 0;
}
