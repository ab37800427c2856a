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

/// What is missing from a picture is not passed over in silence.
void note_losses(const grin::TransportCounts& counts) {
  if (counts.lost_flights > 0)
    std::fprintf(
        stderr,
        "note: %.2g %% of the flights were longer than max_length, trapped in a body, or came to "
        "where the index is not positive; their light is missing\n",
        100 * static_cast<double>(counts.lost_flights) / static_cast<double>(counts.flights));
  if (counts.lost_values > 0)
    std::fprintf(stderr, "note: %llu contributions were not finite and are left out\n",
                 static_cast<unsigned long long>(counts.lost_values));
}

void note_smoothing(const grin::LevelSurface& surface) {
  const double change = surface.volume() / surface.meant_volume() - 1;
  std::fprintf(
      stderr,
      "note: in place of body_mesh there is a smooth surface of spacing %.3g, whose volume "
      "differs by %+.2g %%\n",
      surface.spacing(), 100 * change);
}

/// Runs of very long paths look as if nothing happened.
void note_long_paths(const grin::Stage& stage, std::int64_t max_scatterings) {
  constexpr double many = 1e6, seconds_each = 3e-7;
  const double scatterings = std::min(
      most_scatterings(stage), max_scatterings > 0 ? static_cast<double>(max_scatterings)
                                                   : std::numeric_limits<double>::infinity());
  if (scatterings > many)
    std::fprintf(
        stderr,
        "note: light scatters up to %.2g times: a path may take %.1g s (with mu_s (1 - g) in "
        "place of mu_s and g = 0 it diffuses alike)\n",
        scatterings, seconds_each * scatterings);
}

/// A dark picture is more often a mistake than a result.
void note_darkness(const std::vector<std::string>& dark) {
  for (std::size_t i = 0; i < dark.size(); ++i)
    std::fprintf(stderr, "%s%s", i == 0 ? "note: no light came to " : ", ", dark[i].c_str());
  if (!dark.empty()) std::fputs("\n", stderr);
}

void print_row(const char* name, const Estimate& estimate, std::size_t entry,
               const std::string& units) {
  std::printf("%-16s %-13.6g %-10.2g %s\n", name, estimate.value[entry].real(),
              estimate.error[entry], units.c_str());
}

/// A few strong paths, whose error may be as large as the value, are no estimate of it: what others
/// bring may be any multiple of that.
bool is_found(const Estimate& one) {
  const bool is_rare = !one.rare.empty() && one.rare[0];
  const double value = one.value[0].real();
  return !is_rare || value == 0 || one.error[0] < value / 2;
}

/// Of one entry.
void print_found(const char* name, const Estimate& one, const std::string& units) {
  if (is_found(one)) return print_row(name, one, 0, units);
  std::printf(
      "%-16s not found: a few strong paths bring %.2g +- %.2g; take another method or more "
      "samples\n",
      name, one.value[0].real(), one.error[0]);
}

std::size_t largest_of(const Estimate& estimate) {
  const auto largest =
      std::max_element(estimate.value.begin(), estimate.value.end(),
                       [](const Complex& a, const Complex& b) { return a.real() < b.real(); });
  return static_cast<std::size_t>(largest - estimate.value.begin());
}

void print_pixels(const Estimate& image) {
  std::printf("pixels: relative error %.2g %% (RMS error over RMS value: dark ones may be far off)",
              100 * relative_error(image));
  double all = 0, marked = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.rare.size(); ++i) {
    const double light = image.value[i].real();
    all += light;
    if (!image.rare[i]) continue;
    marked += light;
    ++count;
  }
  if (count > 0)
    std::printf("; %.3g %% of them, with %.3g %% of the light, rest on few paths and have bounds",
                100 * static_cast<double>(count) / static_cast<double>(image.rare.size()),
                100 * marked / all);
  std::puts("");
}

/// Of the power within each radius, or else of the mean of pixels.
void print_gradients(const grin::SensorResult& result, const std::vector<std::string>& parameters,
                     const std::string& units) {
  const std::size_t radii = result.within ? result.within->radii.size() : 0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string by = " by " + parameters[i];
    for (std::size_t r = 0; r < radii; ++r)
      print_row(("within " + number_text(result.within->radii[r]) + by).c_str(),
                result.gradients->within, i * radii + r, "");
    if (radii == 0) print_row(("mean" + by).c_str(), result.gradients->mean, i, units);
  }
}

/// Total, mean and brightest pixel, under a name; nothing in the dark. Returns whether there is
/// light.
bool print_sensor(const std::string& name, const grin::Sensor& sensor,
                  const grin::SensorResult& result, const std::vector<std::string>& parameters) {
  const std::string& units = row_of(grin::table_of(sensor), "image").unit;
  const auto& image = result.picture.steady;
  const std::size_t brightest = largest_of(image);
  if (!(image.value[brightest].real() > 0)) return false;
  std::printf("%-16s %-13s %-10s\n", name.c_str(), "value", "error");
  if (result.total) print_found("total power", *result.total, "");
  if (result.within) {
    for (std::size_t i = 0; i < result.within->radii.size(); ++i)
      print_row(("within " + number_text(result.within->radii[i])).c_str(), result.within->power, i,
                "");
    std::puts("target_error: largest error of these, relative to the power or 1 % of the light");
  }
  print_found("mean of pixels", result.mean, units);
  print_row("brightest pixel", image, brightest, units);
  if (result.gradients) print_gradients(result, parameters, units);
  print_pixels(image);
  return true;
}

