#include <cstdio>

#include "apps/extras.h"
#include "apps/moments_table.h"
#include "apps/scene_options.h"
#include "apps/session.h"
#include "apps/subcommands.h"
#include "core/error.h"
#include "flatland/scene/scene_datasets.h"

namespace flatspeckle::apps {

namespace {

void print_medium(const Scene& scene) {
  const BulkMedium& medium = scene.medium;
  std::printf("g %.5g, albedo %.5g, optical depth %.5g", medium.g, medium.albedo,
              medium.mu_t * scene.domain.depth);
  if (medium.mu_t > 0) std::printf(", k x mean free path %.5g", scene.k * medium.mean_free_path());
  std::printf("\n");
}

}  // namespace

int covariance(const Arguments& arguments) {
  SceneSpec spec;
  RunSettings settings;
  MethodSettings methods;
  Extras extras;
  std::string method = "mc";
  Subcommand command("covariance", "Covariance and intensity of the speckle field of a scene");
  add_scatterer_options(command.options(), spec);
  add_bulk_options(command.options(), spec);
  add_medium_options(command.options(), spec);
  add_structure_option(command.options(), spec);
  add_view_options(command.options(), spec);
  add_light_options(command.options(), spec);
  add_request_options(command.options(), spec);
  command.options().add_with_default("--method", method, "mc or wave");
  add_extra_options(command.options(), extras);
  add_mc_options(command.options(), methods);
  add_wave_options(command.options(), methods);
  add_run_options(command.options(), settings);
  if (!command.parse(arguments)) return ExitStatus::done;

  settle_request(command, spec);
  if (method != "mc" && method != "wave")
    throw InputError("method", method, "must be one of mc wave");
  const Scene scene = make_scene(spec);
  if (method == "mc") {
    Neglected neglected;
    neglected.add(scene);
    note(neglected);
  } else {
    refuse_extras(extras);
    note_rounding(scene);
  }
  const auto [estimation, write_extras] =
      method == "mc" ? extended_estimation(scene, methods, extras, seed_of(settings))
                     : ExtendedEstimation{wave_estimation(scene, methods, seed_of(settings)), {}};
  const StopRule mc_stop = stop_rule(settings);
  const StopRule wave_stop = stop_rule(
      settings, "wave_samples", methods.wave_samples ? methods.wave_samples : settings.samples);
  Session session(
      command.command_line(), settings, estimation.plan,
      {{"", "covariance", estimation.job.batches, method == "mc" ? mc_stop : wave_stop}},
      inputs_text(scene));
  return session.run([&, &job = estimation.job, &write = write_extras](ResultFile& file) {
    const GroupedSums& sums = session.state("").sums;
    const FieldMoments moments = field_moments(job, sums);
    print_medium(scene);
    print_entries(scene.request, moments.covariance);
    write_medium(file, scene);
    write_axes(file, scene);
    print_ranges("", mc::write_moments(file, "", job, scene, sums, moments));
    if (write) write(file, sums);
  });
}

}  // namespace flatspeckle::apps
