#include "mc/estimators/flux.h"

#include <cstdio>

#include "apps/command/subcommands.h"
#include "apps/results/estimation.h"
#include "core/session/identity.h"
#include "core/session/session.h"
#include "flatland/scene/scene_datasets.h"
#include "mc/slab/refinement.h"
#include "mc/slab/slab_flux.h"
#include "mc/space/space_flux.h"

namespace flatspeckle::apps {

namespace {

void print_table(const Scene& scene, const mc::FluxEstimates& flux) {
  const bool box = scene.domain.kind == Domain::Kind::box;
  const auto direct = mc::direct_transmittances(scene);
  std::printf("%8s  %-22s %-22s %-12s %s%s\n", "light", "reflectance", "transmittance", "direct",
              box ? "side_loss              " : "", "absorptance");
  const auto print = [](const Estimate& share, std::size_t light) {
    std::printf("%-12.6g %-9.2g ", share.value[light].real(), share.error[light]);
  };
  for (std::size_t light = 0; light < direct.size(); ++light) {
    std::printf("%8.4f  ", scene.request.lights[light].angle);
    print(flux.reflectance, light);
    print(flux.transmittance, light);
    std::printf("%-12.6g ", direct[light]);
    if (box) print(flux.side_loss, light);
    print(flux.absorptance, light);
    std::printf("\n");
  }
}

}  // namespace

int flux(const Arguments& arguments) {
  SceneSpec spec;
  RunSettings run;
  MethodSettings methods;
  std::string method = "auto";
  std::int64_t angle_bins = 90;
  Subcommand command("flux",
                     "Reflected, transmitted and absorbed power of a scene: intensity only");
  Keys& keys = command.keys();
  add_scatterer_keys(keys, spec);
  add_bulk_keys(keys, spec);
  add_medium_keys(keys, spec);
  add_profile_keys(keys, spec);
  keys.group("Lights and views");
  keys.add("light_angles", spec.light_angles, "Directions of the plane waves, from +z").angle();
  keys.add("angle_bins", angle_bins,
           "Equal bins of the exit angle over (-pi, pi], in space over (0, pi)")
      .from(1, 100000);
  add_dimension_key(keys, spec);
  keys.add(
          "method", method,
          "Monte Carlo, or of a slab by transport without chance; auto: the latter, unless samples "
          "or seconds are given")
      .one_of({"mc", "transport", "auto"});
  add_transport_keys(keys, methods);
  add_run_keys(keys, run);
  if (!command.parse(arguments)) return ExitStatus::done;

  Session session(command.text(), keys, run, command.only_prints());
  choose_method(keys, method, spec, run);
  const bool by_mc = method == "mc";
  if (!by_mc && !spec.layers.empty())
    throw InputError("layers", spec.layers, "their flux is by method = mc");
  if (!by_mc) read_transport(keys, methods, spec, run);
  const StopRule stop = by_mc ? stop_rule(keys, run) : both_batches();
  const auto bins = static_cast<std::size_t>(keys.read(angle_bins));
  if (by_mc && spec.dimension == 3)
    throw InputError("method", method, "walks in the plane; flux in space is by transport");
  keys.read(spec.dimension);
  const Scene scene = with_dimension(make_scene(keys, spec), spec);
  const auto by_transport = scene.medium.dimension == 3 ? mc::space_flux_job : mc::slab_flux_job;
  const mc::FluxJob job = by_mc ? mc::flux_job(scene, bins, session.seed())
                                : by_transport(scene, bins, {methods.tolerance});
  if (!command.settle()) return ExitStatus::done;
  return session.run((by_mc ? "mc: " : "transport: ") + job.plan, {{"", "flux", job.batches, stop}},
                     inputs_text(scene) + inputs_text(keys), [&](ResultFile& file) {
                       const auto estimates = mc::flux_estimates(job, session.sums(""));
                       print_table(scene, estimates);
                       write_medium(file, scene);
                       mc::write_flux(file, scene, estimates);
                       if (!by_mc) mc::write_numerical(file);
                     });
}

}  // namespace flatspeckle::apps
