#include <algorithm>
#include <cstdio>
#include <numeric>
#include <span>
#include <string>

#include "apps/command/experiment.h"
#include "apps/results/estimation.h"
#include "apps/results/extras.h"
#include "core/error.h"
#include "core/keys/number_text.h"
#include "core/result/result_group.h"
#include "core/session/session.h"
#include "flatland/media/layers.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/distance/detector_keys.h"
#include "mc/distance/distance_job.h"
#include "mc/distance/flow_plan.h"
#include "mc/jobs/delay_results.h"

namespace flatspeckle::apps {

namespace {

/// Throws InputError for media that expansion in harmonics does not support.
void check_layers(const Scene& scene) {
  const auto* layers = dynamic_cast<const Layers*>(scene.profile.get());
  if (layers == nullptr) {
    if (!(scene.medium.mu_s > 0))
      throw InputError("albedo", scene.medium.albedo, "must be above 0: the medium must scatter");
    return;
  }
  constexpr double least = 1e-6;  // fraction of the largest mu_s
  double most = 0;
  for (const Material& material : layers->materials()) most = std::max(most, material.medium.mu_s);
  for (const Material& material : layers->materials()) {
    if (!(material.medium.mu_s > least * most))
      throw InputError("layers: each layer must scatter; give clear layers a small mu_s");
    if (material.index != layers->materials()[0].index)
      throw InputError("medium_index", material.index, "must be the same in all layers");
  }
}

/// Prints a note for layers that scatter so weakly that harmonics converge slowly in them.
void note_thin_layers(const Scene& scene) {
  constexpr double thin = 0.5;
  const auto* layers = dynamic_cast<const Layers*>(scene.profile.get());
  for (std::size_t i = 0; layers != nullptr && i < layers->materials().size(); ++i)
    if (const double depth = layers->materials()[i].medium.mu_s * layers->thickness(i);
        depth < thin)
      std::fprintf(stderr,
                   "note: layer %zu has a scattering depth (mu_s times thickness) of %.2g, below "
                   "0.5: harmonics converge slowly there; give it a larger mu_s and g with the "
                   "same mu_s (1 - g), or use render\n",
                   i, depth);
}

/// Prints a note if the wavelength is not much shorter than the transport mean free path, as with a
/// wavelength in another unit of length.
void note_long_waves(const Scene& scene) {
  constexpr double least = 10;
  const double turning = scene.medium.mu_s * (1 - scene.medium.g);
  if (scene.k < least * turning)
    std::fprintf(stderr,
                 "note: wavelength = %g is not much shorter than the transport mean free path, %g, "
                 "as transport requires; both are in units of length_unit\n",
                 scene.wavelength, 1 / turning);
}

void print_distances(const mc::DistanceRequest& request, const mc::DistanceEstimates& found) {
  std::printf("%10s  %-24s %-24s\n", "distance", "detected power", "reflectance per area");
  for (std::size_t d = 0; d < request.detectors.size(); ++d)
    std::printf("%10.4g  %-12.6g %-11.2g %-12.6g %-11.2g\n", request.detectors[d].distance,
                found.power.value[d].real(), found.power.error[d],
                found.reflectance.value[d].real(), found.reflectance.error[d]);
}

/// Prints values [row][distance], one line per row.
void print_rows(const char* name, const std::vector<double>& rows, std::span<const double> values,
                const mc::DistanceRequest& request) {
  if (rows.empty()) return;
  std::printf("%12s  at distance", name);
  for (const auto& detector : request.detectors) std::printf(" %-10.4g", detector.distance);
  std::printf("\n");
  const std::size_t columns = request.detectors.size();
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::printf("%12.4g             ", rows[r]);
    for (std::size_t d = 0; d < columns; ++d) std::printf(" %-10.4g", values[r * columns + d]);
    std::printf("\n");
  }
}

/// Prints the mean path of the detected light in each layer.
void print_paths(const mc::DistanceRequest& request, const mc::DistanceEstimates& found) {
  std::vector<double> layers(found.layer_path.value.size() / request.detectors.size());
  std::iota(layers.begin(), layers.end(), 0.0);
  print_rows("layer: path", layers, real_parts(found.layer_path.value), request);
}

/// Prints the best detector and exposure of an instrument. counts_photons: whether it has photon
/// counters at fibres instead of a camera.
void print_flow(const mc::FlowPlan& plan, const mc::DistanceRequest& request,
                const mc::Instrument& instrument, bool counts_photons) {
  const auto& times = request.dynamics.exposure.times;
  print_rows("photons per s", {instrument.averaging_time}, plan.rate, request);
  print_rows("K^2: flow/error", times, plan.contrast_ratio, request);
  if (counts_photons)
    print_rows("g2: flow/error", {instrument.averaging_time}, plan.correlation_ratio, request);
  const auto print_best = [&](const std::string& name, const std::vector<double>& ratios,
                              const std::vector<double>& crosstalk) {
    const auto best = static_cast<std::size_t>(std::ranges::max_element(ratios) - ratios.begin());
    const std::size_t row = best / request.detectors.size();
    std::printf("%s: best distance %.4g", name.c_str(),
                request.detectors[best % request.detectors.size()].distance);
    if (name == "K^2") std::printf(", exposure %.4g s", times[row]);
    if (ratios[best] > 0)
      std::printf(", error of the flow %.3g %%, crosstalk %.3g", 100 / ratios[best],
                  crosstalk[best]);
    if (name == "K^2" && times.size() > 1 && (row == 0 || row + 1 == times.size()))
      std::printf(" (exposures beyond those given may be better)");
    std::printf("\n");
  };
  if (!times.empty()) {
    print_best("K^2", plan.contrast_ratio, plan.contrast_crosstalk);
    const auto best = std::ranges::max_element(plan.contrast_separated);
    if (*best > 0)
      std::printf("K^2: all distances and no other knowledge: %.3g %% at exposure %.4g s\n",
                  100 / *best,
                  times[static_cast<std::size_t>(best - plan.contrast_separated.begin())]);
  }
  if (!counts_photons) return;
  print_best("g2", plan.correlation_ratio, plan.correlation_crosstalk);
  if (plan.correlation_separated > 0)
    std::printf("g2: all distances and no other knowledge: %.3g %%\n",
                100 / plan.correlation_separated);
}

class ReflectanceExperiment : public Experiment {
 public:
  ReflectanceExperiment() {
    spec_.dimension = 3;
    spec_.domain = "slab";
    spec_.scatterer = "hg";
    spec_.polarisation = "unpolarised";
    methods_.tolerance = 2e-3;
  }

