#include <array>
#include <map>
#include <vector>

#include "apps/index_field_options.h"
#include "apps/ray_starts.h"
#include "apps/ray_stops.h"
#include "apps/scene_field.h"
#include "apps/scene_options.h"
#include "apps/subcommands.h"
#include "core/result_file.h"
#include "tests/fuzz/input.h"

// Scene files. The first line says whose: "# covariance". Without --out each subcommand checks all
// that it can and stops before the work.

namespace {

using namespace flatspeckle;
using namespace flatspeckle::apps;

/// What `covariance` and `validate` make of a scene.
int make_medium(const Arguments& arguments) {
  SceneSpec spec;
  Subcommand command("covariance", "");
  add_scatterer_options(command.options(), spec);
  add_bulk_options(command.options(), spec);
  add_medium_options(command.options(), spec);
  add_structure_option(command.options(), spec);
  add_view_options(command.options(), spec);
  add_light_options(command.options(), spec);
  add_request_options(command.options(), spec);
  if (!command.parse(arguments)) return ExitStatus::done;
  settle_request(command, spec);
  const Scene scene = make_scene(spec);
  for (double number : {scene.medium.mu_s, scene.medium.mu_t, scene.medium.g, scene.medium.albedo,
                        scene.medium.k_shift, scene.placement.mean_count})
    fuzz::require_finite(number);
  for (double angle : {0.0, 1.0, 3.0})
    if (scene.medium.has_scatterers)
      fuzz::require_finite(std::abs(scattering_amplitude(scene.medium, scene.k, angle)));
  return ExitStatus::done;
}

/// What `trace` makes of a scene; it asks for --out first.
int trace_scene(const Arguments& arguments) {
  IndexFieldSpec field;
  RayStartSpec starts;
  RayStopSpec stops;
  Subcommand command("trace", "");
  add_index_field_options(command.options(), field);
  add_ray_start_options(command.options(), starts);
  add_ray_stop_options(command.options(), stops);
  constexpr std::int64_t most_rays = 1000;  // the program asks how much memory there is
  if (!command.parse(arguments) || starts.ray_count > most_rays) return ExitStatus::done;
  const auto rays = make_ray_starts(command, starts);
  const SceneField scene = make_index_field(command, field, 10);
  const RayStops made = make_ray_stops(stops, scene.scale, 10);
  fuzz::require_finite(made.location);
  fuzz::require_finite(make_ray_steps(stops, scene.scale).longest);
  for (const RayStart& ray : rays) {
    fuzz::require_finite(ray.direction.norm());
    fuzz::require_finite(index_at(scene, ray.x));
  }
  return ExitStatus::done;
}

/// Files that scenes may name.
void write_files() {
  fuzz::write_file("sensors.csv", "x,z\n0,-1\n2.5,12\n");
  fuzz::write_file("disks.csv", "x,z,radius,index_re,index_im\n0,1,0.2,1.5,0\n1,3,0.1,1.3,0.01\n");
  fuzz::write_file("rays.csv", "x,y,z,dx,dy,dz\n0,0,0,0,0,1\n0.1,0,0,0,0.1,1\n");
  fuzz::write_file("blobs.csv", "x,y,z,height,width\n0,0,0,0.1,1\n1,0,2,-0.05,0.5\n");
  fuzz::write_file("points.csv", "optical_depth,g\n1,0\n2,0.5\n");
  ResultFile structure("structure.h5");  // of 31 disks in a box of 20 by 10
  structure.scale("q", std::vector{0.5, 1.0, 2.0}, "1/length", "");
  structure.dataset("structure_factor", std::vector{0.8, 0.9, 1.0}, {"q"}, "1", "");
  structure.attribute("/", "count", std::uint64_t{31});
  structure.attribute("/", "packing_fraction", 31 * 3.14159265358979 * 0.04 / 200);
  for (const auto& [name, value] : {std::pair{"min_gap", 0.0002}, {"width", 20.0}, {"depth", 10.0}})
    structure.attribute("/", name, value);
  structure.commit();
  ResultFile grid("grid.h5");
  grid.dataset("excess", std::vector(64, 0.1), {std::size_t{4}, std::size_t{4}, std::size_t{4}},
               "1", "");
  for (const char* name : {"origin", "spacing"})
    grid.attribute("excess", name, std::vector{1.0, 1.0, 1.0});
  grid.commit();
}

void read_scene(const std::string& word) {
  static const std::map<std::string, int (*)(const Arguments&)> subcommands = {
      {"place", place},       {"solve", solve},        {"covariance", covariance}, {"flux", flux},
      {"validate", validate}, {"sweep", sweep},        {"field", field},           {"trace", trace},
      {"rays", trace_scene},  {"medium", make_medium}, {"render", render}};
  const auto subcommand = subcommands.find(word);
  if (subcommand != subcommands.end())
    subcommand->second({"flatspeckle", word, "--config", "scene.toml"});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const fuzz::Folder folder;
  static const bool files_written = (write_files(), true);
  static_cast<void>(files_written);
  const std::string_view text(reinterpret_cast<const char*>(bytes), size);
  fuzz::write_file("scene.toml", text);
  fuzz::taken(fuzz::first_word(text), read_scene);
  return 0;
}
