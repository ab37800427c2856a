#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <optional>
#include <sstream>
#include <vector>

#include "apps/command/experiment.h"
#include "apps/flatland/solver_keys.h"
#include "core/error.h"
#include "core/session/session.h"
#include "flatland/scene/scene.h"
#include "flatland/scene/scene_datasets.h"
#include "wave_solver/periodic/matrix_job.h"

namespace flatspeckle::apps {

namespace {

class MatrixExperiment : public Experiment {
 public:
  void add_keys(Keys& keys) override {
    add_scatterer_keys(keys, spec_);
    add_medium_keys(keys, spec_);
    keys.group("Channels");
    add_period_phase_key(keys, cell_);
    keys.add("shifts", shifts_, "Largest shift of the light, in channels, for tilt correlations")
        .from(1, 10000);
    keys.add("eigenvalue_bins", bins_, "Number of bins of the transmission eigenvalues")
        .from(2, 10000);
    keys.add("numerical_aperture", numerical_aperture_,
             "Largest |sin(angle)| of the channels of the filtered matrix, on both sides")
        .positive();
    keys.add("segments", segments_,
             "Numbers of segments (groups of neighbouring channels) with one phase each, for "
             "focusing")
        .from(1, 1e6);
    keys.add("conjugated_fraction", conjugated_fraction_,
             "Parts of the back channels that record light and return it by phase conjugation")
        .positive_to(1);
    add_solver_keys(keys, cell_);
    add_run_keys(keys, run_);
  }

  void read(const Keys& keys) override {
    stop_ = stop_rule(keys, run_);
    wave::MatrixSettings settings;
    settings.phase = keys.read(cell_.period_phase);
    settings.shifts = static_cast<std::size_t>(keys.read(shifts_));
    settings.eigenvalue_bins = static_cast<std::size_t>(keys.read(bins_));
    settings.numerical_aperture = keys.read(numerical_aperture_);
    settings.segments = keys.read(segments_);
    settings.conjugated_fraction = keys.read(conjugated_fraction_);
    settings.options = solve_options(keys, cell_);
    scene_ = make_scene(keys, spec_);
    if (scene_->domain.kind != Domain::Kind::box)
      throw InputError("domain", spec_.domain, "must be box; its width is the period");
    if (!scene_->medium.has_scatterers)
      throw InputError("scatterer", spec_.scatterer, "must be point, soft, hard, tm or te");
    job_ = wave::matrix_job(*scene_, settings, seed());
    inputs_ = inputs_text(*scene_) + inputs_text(keys);
  }

  PlannedExperiment plan() const override {
    std::ostringstream plan;
    plan << "exact scattering matrices of " << job_.channels.size()
         << " channels on each side; one placement per batch";
    return {.plan = plan.str(),
            .batches = job_.batches,
            .write = [this](ResultFile& file, const GroupedSums& sums, bool prints) {
              const auto found = wave::matrix_statistics(job_, sums);
              if (prints) print(found, scene_->placement);
              write_medium(file, *scene_);
              wave::write_statistics(file, job_, found);
            }};
  }

 private:
  /// Prints C_E of the first shifts, and a note if C_I has fallen below 1/2 at the first.
  static void print_tilts(const Estimate& tilts) {
    constexpr std::size_t most = 3;
    const std::size_t shown = std::min(most, tilts.value.size() - 1);
    std::printf("%-28s", "tilt correlation C_E");
    for (std::size_t d = 1; d <= shown; ++d)
      std::printf("%s %.4g +- %.2g at %zu", d > 1 ? "," : "", tilts.value[d].real(), tilts.error[d],
                  d);
    std::puts(shown > 1 ? " channels" : " channel");
    if (tilts.value.size() > 1 && std::norm(tilts.value[1]) < 0.5)
      std::puts("C_I is below 1/2 at the first shift: a wider period resolves the memory effect");
  }

  static void print(const wave::MatrixStatistics& found, const PlacementRule& placement) {
    const auto line = [](const char* name, const Estimate& of, const char* note = "") {
      std::printf("%-28s %.6g", name, of.value[0].real());
      if (std::isfinite(of.error[0])) std::printf(" +- %.2g", of.error[0]);
      std::printf("%s%s\n", std::isfinite(of.error[0]) ? "" : ", of unknown error", note);
    };
    line("conductance", found.conductance);
    const bool is_poisson = placement.kind == PlacementRule::Kind::poisson && !placement.count;
    line("variance of conductance", found.conductance_variance,
         is_poisson ? " (includes the Poisson-distributed number of scatterers; count fixes it)"
                    : "");
    line("largest eigenvalue", found.largest);
    line("C2", found.channel_variance);
    line("C3", found.relative_variance);
    char theory[40];
    std::snprintf(theory, sizeof theory, " (Gaussian fields: %.4g)", found.focus_theory.front());
    line("enhancement of focusing", found.focus, theory);
    constexpr double clear = 0.9;
    if (found.focus.value[0].real() < clear * found.focus_theory.front())
      std::cerr << "note: the enhancement of focusing is well below that of Gaussian fields: "
                   "unscattered light in the channel of the focus raises the reference in a thin "
                   "slab\n";
    print_tilts(found.tilt_correlation);
    std::printf("error of power %.1e, %s\n", found.power.off,
                error_of_reciprocity(found.reciprocity).c_str());
  }

  SceneSpec spec_;
  SolverKeys cell_{.tolerance = 1e-8};
  std::int64_t shifts_ = 5, bins_ = 20;
  double numerical_aperture_ = 1;
  std::vector<std::int64_t> segments_;
  std::vector<double> conjugated_fraction_;
  std::optional<Scene> scene_;
  wave::MatrixJob job_;
};

}  // namespace

std::unique_ptr<Experiment> matrix_experiment() {
  return std::make_unique<MatrixExperiment>();
}

}  // namespace flatspeckle::apps
