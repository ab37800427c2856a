#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

#include "apps/command/subcommands.h"
#include "core/result/result_file.h"
#include "core/session/run_settings.h"
#include "flatland/scene/scene.h"
#include "grin/render/pictures/render_datasets.h"
#include "grin/render/values/render_values.h"
#include "grin/trace/trace_scene.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/targets.h"

// Scene files. The first line names the subcommand and may contain command-line flags: "#
// covariance --seed 2". With --print-config each subcommand checks its input and stops before the
// work.

namespace flatspeckle::fuzz_scene {

namespace {

using namespace flatspeckle::apps;

/// Prepares a scene as `covariance` and `validate` do.
int make_medium(const Arguments& arguments) {
  SceneSpec spec;
  Subcommand command("covariance", "");
  add_keys(command.keys(), spec);
  if (!command.parse(arguments)) return ExitStatus::done;
  const Scene scene = make_scene(command.keys(), spec);
  for (double number : {scene.medium.mu_s, scene.medium.mu_t, scene.medium.g, scene.medium.albedo,
                        scene.medium.k_shift, scene.placement.mean_count})
    fuzz::require_finite(number);
  if (scene.medium.mu_s > 0 && !scene.medium.t_matrix.empty())
    for (const Complex amplitude : normalised_amplitudes(scene.medium, scene.k, 3))
      fuzz::require_finite(std::abs(amplitude));
  return ExitStatus::done;
}

/// Prepares a scene as `trace` does.
int trace_scene(const Arguments& arguments) {
  grin::TraceValues values;
  Subcommand command("trace", "");
  add_keys(command.keys(), values);
  constexpr std::int64_t most_rays = 1000;  // the program limits rays by the available memory
  if (!command.parse(arguments) || values.starts.ray_count > most_rays) return ExitStatus::done;
  const grin::TraceScene scene = make_trace_scene(command.keys(), values);
  fuzz::require_finite(scene.stops.location);
  fuzz::require_finite(scene.steps.longest);
  for (const grin::RayStart& ray : scene.starts) {
    fuzz::require_finite(ray.direction.norm());
    fuzz::require_finite(index_at(scene.field, ray.x));
  }
  return ExitStatus::done;
}

/// Whether a picture is small enough to be rendered: few pixels and short paths of few steps.
bool is_small(const grin::RenderScene& scene, const grin::RenderRequest& request) {
  constexpr double most_values = 64, most_steps = 40;
  int count = 0;
  for (const grin::Sensor& sensor : scene.sensors) count += grin::pixels_of(sensor).grid.count();
  const grin::Box box = bounds(scene.stage.boundary);
  const double size = (box.high - box.low).norm();
  return request.max_scatterings >= 1 && request.max_scatterings <= 3 &&
         count * static_cast<double>(scene.bins.sums()) <= most_values &&
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
  grin::write_render(file, scene, job, grin::render_result(scene, job, sums), length_unit);
  file.commit();
}

/// Prepares a scene as `render` does before its pilot run, which takes a second.
int render_scene(const Arguments& arguments) {
  grin::RenderValues values;
  grin::RenderRequestValues how;
  RunSettings run;
  Subcommand command("render", "");
  Keys& keys = command.keys();
  add_keys(keys, values);
  add_keys(keys, how);
  add_run_keys(keys, run);
  if (!command.parse(arguments)) return ExitStatus::done;
  const grin::RenderScene scene = make_render_scene(keys, values);
  const grin::RenderRequest request = make_render_request(keys, how);
  const std::optional<double> length_unit = keys.read(values.length_unit);
  stop_rule(keys, run);
  fuzz::require_finite(scene.step + scene.max_length + scene.stage.medium.mu_t());
  check(scene.stage);
  grin::sensor_endpoints(scene.sensors, scene.stage);
  const grin::StageLights lights(scene.lights, scene.stage, [](const auto&) { return 1.0; });
  fuzz::require_finite(lights.power());
  for (const grin::Sensor& sensor : scene.sensors) {
    for (const auto& [name, middles] : grin::pixels_of(sensor).axes)
      for (double middle : middles) fuzz::require_finite(middle);
  }
  if (arguments[1] == "picture" && is_small(scene, request))
    make_small_picture(scene, request, length_unit);
  return ExitStatus::done;
}

/// Writes files that scenes may name.
void write_files() {
  fuzz::write_file("sensors.csv", "x,z\n0,-1\n2.5,12\n");
  fuzz::write_file("disks.csv", "x,z,radius,index_re,index_im\n0,1,0.2,1.5,0\n1,3,0.1,1.3,0.01\n");
  fuzz::write_file("rays.csv", "x,y,z,dx,dy,dz\n0,0,0,0,0,1\n0.1,0,0,0,0.1,1\n");
  fuzz::write_file("blobs.csv", "x,y,z,height,width\n0,0,0,0.1,1\n1,0,2,-0.05,0.5\n");
  fuzz::write_file("points.csv", "optical_depth,g\n1,0\n2,0.5\n");
  fuzz::write_file("layers.csv", "thickness,density,flow,diffusion\n3,0.05,0,1\n7,0.2,1,0.5\n");
  fuzz::write_file("holes.csv", "x,z,radius,amplitude\n-2,4,2,-1\n5,7,1.5,2\n");
  ResultFile structure("structure.h5");  // for 31 disks in a box of 20 by 10
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

/// Returns the magnitudes of all numbers that follow a key, in flags and in the scene.
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

/// Whether a scene has large disks that the program accepts. Their phase functions are tables of
/// tens of millions of sums with thousands of terms: seconds in the program, hours under the
/// sanitizers.
bool has_slow_disks(const std::string& text) {
  constexpr double most = 40, most_of_program = 1e4;
  const auto largest = [&](const char* key, double usual) {
    const auto numbers = numbers_of(text, key);
    return numbers.empty() ? usual : std::ranges::max(numbers);
  };
  const auto wavelengths = numbers_of(text, "wavelength");
  const double wavelength = wavelengths.empty() ? 1 : std::ranges::min(wavelengths);
  const double size = 2 * std::numbers::pi * largest("radius", 0) / wavelength;
  const double index =
      std::max(1.0, 2 * largest("index", 1.5));  // largest of its real and imaginary parts
  return size * index > most && size <= most_of_program;
}

/// Whether a flag would start the work, or read another file than the scene.
bool is_left_out(const std::string& flag) {
  return flag.starts_with("--out") || flag.starts_with("--config");
}

/// Whether a subcommand uses disks in the plane.
bool is_flat(const std::string& subcommand) {
  static const std::set<std::string> in_space = {"trace", "rays", "render", "picture", "bench"};
  return !in_space.contains(subcommand);
}

/// Checks all input and stops before the work.
int only_check(Arguments arguments) {
  arguments.emplace_back("--print-config");
  for (const SubcommandEntry& entry : subcommands())
    if (arguments[1] == entry.name) return run_subcommand(entry, arguments).status;
  return ExitStatus::done;
}

void read_scene(const std::string& text) {
  static const std::map<std::string, int (*)(const Arguments&)> parts = {{"rays", trace_scene},
                                                                         {"medium", make_medium},
                                                                         {"picture", render_scene},
                                                                         {"render", render_scene}};
  std::istringstream words(fuzz::first_line(text));
  std::string word;
  words >> word;
  if (is_flat(word) && has_slow_disks(text)) return;
  Arguments arguments{"flatspeckle", word};
  while (words >> word)
    if (!is_left_out(word)) arguments.push_back(word);
  arguments.insert(arguments.end(), {"--config", "scene.toml"});
  const auto part = parts.find(arguments[1]);
  part == parts.end() ? only_check(arguments) : part->second(arguments);
}

}  // namespace

void use_input(const std::uint8_t* bytes, std::size_t size) {
  static const bool files_written = (write_files(), true);
  static_cast<void>(files_written);
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  fuzz::write_file("scene.toml", text);
  fuzz::taken(text, read_scene);
}

}  // namespace flatspeckle::fuzz_scene
