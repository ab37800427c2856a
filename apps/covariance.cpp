#include "apps/estimation.h"
#include "apps/moments_output.h"
#include "apps/moments_table.h"
#include "apps/scene_options.h"
#include "apps/session.h"
#include "apps/subcommands.h"
#include "core/error.h"

namespace flatspeckle::apps {

int covariance(const Arguments& arguments) {
  SceneSpec spec;
  RunSettings settings;
  MethodSettings methods;
  std::string method = "mc";
  Subcommand command("covariance", "Covariance and intensity of the speckle field of a scene");
  add_scatterer_options(command.options(), spec);
  add_bulk_options(command.options(), spec);
  add_medium_options(command.options(), spec);
  add_structure_option(command.options(), spec);
  add_view_options(command.options(), spec);
  add_request_options(command.options(), spec);
  command.options().add_option("--method", method, "mc or wave")->capture_default_str();
  add_mc_options(command.options(), methods);
  add_wave_options(command.options(), methods);
  add_run_options(command.options(), settings);
  if (!command.parse(arguments)) return ExitStatus::done;

  settle_request(command, spec);
  if (method != "mc" && method != "wave")
    throw InputError("method", method, "must be one of mc wave");
  const Scene scene = make_scene(spec);
  const auto estimate = method == "mc" ? mc_estimation : wave_estimation;
  const Estimation estimation = estimate(scene, methods, seed_of(settings));
  const StopRule mc_stop = stop_rule(settings);
  const StopRule wave_stop = stop_rule(
      settings, "wave_samples", methods.wave_samples ? methods.wave_samples : settings.samples);
  Session session(
      command.command_line(), settings, estimation.plan,
      {{"", "covariance", estimation.job.batches, method == "mc" ? mc_stop : wave_stop}},
      inputs_text(scene));
  return session.run([&](ResultFile& file) {
    const GroupedSums& sums = session.state("").sums;
    const FieldMoments moments = field_moments(estimation.job, sums);
    print_entries(scene.request, moments.covariance);
    write_medium(file, scene);
    write_axes(file, scene.request);
    write_moments(file, "", estimation.job, scene, sums, moments);
  });
}

}  // namespace flatspeckle::apps
