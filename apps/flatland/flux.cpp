#include "mc/paths/estimators/flux.h"

#include <algorithm>
#include <cstdio>

#include "apps/command/experiment.h"
#include "apps/results/estimation.h"
#include "core/error.h"
#include "core/result/result_group.h"
#include "core/session/session.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/slab/refinement.h"
#include "mc/slab/slab_flux.h"

namespace flatspeckle::apps {

namespace {

void print_table(const Scene& scene, const mc::FluxEstimates& flux) {
  const bool box = scene.domain.kind == Domain::Kind::box;
  std::printf("%8s  %-22s %-22s %-12s %s%s%s\n", "light", "reflectance", "diffuse transmittance",
              "direct", scene.faces ? "specular     " : "", box ? "side_loss              " : "",
              "absorptance");
  const auto print = [](const Estimate& share, std::size_t light) {
    std::printf("%-12.6g %-9.2g ", share.value[light].real(), share.error[light]);
  };
  for (std::size_t light = 0; light < scene.request.lights.size(); ++light) {
    const double angle = scene.request.lights[light].angle;
    std::printf("%8.4f  ", angle);
    print(flux.reflectance, light);
    print(flux.transmittance, light);
    std::printf("%-12.6g ", mc::direct_transmittance(scene, scene.request.lights[light]));
    if (scene.faces) std::printf("%-12.6g ", mc::specular_reflectance(scene, angle));
    if (box) print(flux.side_loss, light);
    print(flux.absorptance, light);
    std::printf("\n");
  }
}

/// Prints a note for each flux fraction that is 0 only because no path contributes to it.
void note_unreached(const Scene& scene, const mc::FluxEstimates& flux) {
  const auto note = [&](const Estimate& share, const char* name) {
    if (scene.medium.mu_s > 0 && std::ranges::find(share.value, 0.0) != share.value.end())
      std::fprintf(stderr,
                   "note: the %s of at least one light is 0 and has no error, because no path "
                   "contributes: increase samples\n",
                   name);
  };
  note(flux.reflectance, "reflectance");
  note(flux.transmittance, "transmittance");
  if (scene.domain.kind == Domain::Kind::box) note(flux.side_loss, "side_loss");
}

class FluxExperiment : public Experiment {
 public:
  void add_keys(Keys& keys) override {
    add_scatterer_keys(keys, spec_);
    add_bulk_keys(keys, spec_);
    add_medium_keys(keys, spec_);
    add_structure_key(keys, spec_);
    add_profile_keys(keys, spec_);
    keys.group("Lights and views");
    keys.add("light_angles", spec_.light_angles, "Directions of the plane waves, angles from +z")
        .angle();
    keys.add("angle_bins", angle_bins_,
             "Number of equal bins of the exit angle, over (-pi, pi] or in 3D over (0, pi)")
        .from(1, 100000);
    add_space_keys(keys, spec_);
    add_faces_keys(keys, spec_);
    keys.add("method", method_,
             "mc: Monte Carlo; transport: deterministic, for slabs; auto: transport for slabs "
             "unless samples or seconds are given, else mc")
        .one_of({"mc", "transport", "auto"});
    add_transport_keys(keys, methods_);
    add_run_keys(keys, run_);
  }

  void read(const Keys& keys) override {
    choose_method(keys, method_, spec_, run_);
    if (!by_mc()) read_transport(keys, methods_, spec_, run_);
    stop_ = by_mc() ? stop_rule(keys, run_) : both_batches(methods_.tolerance);
    keys.read(angle_bins_);
    keys.read(spec_.dimension);
    scene_ = with_dimension(make_scene(keys, spec_), spec_);
    if (scene_->faces && scene_->domain.kind == Domain::Kind::box)
      throw InputError("medium_index", scene_->faces->inside, "requires domain = slab in flux");
    job_ = made_job();
    is_flat_sample_ = is_flat_sample(keys, *scene_);
    inputs_ = inputs_text(*scene_) + inputs_text(keys);
  }

  void note() const override {
    if (is_flat_sample_) note_plane();
  }

  PlannedExperiment plan() const override {
    return {.plan = (by_mc() ? "mc: " : "transport: ") + job_.plan,
            .batches = job_.batches,
            .write = [this](ResultFile& file, const GroupedSums& sums, bool prints) {
              write(file, sums, prints);
            }};
  }

 private:
  bool by_mc() const { return method_ == "mc"; }

  mc::FluxJob made_job() const {
    const auto bins = static_cast<std::size_t>(angle_bins_);
    if (by_mc()) return mc::flux_job(*scene_, bins, seed());
    return mc::slab_flux_job(*scene_, bins, {methods_.tolerance});
  }

  void write(ResultFile& file, const GroupedSums& sums, bool prints) const {
    const auto estimates = mc::flux_estimates(job_, sums);
    if (prints) print_suspension(*scene_);
    if (prints) print_faces(*scene_);
    if (prints) print_table(*scene_, estimates);
    if (prints) note_bins(estimates);
    if (prints && by_mc()) note_unreached(*scene_, estimates);
    write_medium(file, *scene_);
    mc::write_flux(file, *scene_, estimates);
    ResultGroup(file, mc::flux_table)
        .check("invariants/power", mc::power_balance(job_, sums, mc::unscattered_shares(*scene_)));
    if (!by_mc()) mc::write_numerical(file);
  }

  /// Prints a note if bins of the radiance over exit angle have large errors; bins at the edge of a
  /// sharp peak converge more slowly than reflectance and transmittance.
  void note_bins(const mc::FluxEstimates& flux) const {
    constexpr double much = 1e-4;
    const double width = job_.angles / static_cast<double>(job_.angle_bins);
    const double worst = width * std::ranges::max(flux.exit_radiance.error);
    if (!by_mc() && worst > much)
      std::fprintf(stderr,
                   "note: exit_radiance has errors of up to %.2g of the incident power per bin\n",
                   worst);
  }

  SceneSpec spec_;
  MethodSettings methods_;
  std::string method_ = "auto";
  std::int64_t angle_bins_ = 90;
  std::optional<Scene> scene_;
  mc::FluxJob job_;
  bool is_flat_sample_ = false;
};

}  // namespace

std::unique_ptr<Experiment> flux_experiment() {
  return std::make_unique<FluxExperiment>();
}

}  // namespace flatspeckle::apps