  void add_keys(Keys& keys) override {
    add_scatterer_keys(keys, spec_);
    add_bulk_keys(keys, spec_);
    add_medium_keys(keys, spec_);
    add_profile_keys(keys, spec_);
    add_faces_keys(keys, spec_);
    keys.group("Detectors");
    keys.add("distances", distances_,
             "Distances of the detectors from the axis of the beam, which enters along the normal; "
             "10:40:7 means 7 distances, first:last:count")
        .positive()
        .unit("length")
        .swept();
    mc::add_keys(keys, detectors_);
    add_length_unit_key(keys, length_unit_);
    mc::add_keys(keys, instrument_values_);
    keys.group("Motion");
    mc::add_keys(keys, dynamics_);
    keys.group("Results");
    keys.add("gradient", gradient_,
             "Also compute derivatives by mu_a, mu_s and the diffusion factor of each layer");
    add_transport_keys(keys, methods_);
    add_run_keys(keys, run_);
  }

  void read(const Keys& keys) override {
    read_transport(keys, methods_, spec_, run_);
    stop_ = both_batches(methods_.tolerance);
    if (keys.read(distances_).empty())
      throw InputError("distances: required, such as distances = 10 20 30");
    request_ = mc::make_detectors(keys, detectors_, "distances", distances_);
    request_.gradient = keys.read(gradient_);
    has_wavelength_ = keys.given(spec_.wavelength);
    request_.length_unit = keys.read(length_unit_);
    request_.dynamics = mc::make_dynamics(keys, dynamics_, spec_, length_unit(keys));
    const mc::Motion& motion = request_.dynamics.motion;
    if (motion.velocity != Vec{} || motion.shear != 0)
      throw InputError("velocity, shear: require covariance with method = mc");
    mc::check_exposure(request_.dynamics.exposure, request_.dynamics.delays);
    instrument_ = mc::make_instrument(keys, instrument_values_, spec_, request_);
    scene_ = with_dimension(make_scene(keys, spec_), spec_);
    check_layers(*scene_);
    if (instrument_) {
      mc::set_flow(*instrument_, *scene_);
      request_.gradient = true;
      if (!keys.given(dynamics_.beta)) request_.dynamics.exposure.beta = instrument_->beta;
    }
    mc::check_delays(*scene_, request_.dynamics.delays, motion);
    inputs_ = inputs_text(*scene_) + inputs_text(keys);
  }

