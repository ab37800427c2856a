#include <cstdio>

#include "apps/extras.h"
#include "apps/moments_table.h"
#include "apps/subcommands.h"
#include "core/session/session.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/space/space_scene.h"

namespace flatspeckle::apps {

namespace {

void print_medium(const Scene& scene) {
  const BulkMedium& medium = scene.medium;
  std::printf("g %.5g, albedo %.5g, optical depth %.5g", medium.g, medium.albedo,
              medium.mu_t * scene.domain.depth);
  if (medium.mu_t > 0) std::printf(", k x mean free path %.5g", scene.k * medium.mean_free_path());
  std::printf("\n");
}

/// What `auto` stands for: what only Monte Carlo tells is left to it.
std::string chosen(const Keys& keys, const std::string& method, const SceneSpec& spec,
                   const Extras& extras) {
  if (keys.read(method) != "auto") return method;
  const bool asks_mc = extras.gradient || !extras.delays.empty();
  return spec.domain == "slab" && !asks_mc ? "transport" : "mc";
}

}  // namespace

int covariance(const Arguments& arguments) {
  SceneSpec spec;
  RunSettings run;
  MethodSettings methods;
  Extras extras;
  std::string method = "mc";
  Subcommand command("covariance", "Covariance and intensity of the speckle field of a scene");
  Keys& keys = command.keys();
  add_keys(keys, spec);
  keys.group("Methods");
  keys.add("method", method,
           "Monte Carlo, exactly, or of a slab by transport without chance; auto: transport where "
           "it can be")
      .one_of({"mc", "wave", "transport", "auto"});
  add_extra_keys(keys, extras);
  add_mc_keys(keys, methods);
  add_wave_keys(keys, methods);
  add_transport_keys(keys, methods);
  add_dimension_key(keys, methods);
  add_run_keys(keys, run);
  if (!command.parse(arguments)) return ExitStatus::done;

  Session session(command.text(), keys, run, command.only_prints());
  const std::string by = chosen(keys, method, spec, extras);
  if (by == "transport") check_transport(spec);
  const StopRule stop = by == "transport" ? both_batches()
                        : by == "wave" && methods.wave_samples
                            ? stop_rule(keys, run, methods.wave_samples)
                            : stop_rule(keys, run);
  const auto reversed = reversed_paths(keys, methods);
  const double wave_tolerance = keys.read(methods.wave_tolerance);
  if (by != "transport") {
    keys.read(methods.wave_samples);
    keys.read(run.samples);
  }
  if (by == "mc") read_extras(keys, extras);
  if (by == "transport") keys.read(methods.tolerance);
  const bool space = by == "transport" && keys.read(methods.dimension) == 3;
  const Scene plane = make_scene(keys, spec), scene = space ? mc::in_space(plane, spec) : plane;
  const auto [estimation, write_extras] =
      by == "mc" ? extended_estimation(scene, reversed, extras, session.seed())
      : by == "wave"
          ? ExtendedEstimation{wave_estimation(scene, wave_tolerance, session.seed()), {}}
          : ExtendedEstimation{transport_estimation(scene, reversed, methods.tolerance), {}};
  if (!command.settle()) return ExitStatus::done;
  if (by != "wave") {
    Neglected neglected;
    neglected.add(scene);
    note(neglected);
  } else {
    note_rounding(scene);
  }
  return session.run(estimation.plan, {{"", "covariance", estimation.job.batches, stop}},
                     inputs_text(scene),
                     [&, &job = estimation.job, &write = write_extras](ResultFile& file) {
                       const GroupedSums& sums = session.sums("");
                       const FieldMoments moments = field_moments(job, sums);
                       print_medium(scene);
                       print_entries(scene.request, moments.covariance);
                       write_medium(file, scene);
                       write_axes(file, scene);
                       print_ranges("", mc::write_moments(file, "", job, scene, sums, moments));
                       if (write) write(file, sums);
                       if (by == "transport") write_numerical_errors(file);
                     });
}

}  // namespace flatspeckle::apps
