#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "apps/command/experiment.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"
#include "core/session/session.h"
#include "grin/render/methods/method_choice.h"
#include "grin/render/pictures/map_datasets.h"
#include "grin/render/pictures/render_datasets.h"
#include "grin/render/values/render_values.h"

namespace flatspeckle::apps {

namespace {

/// Prints notes about light that is missing from the images, because paths were lost or cut off.
void note_losses(const grin::TransportCounts& counts) {
  if (counts.lost_flights > 0)
    std::fprintf(
        stderr,
        "note: %.2g %% of the flights were longer than max_length, trapped in a body, or reached "
        "an "
        "index that is not positive; their light is missing\n",
        100 * static_cast<double>(counts.lost_flights) / static_cast<double>(counts.flights));
  if (counts.lost_values > 0)
    std::fprintf(stderr, "note: %llu contributions were not finite and are left out\n",
                 static_cast<unsigned long long>(counts.lost_values));
}

/// Prints a warning if paths may be so long that the run shows no progress for a long time.
void note_long_paths(const grin::Stage& stage, std::int64_t max_scatterings) {
  constexpr double many = 1e6, seconds_each = 3e-7;
  const double scatterings = std::min(
      most_scatterings(stage), max_scatterings > 0 ? static_cast<double>(max_scatterings)
                                                   : std::numeric_limits<double>::infinity());
  if (scatterings > many)
    std::fprintf(stderr,
                 "note: light scatters up to %.2g times: a path may take %.1g s; mu_s (1 - g) "
                 "instead of mu_s, with g = 0, gives the same diffusion with fewer scatterings\n",
                 scatterings, seconds_each * scatterings);
}

/// Prints a note about sensors that no light has reached, often because of a mistake in the scene.
void note_darkness(const std::vector<std::string>& dark) {
  for (std::size_t i = 0; i < dark.size(); ++i)
    std::fprintf(stderr, "%s%s", i == 0 ? "note: no light reached " : ", ", dark[i].c_str());
  if (!dark.empty()) std::fputs("\n", stderr);
}

void print_row(const char* name, const Estimate& estimate, std::size_t entry,
               const std::string& units) {
  std::printf("%-16s %-13.6g %-10.2g %s\n", name, estimate.value[entry].real(),
              estimate.error[entry], units.c_str());
}

/// Whether an estimate is reliable enough to be printed as a value. It is not if it is undersampled
/// and its error is half the value or more: a few paths of high weight then dominate it, and paths
/// that were not sampled may contribute far more.
bool is_resolved(const Estimate& one) {
  const bool is_rare = !one.rare.empty() && one.rare[0];
  const double value = one.value[0].real();
  return !is_rare || value == 0 || one.error[0] < value / 2;
}

/// Prints an estimate of a single value if it is resolved; otherwise prints that it is not
/// resolved.
void print_resolved(const char* name, const Estimate& one, const std::string& units) {
  if (is_resolved(one)) return print_row(name, one, 0, units);
  std::printf(
      "%-16s not resolved: a few high-weight paths dominate (%.2g +- %.2g); use another method or "
      "more samples\n",
      name, one.value[0].real(), one.error[0]);
}

std::size_t largest_of(const Estimate& estimate) {
  const auto largest =
      std::max_element(estimate.value.begin(), estimate.value.end(),
                       [](const Complex& a, const Complex& b) { return a.real() < b.real(); });
  return static_cast<std::size_t>(largest - estimate.value.begin());
}

void print_pixels(const Estimate& image) {
  std::printf("pixels: relative error %.2g %% (RMS error over RMS value; larger for dark pixels)",
              100 * relative_error(image));
  double all = 0, undersampled = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.rare.size(); ++i) {
    const double light = image.value[i].real();
    all += light;
    if (!image.rare[i]) continue;
    undersampled += light;
    ++count;
  }
  if (count > 0)
    std::printf(
        "; %.3g %% of them, with %.3g %% of the light, are undersampled: their errors are upper "
        "bounds",
        100 * static_cast<double>(count) / static_cast<double>(image.rare.size()),
        100 * undersampled / all);
  std::puts("");
}

/// Prints derivatives with respect to each parameter: of the power within each radius or, if no
/// radii are given, of the mean over the pixels.
void print_gradients(const grin::SensorResult& result, const std::vector<std::string>& parameters,
                     const std::string& units) {
  const std::size_t radii = result.within ? result.within->radii.size() : 0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string by = ", derivative by " + parameters[i];
    for (std::size_t r = 0; r < radii; ++r)
      print_row(("within " + number_text(result.within->radii[r]) + by).c_str(),
                result.gradients->within, i * radii + r, "");
    if (radii == 0) print_row(("mean" + by).c_str(), result.gradients->mean, i, units);
  }
}

