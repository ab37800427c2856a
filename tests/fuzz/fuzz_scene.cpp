#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include "apps/index_field_options.h"
#include "apps/ray_starts.h"
#include "apps/ray_stops.h"
#include "apps/render_output.h"
#include "apps/render_scene.h"
#include "apps/run_options.h"
#include "apps/scene_field.h"
#include "apps/scene_options.h"
#include "apps/subcommands.h"
#include "core/result/result_file.h"
#include "tests/fuzz/input.h"

// Scene files. The first line says whose, and may go on with flags of the command line:
// "# covariance --seed 2". Without --out each subcommand checks all that it can and stops before
// the work.

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

/// Pictures that are begun as well: of a few pixels and short paths of few steps.
bool is_small(const grin::RenderScene& scene, const grin::RenderRequest& request) {
  constexpr double most_values = 64, most_steps = 40;
  const auto count = std::visit([](const auto& kind) { return kind.pixels.count(); }, scene.sensor);
  const grin::Box box = bounds(scene.stage.boundary);
  const double size = (box.high - box.low).norm();
  return request.max_scatterings >= 1 && request.max_scatterings <= 3 &&
         request.method != grin::RenderMethod::photon_map &&
         count * static_cast<double>(scene.bins.count) <= most_values &&
         size <= most_steps * scene.step && scene.max_length <= 3 * most_steps * scene.step;
}

void make_small_picture(const grin::RenderScene& scene, const grin::RenderRequest& request,
                        const std::optional<double>& length_unit) {
  const grin::RenderJob job = grin::render_job(scene, request, 1);
  GroupedSums sums(job.batches.size);
  for (int batch = 0; batch < 2; ++batch) {
    std::vector<Complex> added(job.batches.size);
    job.batches.run(batch, added);
    for (const Complex& sum : added) fuzz::require_finite(sum.real());
    sums.add(job.batches.samples_per_batch, added);
  }
  ResultFile file("picture.h5");
  write_render(file, scene, job, render_result(scene, job, sums), length_unit);
  file.commit();
}

/// What `render` makes of a scene, before its pilot of a second.
int render_scene(const Arguments& arguments) {
  RenderSpec spec;
  RunSettings settings;
  Subcommand command("render", "");
  add_render_options(command.options(), spec);
  add_run_options(command.options(), settings);
  if (!command.parse(arguments)) return ExitStatus::done;
  const grin::RenderScene scene = make_render_scene(command, spec);
  const grin::RenderRequest request = make_render_request(spec);
  const std::optional<double> length_unit = length_unit_of(spec);
  seed_of(settings);
  stop_rule(settings);
  inputs_text(spec);
  fuzz::require_finite(scene.step + scene.max_length + scene.stage.medium.mu_t());
  check(scene.stage);
  const grin::SensorEnd sensor(scene.sensor, scene.stage);
  const grin::Lights lights(scene.lights, scene.stage, [](const auto&) { return 1.0; });
  fuzz::require_finite(lights.power());
  const grin::PixelRectangle picture = grin::picture_of(scene.sensor);
  for (const auto& centres : {picture.row_centres(), picture.column_centres()})
    for (double centre : centres) fuzz::require_finite(centre);
  if (arguments[1] == "picture" && is_small(scene, request))
    make_small_picture(scene, request, length_unit);
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
  ResultFile density("density.h5");
  density.dataset("density", std::vector{0., 1., 2., 0., 1., 0., 3., 1.},
                  {std::size_t{2}, std::size_t{2}, std::size_t{2}}, "1", "");
  density.attribute("density", "origin", std::vector{-1.0, -1.0, 0.0});
  density.attribute("density", "spacing", std::vector{2.0, 2.0, 3.0});
  density.commit();
}

/// The sizes of all numbers that follow a key, in flags and in the scene.
std::vector<double> numbers_of(const std::string& text, const std::string& key) {
  const auto is_one_of = [&](std::string_view set, std::size_t at) {
    return at < text.size() && set.find(text[at]) != set.npos;
  };
  std::vector<double> numbers;
  for (auto at = text.find(key); at != text.npos; at = text.find(key, at + 1)) {
    auto next = at + key.size();
    if (!(at > 0 && is_one_of("\n\r\t -", at - 1) && is_one_of("\t =", next))) continue;
    for (;;) {
      while (is_one_of("\n\r\t =,[]'\"", next)) ++next;
      char* end = nullptr;
      const double number = std::strtod(text.c_str() + next, &end);
      if (end == text.c_str() + next) break;
      numbers.push_back(std::abs(number));
      next = end - text.c_str();
    }
  }
  return numbers;
}

/// Phase functions of large disks are tables of tens of millions of sums of thousands of terms:
/// seconds in the program, hours under the sanitizers. Those that the program refuses are tried.
bool has_slow_disks(const std::string& text) {
  constexpr double most = 40, most_of_program = 1e4;
  const auto largest = [&](const char* key, double usual) {
    const auto numbers = numbers_of(text, key);
    return numbers.empty() ? usual : std::ranges::max(numbers);
  };
  const auto wavelengths = numbers_of(text, "wavelength");
  const double wavelength = wavelengths.empty() ? 1 : std::ranges::min(wavelengths);
  const double size = 2 * std::numbers::pi * largest("radius", 0) / wavelength;
  const double index = std::max(1.0, 2 * largest("index", 1.5));  // of both its parts
  return size * index > most && size <= most_of_program;
}

/// What would begin the work, or read what is no scene.
bool is_left_out(const std::string& flag) {
  return flag.starts_with("--out") || flag.starts_with("--config");
}

/// Of disks in the plane.
bool is_flat(const std::string& subcommand) {
  static const std::set<std::string> in_space = {"trace", "rays", "render", "picture", "bench"};
  return !in_space.contains(subcommand);
}

void read_scene(const std::string& text) {
  static const std::map<std::string, int (*)(const Arguments&)> subcommands = {
      {"place", place},        {"solve", solve},         {"covariance", covariance},
      {"flux", flux},          {"validate", validate},   {"sweep", sweep},
      {"field", field},        {"trace", trace},         {"rays", trace_scene},
      {"medium", make_medium}, {"render", render_scene}, {"picture", render_scene},
      {"bench", bench}};
  std::istringstream words(fuzz::first_line(text));
  std::string word;
  words >> word;
  const auto subcommand = subcommands.find(word);
  if (subcommand == subcommands.end() || (is_flat(word) && has_slow_disks(text))) return;
  Arguments arguments{"flatspeckle", word};
  while (words >> word)
    if (!is_left_out(word)) arguments.push_back(word);
  arguments.insert(arguments.end(), {"--config", "scene.toml"});
  subcommand->second(arguments);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const fuzz::Folder folder;
  static const bool files_written = (write_files(), true);
  static_cast<void>(files_written);
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  fuzz::write_file("scene.toml", text);
  fuzz::taken(text, read_scene);
  return 0;
}
