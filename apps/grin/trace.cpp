#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <sstream>

#include "apps/command/experiment.h"
#include "core/numbers/constants.h"
#include "core/result/result_group.h"
#include "grin/media/geometry/vector_values.h"
#include "grin/rays/marching/ray.h"
#include "grin/trace/trace_datasets.h"

namespace flatspeckle::apps {

namespace {

using grin::FoundConnections;
using grin::RayState;
using grin::TracedRay;
using grin::TraceScene;
using grin::Vec3;

std::string ends_of(const std::vector<TracedRay>& rays, double length_unit) {
  std::size_t ends[4] = {};
  for (const auto& ray : rays) ++ends[static_cast<std::size_t>(ray.status)];
  std::ostringstream text;
  text << "ended: " << ends[1] << " at max_length, ";
  if (ends[2] > 0) text << ends[2] << " at the edge of the grid, ";
  if (ends[3] > 0) text << ends[3] << " absorbed, ";
  text << ends[0] << " on a stop surface";
  if (ends[3] == rays.size()) return text.str();
  const auto printed = grin::ends_to_print(rays);
  if (printed.size() < rays.size()) text << "; only for rays that end on a stop surface:";
  const auto [least, most] =
      std::ranges::minmax(column(printed, [](const RayState& end) { return end.v.norm(); }));
  text << std::setprecision(6) << "\nindex at the end " << least << " to " << most;
  text << ", spot of radius " << grin::spot_radius(printed) << " (rms)";
  const auto path =  // a copy, because clang 14 cannot capture structured bindings
      std::ranges::minmax(column(printed, [](const RayState& end) { return end.optical_path; }));
  const auto range = [&](const char* what, double size, const char* unit) {
    text << '\n'
         << what << std::setprecision(12) << size * path.min << " to " << size * path.max << unit;
    text << std::setprecision(3) << ", spread " << size * (path.max - path.min) << unit;
  };
  range("optical path ", 1, "");
  if (length_unit != 1) range("time ", length_unit / light_speed, " s");
  return text.str();
}

std::string text_of(const grin::RayImage& image) {
  std::ostringstream text;
  text << std::setprecision(6) << "image: spot of radius " << image.spot_radius << " (rms), "
       << image.spot_extent << " (largest)";
  if (image.distance != 0) text << ", at " << image.distance << " from image_plane";
  if (image.focus && image.distance == 0) text << "; smallest at " << *image.focus;
  using Ray = grin::RayImage::Ray;
  text << "\npath differences " << root_mean_square(image, &Ray::path_difference) << " (rms)";
  if (image.best_point)
    text << "; smallest " << root_mean_square(image, &Ray::least_path_difference)
         << ", about the point " << grin::listed(*image.best_point);
  return text.str();
}

std::string text_of(const grin::ParaxialSystem& system) {
  std::ostringstream text;
  text << std::setprecision(8) << "\nparaxial: focal length " << system.focal_length;
  if (std::abs(system.image_index - 1) > 1e-9)
    text << " behind the system (index " << system.image_index << "), power " << system.power;
  if (system.back_focal_length) text << ", back focal length " << *system.back_focal_length;
  text << ", focus at " << grin::listed(system.focus) << std::setprecision(4) << ", f/"
       << system.f_number;
  return text.str();
}

std::string text_of(const grin::ImageQuality& quality) {
  std::ostringstream text;
  text << std::setprecision(4) << "\nnumerical aperture " << quality.aperture << ", Strehl ratio "
       << quality.strehl << " about the centre of the spot, " << quality.best_strehl
       << " about the best point";
  if (!quality.modulation)
    return text.str() + "; no MTF: too few rays, or path differences vary too fast";
  const auto& mtf = *quality.modulation;
  text << "\nMTF (x, y, ideal):";
  for (const std::size_t f : {2, 5, 10})
    text << (f == 2 ? " " : "; ") << mtf.along_x[f] << ", " << mtf.along_y[f] << ", "
         << mtf.of_ideal[f] << " at " << mtf.frequency[f] << " per unit of length";
  return text.str();
}

/// Writes the image of the rays and returns a text about it.
std::string make_image(const TraceScene& scene, const std::vector<TracedRay>& rays,
                       ResultFile& file) {
  const grin::RayImage image = make_ray_image(*scene.image, rays);
  write_image(file, image);
  std::string text = text_of(image);
  if (const auto system = paraxial_system(scene)) {
    write_system(file, *system);
    text += text_of(*system);
  }
  if (!scene.wavelength) return text;
  if (const auto quality = image_quality(image, rays, *scene.wavelength)) {
    write_quality(file, *quality);
    text += text_of(*quality);
  }
  return text;
}

Made trace_light(const TraceScene& scene, ResultFile& file, bool prints) {
  const auto rays = trace_rays(scene);
  write_rays(file, scene, rays);
  if (scene.path_points > 0) write_paths(file, scene, rays);
  const std::string image = scene.image ? make_image(scene, rays, file) : "";
  std::string plan = std::to_string(rays.size()) + (rays.size() == 1 ? " ray: " : " rays: ") +
                     describe(scene.steps);
  if (prints) std::printf("%s\n%s\n", plan.c_str(), ends_of(rays, scene.length_unit).c_str());
  if (prints && scene.image) std::printf("%s\n", image.c_str());
  return {plan, static_cast<double>(rays.size())};
}

/// Returns a text about the outcomes of the trials that search for connecting curves, with notes on
/// curves that may be missing.
std::string trials_of(const FoundConnections& found) {
  static constexpr const char* ends[grin::trial_outcomes] = {
      "converged",       "found no approach",   "did not converge",
      "left the region", "exceeded max_length", "ended on a caustic"};
  const auto& statistics = found.statistics;
  if (statistics.trials() == 0) return "a straight line, no trials needed";
  std::string text;
  for (int i = 0; i < grin::trial_outcomes; ++i)
    if (const auto count = statistics.outcomes[i]; count > 0)
      text += (text.empty() ? "trials: " : ", ") + std::to_string(count) + ' ' + ends[i];
  if (statistics.count(grin::TrialOutcome::degenerate) > 0)
    text += "\nnote: curves that meet in a caustic or image point at the end are not listed";
  constexpr std::uint64_t few = 5;
  if (std::ranges::any_of(found.curves, [](const auto& curve) { return curve.found < few; }))
    text += "\nnote: some curves were found fewer than 5 times; more trials may find others";
  return text;
}

std::string table_of(const FoundConnections& found) {
  std::ostringstream text;
  text << found.curves.size() << (found.curves.size() == 1 ? " curve" : " curves") << '\n';
  if (!found.curves.empty())
    text << "  optical path     arc length            |J|  caustics   found\n";
  for (const auto& [curve, times] : found.curves) {
    char line[160];
    std::snprintf(line, sizeof line, "%14.10g %14.10g %14.8g %9d %7llu\n", curve.optical_path,
                  curve.arc_length, curve.spreading, curve.caustics,
                  static_cast<unsigned long long>(times));
    text << line;
  }
  return text.str() + trials_of(found);
}

Made trace_curves(const TraceScene& scene, ResultFile& file, std::uint64_t seed, bool prints) {
  const auto found = find_connections(scene, seed);
  write_connections(file, scene, found);
  if (scene.path_points > 0 && !found.curves.empty())
    write_paths(file, scene, rays_along(scene, found));
  const auto trials = scene.curves->trials;
  std::string plan = std::to_string(trials) + " trials: " + describe(scene.steps);
  if (prints) std::printf("%s\n%s\n", plan.c_str(), table_of(found).c_str());
  return {plan, static_cast<double>(trials)};
}

class TraceExperiment : public OneShot {
 public:
  void add_keys(Keys& keys) override {
    grin::add_keys(keys, values_);
    add_seed_key(keys, run_, "Random seed of the trials by which connect finds curves");
    add_thread_key(keys, run_);
    add_output_key(keys, run_);
  }

  void read(const Keys& keys) override {
    scene_ = make_trace_scene(keys, values_);
    keys.read(run_.seed);
    if (!scene_->curves) keys.disregard(run_.seed);
  }

  void note() const override {
    for (const grin::Body& body : scene_->stage.bodies)
      if (!body.note.empty()) std::fprintf(stderr, "note: %s\n", body.note.c_str());
  }

 private:
  Made make(ResultFile& file, bool prints) const override {
    return scene_->curves ? trace_curves(*scene_, file, seed(), prints)
                          : trace_light(*scene_, file, prints);
  }

  grin::TraceValues values_;
  std::optional<TraceScene> scene_;
};

}  // namespace

std::unique_ptr<Experiment> trace_experiment() {
  return std::make_unique<TraceExperiment>();
}

}  // namespace flatspeckle::apps