/// Prints total, mean and brightest pixel of a sensor. If no light has reached the sensor, prints
/// nothing and returns false.
bool print_sensor(const std::string& name, const grin::Sensor& sensor,
                  const grin::SensorResult& result, const std::vector<std::string>& parameters) {
  const std::string& units = row_of(grin::table_of(sensor), "image").unit;
  const auto& image = result.picture.steady;
  const std::size_t brightest = largest_of(image);
  if (!(image.value[brightest].real() > 0)) return false;
  std::printf("%-16s %-13s %-10s\n", name.c_str(), "value", "error");
  if (result.total) print_resolved("total power", *result.total, "");
  if (result.within)
    for (std::size_t i = 0; i < result.within->radii.size(); ++i)
      print_row(("within " + number_text(result.within->radii[i])).c_str(), result.within->power, i,
                "");
  print_resolved("mean of pixels", result.mean, units);
  print_row("brightest pixel", image, brightest, units);
  if (result.gradients) print_gradients(result, parameters, units);
  if (result.sidebands)
    for (std::size_t n = 0; n < grin::sidebands; ++n)
      print_row(("shifted by " + std::to_string(n)).c_str(), result.sidebands->mean, n, "");
  print_pixels(image);
  return true;
}

/// Prints the brightest cell of a fluence map. Returns false if no light has reached the map.
bool print_map(const grin::LightMap& map, const grin::RenderJob& job, const GroupedSums& sums) {
  const Estimate fluence = grin::fluence(sums, job.first_of_map(), map);
  const std::size_t brightest = largest_of(fluence);
  const bool is_lit = fluence.value[brightest].real() > 0;
  if (is_lit) print_row("largest fluence", fluence, brightest, "1/length^2");
  return is_lit;
}

/// Prints a note for each check by which the method has missed light or counted it twice.
void note_checks(const grin::RenderScene& scene, const std::vector<grin::LightCheck>& checks) {
  for (std::size_t i = 0; i < checks.size(); ++i)
    if (!checks[i].holds())
      std::fprintf(stderr,
                   "note: the mean of sensor %s, %.4g, differs from the mean of the light paths "
                   "that hit the sensor, %.4g, by %.2g times the limit that follows from their "
                   "errors; use another method\n",
                   sensor_name(scene, i).c_str(), checks[i].mean, checks[i].other,
                   checks[i].off / checks[i].limit);
}

/// Prints the results of all sensors and of the fluence map, and the cost of connections between
/// path vertices.
void print_render(const grin::RenderScene& scene, const grin::RenderJob& job,
                  const GroupedSums& sums, const grin::RenderResult& result,
                  const std::vector<grin::LightCheck>& checks) {
  const std::vector<std::string> parameters = grin::gradient_names(scene);
  std::vector<std::string> dark;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const std::string name = result.size() > 1 ? sensor_name(scene, i) : "";
    if (!print_sensor(name, scene.sensors[i], result[i], parameters))
      dark.push_back(name.empty() ? "the sensor" : "sensor " + name);
  }
  if (scene.map && !print_map(*scene.map, job, sums)) dark.emplace_back("the map");
  if (const auto powers = absorbed_by_label(scene, job, sums))
    for (std::size_t label = 0; label < powers->value.size(); ++label)
      if (powers->value[label].real() > 0)
        print_row(("absorbed in " + std::to_string(label)).c_str(), *powers, label, "");
  note_darkness(dark);
  note_checks(scene, checks);
  const grin::TransportCounts counts = transport_counts(job, sums);
  note_losses(counts);
  const auto& connections = counts.connections;
  if (connections.pairs == 0) return;
  std::printf(
      "connections: %llu pairs, %.3g %% of trials converged, %.3g further trials per connection\n",
      static_cast<unsigned long long>(connections.pairs), 100 * connections.success_rate(),
      connections.mean_trials());
}

/// Prints how the light paths have terminated (absorbed, escaped ...): the power for each kind of
/// termination, as a fraction of the emitted power.
void print_energy(const Estimate& energy) {
  const double emitted = energy.value[0].real();
  const char* before = "power of light: ";
  for (std::size_t termination = 1; termination < energy.value.size(); ++termination) {
    const double share = energy.value[termination].real() / emitted;
    if (!(share > 1e-12)) continue;  // only a rounding error
    const double error = energy.error[termination] / emitted;
    std::printf("%s%.4g", before, 100 * share);
    if (error > 1e-12) std::printf(" +- %.2g", 100 * error);
    std::printf(" %% %s", grin::termination_names[termination]);
    before = ", ";
  }
  std::puts("");
}

