#include <cstdio>

#include "apps/command/subcommands.h"
#include "apps/results/extras.h"
#include "apps/results/moments_table.h"
#include "apps/results/tilt_search.h"
#include "core/session/identity.h"
#include "core/session/session.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/estimators/reflection_theory.h"
#include "mc/slab/refinement.h"

namespace flatspeckle::apps {

namespace {

void print_medium(const Scene& scene) {
  const BulkMedium& medium = scene.medium;
  std::printf("g %.5g, albedo %.5g, optical depth %.5g", medium.g, medium.albedo,
              medium.mu_t * scene.domain.depth);
  if (medium.mu_t > 0) std::printf(", k x mean free path %.5g", scene.k * medium.mean_free_path());
  std::printf("\n");
}

StopRule stop_of(const std::string& method, const Keys& keys, const RunSettings& run,
                 const MethodSettings& methods) {
  if (method == "transport") return both_batches();
  const bool own = method == "wave" && methods.wave_samples;
  const StopRule stop = own ? stop_rule(keys, run, methods.wave_samples) : stop_rule(keys, run);
  keys.read(run.samples);  // one of both, in a scene for several methods
  keys.read(methods.wave_samples);
  return stop;
}

}  // namespace

int covariance(const Arguments& arguments) {
  SceneSpec spec;
  RunSettings run;
  MethodSettings methods;
  Extras extras;
  std::string method = "auto";
  Subcommand command("covariance", "Covariance and intensity of the speckle field of a scene");
  Keys& keys = command.keys();
  add_keys(keys, spec);
  std::optional<std::int64_t> tilt_count;
  add_tilt_count_key(keys, tilt_count);
  std::vector<double> q_depths;
  add_q_depths_key(keys, q_depths);
  keys.group("Methods");
  keys.add("method", method,
           "Monte Carlo, exactly, or of a slab by transport without chance; auto: transport where "
           "it can be, unless samples or seconds are given")
      .one_of({"mc", "wave", "transport", "auto"});
  add_extra_keys(keys, extras);
  add_mc_keys(keys, methods);
  add_wave_keys(keys, methods);
  add_transport_keys(keys, methods);
  add_dimension_key(keys, spec);
  add_run_keys(keys, run);
  if (!command.parse(arguments)) return ExitStatus::done;

  Session session(command.text(), keys, run, command.only_prints());
  choose_method(keys, method, spec, run);
  if (method == "transport") read_transport(keys, methods, spec, run);
  const StopRule stop = stop_of(method, keys, run, methods);
  const auto reversed = method == "wave" ? mc::ReversedPaths::no : reversed_paths(keys, methods);
  if (method == "wave") keys.read(methods.wave_tolerance);
  if (method != "wave") keys.read(spec.dimension);
  read_extras(keys, extras, method);
  take_q_depths(keys, q_depths, spec);
  choose_tilts(keys, tilt_count, spec, method, run, session.seed());
  const Scene scene = with_dimension(make_scene(keys, spec), spec);
  const auto [estimation, write_extras] =
      method == "mc"     ? extended_estimation(scene, reversed, extras, session.seed())
      : method == "wave" ? extended_waves(scene, extras, methods.wave_tolerance, session.seed())
                         : extended_transport(scene, reversed, extras, methods.tolerance);
  disregard_unused(keys, spec, {method});
  const Neglected neglected(scene);
  if (method != "wave") refuse_absurd(methods, neglected);
  if (!command.settle()) return ExitStatus::done;
  if (method != "wave") {
    note(neglected);
  } else {
    note_rounding(scene);
  }
  return session.run(estimation.plan, {{"", "covariance", estimation.job.batches, stop}},
                     inputs_text(scene) + inputs_text(keys),
                     [&, &job = estimation.job, &write = write_extras](ResultFile& file) {
                       const GroupedSums& sums = session.sums("");
                       const FieldMoments moments = field_moments(job, sums);
                       print_medium(scene);
                       if (scene.request.kind != CovarianceRequest::Kind::tilt_shift)
                         print_entries(scene.request, moments.covariance);
                       write_medium(file, scene);
                       write_axes(file, scene);
                       print_moves(scene.request,
                                   mc::write_moments(file, "", job, scene, sums, moments));
                       mc::write_reflection_theory(file, scene);
                       if (write) write(file, sums);
                       if (method == "transport") mc::write_numerical(file);
                     });
}

}  // namespace flatspeckle::apps