  void note() const override {
    constexpr double small = 0.5, enough = 0.03;
    if (request_.numerical_aperture < small && methods_.tolerance < enough)
      std::fprintf(
          stderr,
          "note: numerical_aperture = %g converges slowly; it usually requires tolerance = "
          "%g\n",
          request_.numerical_aperture, enough);
    if (scene_->faces && scene_->faces->outside > request_.numerical_aperture)
      std::fprintf(stderr,
                   "note: numerical_aperture = %g is below outside_index = %g: light at larger "
                   "angles is not detected\n",
                   request_.numerical_aperture, scene_->faces->outside);
    note_thin_layers(*scene_);
    if (has_wavelength_) note_long_waves(*scene_);
  }

  PlannedExperiment plan() const override {
    return {.plan = "transport: spherical harmonics at each transverse frequency",
            .batches = mc::distance_job(*scene_, request_, methods_.tolerance),
            .write = [this](ResultFile& file, const GroupedSums& sums, bool prints) {
              write(file, sums, prints);
            }};
  }

 private:
  void write(ResultFile& file, const GroupedSums& sums, bool prints) const {
    const auto found = mc::distance_estimates(request_, sums);
    const mc::Dynamics& dynamics = request_.dynamics;
    if (prints) {
      print_distances(request_, found);
      if (gradient_) print_paths(request_, found);
      print_rows("delay: g1", dynamics.delays, real_parts(found.correlation.value), request_);
      print_rows("exposure: K^2", dynamics.exposure.times, real_parts(found.contrast.value),
                 request_);
    }
    write_medium(file, *scene_);
    mc::DistanceRequest asked = request_;
    asked.gradient = gradient_;
    mc::write_distance(file, asked, found);
    if (instrument_) {
      const auto plan = mc::flow_plan(*instrument_, request_, found);
      if (prints)
        print_flow(plan, request_, *instrument_, instrument_values_.fibre_modes.has_value());
      mc::write_flow(file, *instrument_, request_, plan);
    }
    ResultGroup(file, mc::distance_table)
        .check("invariants/reciprocity", mc::reciprocity(*scene_, request_, methods_.tolerance));
    mc::write_numerical(file);
  }

  SceneSpec spec_;
  MethodSettings methods_;
  mc::DynamicsValues dynamics_;
  mc::DistanceRequest request_;
  std::vector<double> distances_;
  mc::DetectorValues detectors_;
  std::optional<double> length_unit_;
  bool gradient_ = false, has_wavelength_ = false;
  mc::InstrumentValues instrument_values_;
  std::optional<mc::Instrument> instrument_;
  std::optional<Scene> scene_;
};

}  // namespace

std::unique_ptr<Experiment> reflectance_experiment() {
  return std::make_unique<ReflectanceExperiment>();
}

}  // namespace flatspeckle::apps
