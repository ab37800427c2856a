#include <cmath>
#include <cstdio>

#include "apps/command/experiment.h"
#include "apps/results/extras.h"
#include "apps/results/moments_table.h"
#include "apps/results/tilt_search.h"
#include "apps/results/view_power.h"
#include "core/error.h"
#include "core/session/session.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/paths/estimators/reflection_theory.h"
#include "mc/slab/refinement.h"
#include "mc/theory/diffusion.h"

namespace flatspeckle::apps {

namespace {

void print_medium(const Scene& scene) {
  const BulkMedium& medium = scene.medium;
  std::printf("g %.5g, albedo %.5g, optical depth %.5g", medium.g, medium.albedo,
              medium.mu_t * scene.domain.depth);
  if (medium.mu_t > 0) std::printf(", k x mean free path %.5g", scene.k * medium.mean_free_path());
  std::printf("\n");
  print_suspension(scene);
}

/// Whether the forward peak of the phase function is so narrow that transport needs long to resolve
/// it, or cannot.
bool has_narrow_peak(const SceneSpec& spec) {
  const double narrow = spec.dimension == 3 ? 2e-3 : 2e-4;
  return spec.scatterer == "hg" && spec.g && 1 - std::abs(*spec.g) < narrow;
}

StopRule stop_of(const std::string& method, const Keys& keys, const RunSettings& run,
                 const MethodSettings& methods) {
  if (method == "transport") return both_batches(methods.tolerance);
  const bool own = method == "wave" && methods.wave_samples;
  const StopRule stop = own ? stop_rule(keys, run, methods.wave_samples) : stop_rule(keys, run);
  // Marked as read, because a scene for several methods may give both samples and wave_samples.
  keys.read(run.samples);
  keys.read(methods.wave_samples);
  return stop;
}

class CovarianceExperiment : public Experiment {
 public:
  void add_keys(Keys& keys) override {
    flatspeckle::add_keys(keys, spec_);
    add_tilt_count_key(keys, tilt_count_);
    add_q_depths_key(keys, q_depths_);
    keys.group("Methods");
    keys.add("method", method_,
             "mc: Monte Carlo; wave: exact solutions; transport: deterministic, for slabs; auto: "
             "transport if it is possible and neither samples nor seconds are given, otherwise mc")
        .one_of({"mc", "wave", "transport", "auto"});
    add_extra_keys(keys, extras_);
    add_mc_keys(keys, methods_);
    add_wave_keys(keys, methods_);
    add_transport_keys(keys, methods_);
    add_run_keys(keys, run_);
  }

  void read(const Keys& keys) override {
    if (method_ == "auto" && has_narrow_peak(spec_)) method_ = "mc";
    choose_method(keys, method_, spec_, run_);
    if (method_ == "transport") read_transport(keys, methods_, spec_, run_);
    stop_ = stop_of(method_, keys, run_, methods_);
    const auto reversed =
        method_ == "wave" ? mc::ReversedPaths::no : reversed_paths(keys, methods_);
    if (method_ == "wave") keys.read(methods_.wave_tolerance);
    keys.read(spec_.dimension);
    read_extras(keys, extras_, spec_, method_);
    take_q_depths(keys, q_depths_, spec_);
    choose_tilts(keys, tilt_count_, spec_, method_, run_, seed());
    scene_ = with_dimension(make_scene(keys, spec_), spec_);
    if (!only_prints_) estimation_ = made_estimation(reversed);
    disregard_unused(keys, spec_, {method_});
    neglected_ = Neglected(*scene_);
    is_flat_sample_ = method_ != "wave" && is_flat_sample(keys, *scene_);
    if (method_ != "wave") refuse_absurd(methods_, neglected_);
    inputs_ = inputs_text(*scene_) + inputs_text(keys) + extras_.identity();
  }

  void note() const override {
    if (method_ != "wave")
      apps::note(neglected_);
    else
      note_rounding(*scene_);
    if (is_flat_sample_) note_plane();
  }

  PlannedExperiment plan() const override {
    return {.plan = estimation_.plan,
            .batches = estimation_.job.batches,
            .write = [this](ResultFile& file, const GroupedSums& sums, bool prints) {
              write(file, sums, prints);
            }};
  }

 private:
  Estimation made_estimation(mc::ReversedPaths reversed) const {
    if (method_ == "mc") return extended_estimation(*scene_, reversed, extras_, seed());
    if (method_ == "wave") return extended_waves(*scene_, extras_, methods_.wave_tolerance, seed());
    return extended_transport(*scene_, reversed, extras_, methods_.tolerance);
  }

  void write(ResultFile& file, const GroupedSums& sums, bool prints) const {
    const FieldJob& job = estimation_.job;
    const CovarianceRequest& request = scene_->request;
    const FieldMoments moments = field_moments(job, sums);
    if (prints) {
      print_medium(*scene_);
      print_faces(*scene_);
      if (request.kind != CovarianceRequest::Kind::tilt_shift)
        print_entries(request, moments.covariance);
      if (method_ != "transport") print_errors(request, moments.covariance);
    }
    write_medium(file, *scene_);
    mc::write_extrapolation_length(file, *scene_);
    write_axes(file, *scene_);
    const auto moves = mc::write_moments(file, "", job, *scene_, sums, moments);
    if (prints) print_moves(request, moves);
    mc::write_reflection_theory(file, *scene_);
    if (estimation_.write) estimation_.write(file, sums);
    if (method_ == "transport") mc::write_numerical(file);
    check_power(file, "", *scene_,
                {method_, sums.total_samples(), methods_.tolerance_of(method_), seed()});
  }

  SceneSpec spec_;
  MethodSettings methods_;
  Extras extras_;
  std::string method_ = "auto";
  std::optional<std::int64_t> tilt_count_;
  std::vector<double> q_depths_;
  std::optional<Scene> scene_;
  Estimation estimation_;
  Neglected neglected_;
  bool is_flat_sample_ = false;
};

}  // namespace

std::unique_ptr<Experiment> covariance_experiment() {
  return std::make_unique<CovarianceExperiment>();
}

}  // namespace flatspeckle::apps