/// The brightest cell. Returns whether there is light.
bool print_map(const grin::LightMap& map, const grin::RenderJob& job, const GroupedSums& sums) {
  const Estimate fluence = grin::fluence(sums, job.first_of_map(), map);
  const std::size_t brightest = largest_of(fluence);
  const bool is_lit = fluence.value[brightest].real() > 0;
  if (is_lit) print_row("largest fluence", fluence, brightest, "1/length^2");
  return is_lit;
}

/// Light that the method has missed, or found twice.
void note_checks(const grin::RenderScene& scene, const std::vector<grin::LightCheck>& checks) {
  for (std::size_t i = 0; i < checks.size(); ++i)
    if (!checks[i].holds())
      std::fprintf(
          stderr,
          "note: the mean of sensor %s, %.4g, is not that of light paths that hit it, %.4g: "
          "they differ by %.2g times what errors allow; take another method\n",
          sensor_name(scene, i).c_str(), checks[i].mean, checks[i].other,
          checks[i].off / checks[i].limit);
}

/// What each sensor and the map have found, and what the search for curves cost.
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
  note_darkness(dark);
  note_checks(scene, checks);
  const grin::TransportCounts counts = transport_counts(job, sums);
  note_losses(counts);
  const auto& joins = counts.connections;
  if (joins.pairs == 0) return;
  std::printf("joins: %llu pairs, %.3g %% of trials converged, %.3g further trials each\n",
              static_cast<unsigned long long>(joins.pairs), 100 * joins.success_rate(),
              joins.mean_refind());
}

/// Where the power went, as shares of it.
void print_energy(const Estimate& energy) {
  const double emitted = energy.value[0].real();
  const char* before = "power of light: ";
  for (std::size_t fate = 1; fate < energy.value.size(); ++fate) {
    const double share = energy.value[fate].real() / emitted;
    if (!(share > 1e-12)) continue;  // rounding
    const double error = energy.error[fate] / emitted;
    std::printf("%s%.4g", before, 100 * share);
    if (error > 1e-12) std::printf(" +- %.2g", 100 * error);
    std::printf(" %% %s", grin::fate_words[fate]);
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
  }

  void read(const Keys& keys) override {
    stop_ = stop_rule(keys, run_);
    request_ = make_render_request(keys, request_values_);
    scene_ = make_render_scene(keys, values_);
    check(*scene_, request_);
    check_target();
    inputs_ = inputs_text(keys);
  }

  void note() const override {
    if (scene_->is_silent)
      std::fputs("note: the sound turns no ray by 1e-5, and is left out\n", stderr);
    note_long_paths(scene_->stage, request_.max_scatterings);
    for (const grin::Body& body : scene_->stage.bodies)
      if (const auto* level = std::get_if<grin::LevelSurface>(&body.surface))
        note_smoothing(*level);
  }

  PlannedExperiment plan() const override {
    const grin::RenderJob job = render_job(*scene_, request_, seed());
    return {.plan = "render: " + job.plan,
            .batches = job.batches,
            .write = [this, job](ResultFile& file, const GroupedSums& sums, bool tells) {
              write(file, job, sums, tells);
            }};
  }

 private:
  /// Throws InputError for a target that no error of the method can be trusted to have reached.
  void check_target() const {
    if (stop_.target_error && request_.method && !has_finite_variance(*scene_, *request_.method))
      throw InputError("target_error", number_text(*stop_.target_error),
                       "needs a method of finite variance, which " + method_word(*request_.method) +
                           " is not with these lights and sensors: take bidirectional or auto");
  }
  void write(ResultFile& file, const grin::RenderJob& job, const GroupedSums& sums,
             bool tells) const {
    const grin::RenderResult result = render_result(*scene_, job, sums);
    const auto checks = light_checks(job, sums);
    if (tells) print_render(*scene_, job, sums, result, checks);
    write_render(file, *scene_, job, result, scene_->length_unit);
    if (tells) write_counts(file, transport_counts(job, sums));
    if (const auto light = worst_light(checks))
      ResultGroup(file, grin::render_table).check("invariants/light", *light);
    if (const auto energy = energy_result(job, sums)) {
      if (tells) print_energy(*energy);
      write_energy(file, *scene_, request_, *energy);
      ResultGroup(file, grin::energy_table).check("invariants/power", power_balance(job, sums));
    }
    if (scene_->map) write_map(file, *scene_, job, sums);
  }

  grin::RenderValues values_;
  grin::RenderRequestValues request_values_;
  grin::RenderRequest request_;
  std::optional<grin::RenderScene> scene_;
};

}  // namespace

std::unique_ptr<Experiment> render_experiment() {
  return std::make_unique<RenderExperiment>();
}

}  // namespace flatspeckle::apps