class RenderExperiment : public Experiment {
 public:
  void add_keys(Keys& keys) override {
    grin::add_keys(keys, values_);
    grin::add_keys(keys, request_values_);
    add_run_keys(keys, run_);
    keys.add("samples_per_pixel", samples_per_pixel_,
             "Stop after this number of paths from each pixel of the largest picture")
        .positive()
        .effort();
  }

  void read(const Keys& keys) override {
    request_ = make_render_request(keys, request_values_);
    scene_ = make_render_scene(keys, values_);
    check(*scene_, request_);
    stop_ = stop_rule(keys, run_, samples(keys));
    check_target();
    inputs_ = inputs_text(keys);
  }

  void note() const override {
    if (scene_->is_silent)
      std::fputs("note: the sound deflects no ray by 1e-5 rad or more and is left out\n", stderr);
    note_long_paths(scene_->stage, request_.max_scatterings);
    for (const grin::Body& body : scene_->stage.bodies)
      if (!body.note.empty()) std::fprintf(stderr, "note: %s\n", body.note.c_str());
  }

  PlannedExperiment plan() const override {
    const grin::RenderJob job = render_job(*scene_, request_, seed());
    return {.plan = "render: " + job.plan,
            .batches = job.batches,
            .write = [this, job](ResultFile& file, const GroupedSums& sums, bool prints) {
              write(file, job, sums, prints);
            }};
  }

 private:
  /// Returns the number of light paths to compute, if it is given directly or per pixel.
  std::optional<std::int64_t> samples(const Keys& keys) const {
    const auto& in_all = keys.read(run_.samples);
    const auto& each = keys.read(samples_per_pixel_);
    if (!each) return in_all;
    if (in_all) throw InputError("samples_per_pixel: must not be given together with samples");
    std::int64_t pixels = 1;
    for (const grin::Sensor& sensor : scene_->sensors)
      pixels = std::max<std::int64_t>(pixels, pixels_of(sensor).grid.count());
    if (*each > std::numeric_limits<std::int64_t>::max() / pixels)
      throw InputError("samples_per_pixel", number_text(static_cast<double>(*each)),
                       "is too large for this number of pixels");
    return *each * pixels;
  }
  /// Throws InputError for a target error with a method of infinite variance.
  void check_target() const {
    if (stop_.target_error && request_.method && !has_finite_variance(*scene_, *request_.method))
      throw InputError(
          "target_error", number_text(*stop_.target_error),
          "requires a method of finite variance; method = " + method_word(*request_.method) +
              " has infinite variance with these lights and sensors: use bidirectional or auto");
  }
  void write(ResultFile& file, const grin::RenderJob& job, const GroupedSums& sums,
             bool prints) const {
    const grin::RenderResult result = render_result(*scene_, job, sums);
    const auto checks = light_checks(job, sums);
    if (prints) print_render(*scene_, job, sums, result, checks);
    write_render(file, *scene_, job, result, scene_->length_unit);
    if (prints) write_counts(file, transport_counts(job, sums));
    if (const auto light = worst_light(checks))
      ResultGroup(file, grin::render_table).check("invariants/light", *light);
    std::vector<Invariant> sidebands;
    for (const grin::SensorResult& sensor : result)
      if (sensor.sidebands) sidebands.push_back(sensor.sidebands->balance);
    if (!sidebands.empty())
      ResultGroup(file, grin::render_table).check("invariants/sidebands", sidebands);
    if (const auto energy = energy_result(job, sums)) {
      if (prints) print_energy(*energy);
      write_energy(file, *scene_, request_, *energy);
      ResultGroup(file, grin::energy_table).check("invariants/power", power_balance(job, sums));
    }
    if (scene_->map) write_map(file, *scene_, job, sums);
  }

  grin::RenderValues values_;
  grin::RenderRequestValues request_values_;
  std::optional<std::int64_t> samples_per_pixel_;
  grin::RenderRequest request_;
  std::optional<grin::RenderScene> scene_;
};

}  // namespace

std::unique_ptr<Experiment> render_experiment() {
  return std::make_unique<RenderExperiment>();
}

}  // namespace flatspeckle::apps
